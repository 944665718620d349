/// Brute force: every primitive, for every ray. What other accelerators are compared with, and fast
/// enough for a handful of shapes.
#pragma once

#include <cstddef>
#include <span>

#include "abbe/accel/accelerator.h"
#include "abbe/accel/leaf/block.h"
#include "abbe/accel/leaf/solids.h"
#include "abbe/accel/leaf/visibility.h"
#include "abbe/base/flat_array.h"

namespace abbe {

/// All primitives in the order of their numbers. Every query is one for all hits.
class BruteForce final : public Accelerator {
 public:
  explicit BruteForce(const ShapeSpans& shapes);

  using Accelerator::all_hits;
  using Accelerator::any_hits;
  using Accelerator::closest_hits;
  void closest_hits(std::span<const Ray> rays, QueryMask mask, std::span<Hit> hits) const override;
  void any_hits(std::span<const Ray> rays, QueryMask mask,
                std::span<std::uint8_t> occluded) const override;
  void all_hits(std::span<const Ray> rays, QueryMask mask, VisibilityMask stops,
                HitLists& hits) const override;
  Hit closest_hit_with_cost(const Ray& ray, QueryMask mask, QueryCost& cost) const override;
  bool any_hit_with_cost(const Ray& ray, QueryMask mask, QueryCost& cost) const override;
  std::string_view name() const override { return "brute"; }
  std::size_t rays_worth_a_call() const override { return 1; }
  Box3f bounds() const override { return bounds_; }
  std::size_t bytes() const override;

 private:
  FlatArray<BlockLine> blocks_;  // All loose, and so of the same size.
  std::uint32_t solid_count_ = 0;
  SolidStore solids_;
  Visibility visibility_;
  Box3f bounds_;
};

}  // namespace abbe
