/// How a finished k-d tree lies in memory, and the view of it that the query kernels read.
#pragma once

#include <cstddef>
#include <cstdint>

#include "abbe/accel/leaf/block.h"
#include "abbe/accel/leaf/solids.h"
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

/// The rest of a leaf behind its first block, kEmptyChild if there is none.
inline KdChild next_block(const TriangleBlock& first, KdChild leaf) {
  return first.next_lines != 0 ? leaf + first.next_lines : kEmptyChild;
}

/// A leaf that holds solids, and perhaps triangles too.
struct MixedLeaf {
  KdChild triangles;                       ///< A leaf of triangles only, or kEmptyChild.
  std::uint32_t first_solid, solid_count;  ///< In KdView::leaf_solids.
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
  const std::uint32_t* leaf_solids = nullptr;  ///< Numbers of the solids in mixed leaves.
  SolidView solids;
  const VisibilityMask* masks = nullptr;  ///< Null where a query sees all primitives.
  Box3f bounds;

  /// The first block of a leaf of triangles only.
  const TriangleBlock& block(KdChild leaf) const { return block_at(blocks + (leaf & kIndexMask)); }
  bool is_visible(std::uint32_t primitive, QueryMask mask) const {
    return masks == nullptr || (masks[primitive] & mask) != 0;
  }
};

}  // namespace abbe
