/// Which of many chains may light a place.
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "abbe/math/ray.h"

namespace abbe {

/// An octree over a scene. Its cells overlap by half of their size, so that places which lie close
/// together are in one.
class ChainIndex {
 public:
  /// Whether a chain, by its number, may light any place in a ball.
  using MayLight = std::function<bool(std::uint32_t, const Vec3f& center, float radius_m)>;

  ChainIndex() = default;
  ChainIndex(const Box3f& bounds, std::uint32_t chains, const MayLight& may_light);

  /// The numbers of the chains that may light a ball, ascending, and of some that do not.
  std::span<const std::uint32_t> near(const Vec3f& center, float radius_m) const;

 private:
  struct Cell {
    Vec3f center{0.0f};
    float half_m = 0.0f;
    std::uint32_t first = 0, last = 0;  ///< In numbers_.
    std::uint32_t children = 0;         ///< The first of eight; none: 0.
  };

  void split(std::uint32_t cell, int depth, const MayLight& may_light);

  std::vector<Cell> cells_;
  std::vector<std::uint32_t> numbers_;
};

}  // namespace abbe
