/// A tree of boxes over the places of meshes, eight to a node, and what waits to be visited in it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "abbe/accel/query.h"
#include "abbe/base/flat_array.h"
#include "abbe/math/ray.h"

namespace abbe {

/// A reference to an inner node or, with this bit, to a place.
using PlaceChild = std::uint32_t;
inline constexpr PlaceChild kPlaceBit = 0x80000000u;
inline constexpr std::uint32_t kNoPlace = 0xffffffffu;

/// Up to eight boxes, and what is in them.
struct alignas(64) PlaceNode {
  float low[3][8], high[3][8];
  PlaceChild children[8];
  std::uint32_t count;
};

/// The tree over boxes; its root is node 0.
class PlaceTree {
 public:
  PlaceTree() = default;
  /// Over fewer than 2^31 boxes. Time O(n log n).
  explicit PlaceTree(std::span<const Box3f> boxes);

  const PlaceNode* nodes() const { return nodes_.data(); }
  /// Entries that a query has waiting at most.
  std::size_t stack_entries() const { return stack_entries_; }
  const Box3f& bounds() const { return bounds_; }
  std::size_t bytes() const { return nodes_.bytes(); }

 private:
  FlatArray<PlaceNode> nodes_;
  Box3f bounds_;
  std::size_t stack_entries_ = 0;
};

/// A ray, or a bundle of rays that start and go within bounds, as boxes see it: no ray of it is in
/// a box before `enter` or behind `leave`.
struct PlaceBeam {
  float origin_low[3], origin_high[3];
  /// Times (box low − highest origin), and (box high − lowest origin), the earliest that a ray can
  /// come in by that side; ±FLT_MAX where none goes there.
  float enter_low[3], enter_high[3];
  /// Times (box high − lowest origin), and (box low − highest origin), the latest that a ray leaves
  /// by that side; 0 where not all go there.
  float leave_high[3], leave_low[3];
};

/// `reach_m` is the largest coordinate of all places: what rounding does to rays on the way there
/// is allowed for.
PlaceBeam beam_of(const Box3f& origins, const Box3f& directions, float reach_m);

/// What is still to be visited, and how far along a ray it begins at the earliest.
struct PlaceEntry {
  float t;
  PlaceChild child;
};

/// A query on its way through the tree.
struct PlaceSearch {
  PlaceBeam beam;
  float end = kInfinity;  ///< What begins farther away is of no interest.
  std::size_t query = 0;
  PlaceEntry* bottom = nullptr;  ///< Of the stack.
  PlaceEntry* top = nullptr;     ///< Behind its last entry.
  std::uint64_t visited = 0;     ///< Nodes.
};

/// The next place for each search, about the nearest first; kNoPlace where there is none left.
void next_places(const PlaceTree& tree, std::span<PlaceSearch> searches,
                 std::span<std::uint32_t> places);

/// Rays as the mesh sees them that stands where linear·p + offset maps back to its space; t stays.
Ray moved(const Mat3d& linear, const Vec3d& offset, const Ray& ray);
/// Origins and directions of a packet; the rest of `to` stays as it is.
void move_packet(const Mat3d& linear, const Vec3d& offset, const RayPacket& from, RayPacket& to);

}  // namespace abbe
