/// Which chains may light a place: lists of them for the cells of an octree, made where places are
/// asked about.
#pragma once

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <vector>

#include "abbe/math/ray.h"
#include "abbe/math/vec.h"

namespace abbe {

/// An octree over a scene that grows where many places are asked about. Threads may ask at once,
/// and what they are told does not depend on each other but for chains that light nothing there.
class ChainIndex {
 public:
  /// Whether a chain, by its number, may light any place in a ball.
  using MayLight = std::function<bool(std::uint32_t, const Vec3f& center, float radius_m)>;

  /// Knows nothing of any chain.
  ChainIndex() = default;
  /// Of chains by their numbers, ascending. Balls that are asked about should be no larger than
  /// `room` times half the side of a cell. It is one of so many that share what such trees may
  /// take.
  ChainIndex(const Box3f& bounds, std::vector<std::uint32_t> chains, float room,
             std::size_t sharers = 1);

  /// The numbers of the chains that may light a ball, ascending, and of some that do not.
  std::span<const std::uint32_t> near(const Vec3f& center, float radius_m,
                                      const MayLight& may_light) const;

 private:
  struct Cell {
    Vec3f center{0.0f};
    float half_m = 0.0f;
    int depth = 0;
    std::vector<std::uint32_t> own;
    std::span<const std::uint32_t> numbers;  ///< Its own, or those of a larger cell.
    std::atomic<std::uint32_t> times_asked{0};
    std::array<std::atomic<Cell*>, 8> children{};

    Cell() = default;
    ~Cell();
    Cell(const Cell&) = delete;
    Cell& operator=(const Cell&) = delete;
  };
  struct Tree {
    Cell root;
    std::atomic<std::size_t> kept{0};  ///< Numbers in the lists of all cells.
  };

  // The cell of an octant, made; none if the cell is not asked about often enough, or is small.
  Cell* child(Cell& cell, std::size_t octant, const MayLight& may_light) const;

  std::unique_ptr<Tree> tree_;
  float room_ = 1.0f;
  std::size_t most_kept_ = 0;
};

}  // namespace abbe
