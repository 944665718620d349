/// From the builder's binary tree to the arrays that queries read.
#pragma once

#include <vector>

#include "abbe/accel/kd/build/build.h"
#include "abbe/accel/kd/layout.h"

namespace abbe {

/// The finished arrays of a tree.
struct KdArrays {
  KdChild root = kEmptyChild;
  FlatArray<WideNode> nodes;  ///< Node 0 is not used: 0 means nothing.
  FlatArray<BlockLine> blocks;
  std::uint32_t lines_ahead = kSharedBlockLines;  ///< Of the kind of block that is more frequent.
  std::vector<MixedLeaf> mixed_leaves;
  std::vector<std::uint32_t> solids;
};

/// Collapses three levels of binary nodes into each wide node and packs triangles into blocks.
KdArrays convert_kd_tree(const BuildTree& tree, const ShapeSpans& shapes);

}  // namespace abbe
