/// Where to split a cell: the surface area heuristic, binned or exact.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "accel/kd_reference.h"
#include "accel/kd_tree.h"

namespace abbe {

struct Split {
  int axis = 0;
  float plane = 0.0f;
  bool planar_below = true;  ///< Where primitives that lie in the plane go.
  float cost = 0.0f;

  bool goes_below(const BuildReference& r) const {
    return r.low[axis] < plane || (is_planar(r) && planar_below);
  }
  bool goes_above(const BuildReference& r) const {
    return r.high[axis] > plane || (is_planar(r) && !planar_below);
  }

 private:
  bool is_planar(const BuildReference& r) const {
    return r.low[axis] == plane && r.high[axis] == plane;
  }
};

/// Finds splits; keeps its scratch memory between calls.
class SplitFinder {
 public:
  SplitFinder(const ShapeSpans& shapes, const KdTreeConfig& config)
      : triangle_count_(shapes.triangles.size()), config_(config) {}

  /// The cheapest split that adds at most `max_added` references, if any is cheaper than a leaf.
  std::optional<Split> find(std::span<const BuildReference> references, const Box3f& cell,
                            std::size_t max_added);

 private:
  struct Candidate;
  void search_binned(std::span<const BuildReference> references, Candidate& best) const;
  void search_exact(std::span<const BuildReference> references, int axis, Candidate& best);

  std::size_t triangle_count_;
  KdTreeConfig config_;
  std::vector<float> lows_, highs_, planar_;
};

}  // namespace abbe
