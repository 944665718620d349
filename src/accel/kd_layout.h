/// How a finished k-d tree lies in memory, and the view of it that the query kernels read.
#pragma once

#include <cstdint>

#include "accel/kd_memory.h"
#include "accel/query.h"
#include "accel/shapes.h"

namespace abbe {

/// A reference to a part of the tree: nothing, an inner node, or a leaf.
using KdChild = std::uint32_t;
inline constexpr KdChild kEmptyChild = 0;
inline constexpr KdChild kLeafBit = 0x80000000u;   ///< The rest is a block, or see kMixedBit.
inline constexpr KdChild kMixedBit = 0x40000000u;  ///< With kLeafBit: the rest is a mixed leaf.
inline constexpr KdChild kIndexMask = 0x3fffffffu;

/// Three levels of the binary tree in one cache line. Plane 0 splits the cell, planes 1 and 2 its
/// lower and upper part, planes 3 to 6 theirs; child c lies above plane p of its path where the
/// corresponding bit of c is set. A plane that is not needed has both sides' children alike empty.
struct alignas(64) WideNode {
  float planes[7];
  std::uint32_t axes;  ///< Four bits for each plane, plane 0 lowest.
  KdChild children[8];
};
static_assert(sizeof(WideNode) == 64);

inline constexpr int kBlockTriangles = 16;
inline constexpr int kBlockVertices = 16;

/// Up to sixteen triangles in SIMD layout over up to sixteen vertices that they share: half the
/// memory of separate corners, and each vertex is moved and sheared once for all its triangles.
/// Unused triangles have three times the same corner, which no ray meets.
struct alignas(64) TriangleBlock {
  float vertices[3][kBlockVertices];         ///< Rows of x, y and z.
  std::uint8_t corners[3][kBlockTriangles];  ///< Numbers of the vertices of each triangle.
  std::uint8_t triangle_count;
  std::uint8_t has_next;  ///< 1 if the leaf has a further block behind this one, else 0.
  alignas(64) std::uint32_t id[kBlockTriangles];
};
static_assert(sizeof(TriangleBlock) == 320);

/// A leaf that holds solids, and perhaps triangles too.
struct MixedLeaf {
  std::uint32_t first_block, block_count;
  std::uint32_t first_solid, solid_count;  ///< In KdView::solids.
};

/// The deepest stack of a query: each wide level takes one entry away and adds up to eight.
inline constexpr std::uint32_t kMaxTreeDepth = 96;
inline constexpr int kStackEntries = (kMaxTreeDepth / 3 + 1) * 7 + 10;

/// Everything a query reads.
struct KdView {
  KdChild root = kEmptyChild;
  const WideNode* nodes = nullptr;
  const TriangleBlock* blocks = nullptr;
  const MixedLeaf* mixed_leaves = nullptr;
  const std::uint32_t* solids = nullptr;  ///< Primitive numbers of ellipsoids and polyhedra.
  const Ellipsoid* ellipsoids = nullptr;
  const ConvexPolyhedron* polyhedra = nullptr;
  const Plane* planes = nullptr;
  const VisibilityMask* masks = nullptr;  ///< Null when every primitive has the mask `any_mask`.
  VisibilityMask any_mask = 0;            ///< Bits that at least one primitive has.
  const std::uint8_t* lonely_solids =
      nullptr;  ///< Per solid, 1 where nothing else reaches into it.
  std::uint32_t triangle_count = 0;
  std::uint32_t ellipsoid_count = 0;
  Box3f bounds;

  bool is_lonely_solid(std::uint32_t primitive) const {
    return primitive != kNoPrimitive && primitive >= triangle_count &&
           lonely_solids[primitive - triangle_count] != 0;
  }
  bool is_visible(std::uint32_t primitive, VisibilityMask mask) const {
    return masks == nullptr || (masks[primitive] & mask) != 0;
  }
};

}  // namespace abbe
