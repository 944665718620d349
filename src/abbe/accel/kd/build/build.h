/// From shapes to a binary k-d tree by the surface area heuristic.
#pragma once

#include <cstdint>
#include <vector>

#include "abbe/accel/kd/tree.h"

namespace abbe {

/// A node of the tree under construction.
struct BuildNode {
  static constexpr std::uint32_t kLeaf = 3;
  std::uint32_t axis = kLeaf;  ///< 0, 1, 2, or kLeaf.
  float plane = 0.0f;
  std::uint32_t first = 0;   ///< Child below the plane; of a leaf the first entry in `primitives`.
  std::uint32_t second = 0;  ///< Child above the plane; of a leaf the number of primitives.
};

/// A binary tree whose root is node 0; leaves list primitives in ascending order.
struct BuildTree {
  std::vector<BuildNode> nodes;
  std::vector<std::uint32_t> primitives;
  Box3f bounds;
};

/// Builds the tree; the result does not depend on the number of threads.
/// Source: Wald & Havran, On building fast kd-trees for ray tracing, and on doing that in
///         O(N log N), 2006.
BuildTree build_kd_tree(const ShapeSpans& shapes, const KdTreeConfig& config);

}  // namespace abbe
