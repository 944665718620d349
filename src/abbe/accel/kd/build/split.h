/// Where to split a cell: the surface area heuristic, binned or exact.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "abbe/accel/kd/build/sah.h"

namespace abbe {

/// Finds splits; keeps its scratch memory between calls.
class SplitFinder {
 public:
  SplitFinder(const ShapeSpans& shapes, const KdTreeConfig& config)
      : triangle_count_(shapes.triangles.size()), config_(config) {}

  /// The cheapest split that adds at most `max_added` primitives, if any is cheaper than a leaf.
  std::optional<Split> find(std::span<const BuildPrimitive> primitives, const Box3f& cell,
                            std::size_t max_added);

 private:
  void search_binned(std::span<const BuildPrimitive> primitives, SahCell& cell) const;
  void search_exact(std::span<const BuildPrimitive> primitives, int axis, SahCell& cell);

  std::size_t triangle_count_;
  KdTreeConfig config_;
  std::vector<float> lows_, highs_, planar_;
};

}  // namespace abbe
