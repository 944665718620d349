/// How a finished k-d tree lies in memory, and the view of it that the query kernels read.
#pragma once

#include <cstddef>
#include <cstdint>

#include "abbe/accel/query.h"
#include "abbe/accel/shapes.h"
#include "abbe/base/flat_array.h"

namespace abbe {

/// A reference to a part of the tree: nothing, an inner node, or a leaf.
using KdChild = std::uint32_t;
inline constexpr KdChild kEmptyChild = 0;
inline constexpr KdChild kLeafBit =
    0x80000000u;  ///< The rest is a line of blocks, or see kMixedBit.
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
/// Vertices of a block whose triangles share them, and of one whose triangles do not.
inline constexpr int kSharedVertices = 16;
inline constexpr int kLooseVertices = 3 * kBlockTriangles;

/// What the array of blocks is made of.
struct alignas(64) BlockLine {
  std::uint8_t bytes[64];
};

/// Up to sixteen triangles in SIMD layout: this, and behind it the rows of x, y and z of their
/// vertices. Triangles that share sixteen vertices take half the memory of separate corners, and a
/// ray moves and shears each vertex once for all its triangles. Others have a loose block: three
/// vertices each, those of the first corners first. Unused triangles have three times the same
/// corner, which no ray meets.
struct alignas(64) TriangleBlock {
  std::uint8_t corners[3][kBlockTriangles];  ///< Numbers of the vertices of each triangle.
  std::uint8_t triangle_count;
  std::uint8_t is_loose;    ///< 1 or 0.
  std::uint8_t next_lines;  ///< To the leaf's next block, in lines; 0 if there is none.
  alignas(64) std::uint32_t id[kBlockTriangles];

  int vertices_per_row() const { return is_loose != 0 ? kLooseVertices : kSharedVertices; }
  const float* rows() const { return reinterpret_cast<const float*>(this + 1); }
  /// The coordinates of all vertices along an axis.
  const float* row(int axis) const { return rows() + axis * vertices_per_row(); }
};
static_assert(sizeof(TriangleBlock) == 2 * sizeof(BlockLine));

/// The rest of a leaf behind its first block, kEmptyChild if there is none.
inline KdChild next_block(const TriangleBlock& first, KdChild leaf) {
  return first.next_lines != 0 ? leaf + first.next_lines : kEmptyChild;
}

/// Lines of a block with its vertices.
inline constexpr std::uint32_t kSharedBlockLines = 2 + 3 * kSharedVertices * sizeof(float) / 64;
inline constexpr std::uint32_t kLooseBlockLines = 2 + 3 * kLooseVertices * sizeof(float) / 64;

/// A leaf that holds solids, and perhaps triangles too.
struct MixedLeaf {
  KdChild triangles;                       ///< A leaf of triangles only, or kEmptyChild.
  std::uint32_t first_solid, solid_count;  ///< In KdView::solids.
};

/// The deepest stack of a query: each wide level takes one entry away and adds up to eight.
inline constexpr std::uint32_t kMaxTreeDepth = 96;
inline constexpr int kStackEntries = (kMaxTreeDepth / 3 + 1) * 7 + 10;

/// Everything a query reads.
struct KdView {
  KdChild root = kEmptyChild;
  const WideNode* nodes = nullptr;
  const BlockLine* blocks = nullptr;
  std::uint32_t lines_ahead = 0;  ///< Lines of a leaf to fetch before it is read.
  const MixedLeaf* mixed_leaves = nullptr;
  const std::uint32_t* solids = nullptr;  ///< Primitive numbers of ellipsoids and polyhedra.
  const Ellipsoid* ellipsoids = nullptr;
  const ConvexPolyhedron* polyhedra = nullptr;
  const Plane* planes = nullptr;
  const VisibilityMask* masks = nullptr;  ///< Null where a query sees all primitives.
  VisibilityMask any_mask = 0;            ///< Bits that at least one primitive has.
  const std::uint8_t* isolated_solids =
      nullptr;  ///< Per solid, 1 where nothing else reaches into it.
  std::uint32_t triangle_count = 0;
  std::uint32_t ellipsoid_count = 0;
  Box3f bounds;

  /// The first block of a leaf of triangles only.
  const TriangleBlock& block(KdChild leaf) const {
    return *reinterpret_cast<const TriangleBlock*>(blocks + (leaf & kIndexMask));
  }
  bool is_isolated_solid(std::uint32_t primitive) const {
    return primitive != kNoPrimitive && primitive >= triangle_count &&
           isolated_solids[primitive - triangle_count] != 0;
  }
  bool is_visible(std::uint32_t primitive, VisibilityMask mask) const {
    return masks == nullptr || (masks[primitive] & mask) != 0;
  }
};

}  // namespace abbe
