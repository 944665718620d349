/// The surface area heuristic of one cell: what a plane that splits it costs.
#pragma once

#include <algorithm>
#include <cstddef>

#include "abbe/accel/kd/build/primitives.h"
#include "abbe/accel/kd/tree.h"

namespace abbe {

struct Split {
  int axis = 0;
  float plane = 0.0f;
  bool planar_below = true;  ///< Where primitives that lie in the plane go.
  float cost = 0.0f;

  bool goes_below(const BuildPrimitive& p) const {
    return p.low[axis] < plane || (is_planar(p) && planar_below);
  }
  bool goes_above(const BuildPrimitive& p) const {
    return p.high[axis] > plane || (is_planar(p) && !planar_below);
  }

 private:
  bool is_planar(const BuildPrimitive& p) const {
    return p.low[axis] == plane && p.high[axis] == plane;
  }
};

/// The costs of a cell's splits, and the best of those that were rated.
struct SahCell {
  float traversal_cost, block_cost, empty_factor;
  Box3f box;
  std::size_t count;      ///< Primitives in the cell.
  std::size_t max_parts;  ///< Of both sides together.
  std::size_t block_size;
  float solid_share;  ///< Of the primitives, taken to be the same on both sides of a plane.
  Vec3f size;
  float inverse_area;
  Split best;  ///< Not split: the cost of a leaf.
  bool found = false;

  SahCell(const KdTreeConfig& config, const Box3f& cell, std::size_t primitives,
          std::size_t max_added, float solids)
      : traversal_cost(config.traversal_cost),
        block_cost(config.block_cost),
        empty_factor(1.0f - config.empty_bonus),
        box(cell),
        count(primitives),
        max_parts(primitives + max_added),
        block_size(std::max(config.block_size, 1u)),
        solid_share(solids),
        size(cell.size()) {
    const float half_area = size.x * size.y + size.y * size.z + size.z * size.x;
    inverse_area = half_area > 0.0f ? 1.0f / half_area : 0.0f;
    best.cost = leaf_cost(primitives);
  }

  /// A block of triangles costs as much as one of them, a solid as much as a block.
  float leaf_cost(std::size_t n) const {
    const auto blocks = static_cast<float>((n + block_size - 1) / block_size);
    return block_cost * std::max(blocks, solid_share * static_cast<float>(n));
  }

  /// Area of the cell's side across an axis, and length of that side's rim by 2.
  float side(int axis) const { return size[(axis + 1) % 3] * size[(axis + 2) % 3]; }
  float rim(int axis) const { return size[(axis + 1) % 3] + size[(axis + 2) % 3]; }

  /// Takes the plane if it is inside the cell and cheaper than the best so far.
  void rate(int axis, float plane, std::size_t below, std::size_t above, bool planar_below) {
    if (!(plane > box.low[axis] && plane < box.high[axis])) return;
    if (below + above > max_parts) return;
    const float p_below = (side(axis) + (plane - box.low[axis]) * rim(axis)) * inverse_area;
    const float p_above = (side(axis) + (box.high[axis] - plane) * rim(axis)) * inverse_area;
    float cost = traversal_cost + p_below * leaf_cost(below) + p_above * leaf_cost(above);
    if (below == 0 || above == 0) cost *= empty_factor;
    if (cost < best.cost) {
      best = {axis, plane, planar_below, cost};
      found = true;
    }
  }
};

}  // namespace abbe
