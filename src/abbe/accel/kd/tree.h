/// The k-d tree: a surface-area-heuristic tree over triangles, ellipsoids and convex polyhedra.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>

#include "abbe/accel/accelerator.h"

namespace abbe {

/// How a tree is built. The defaults are measured; see tests/bench. Any values give the same hits.
struct KdTreeConfig {
  float traversal_cost = 1.0f;  ///< SAH cost of visiting a node.
  float block_cost = 1.5f;      ///< SAH cost of testing a block of triangles, or one solid.
  /// Triangles that a block is taken to hold, at most 16; 0 chooses 14 where triangles share their
  /// vertices, of which a block has room for sixteen, and else 16.
  std::uint32_t block_size = 0;
  float empty_bonus = 0.15f;     ///< Share of cost forgiven when a split cuts off empty space.
  std::uint32_t leaf_size = 1;   ///< Cells with so many primitives or fewer are never split.
  std::uint32_t max_depth = 64;  ///< Deepest leaf, at most 96.
  std::uint32_t bins = 64;       ///< Planes tried per axis in large cells, at most 256.
  /// Cells of more primitives try planes at the borders of bins: within 1 % of the best split, in a
  /// fraction of the time. Smaller ones try the sides of every primitive.
  std::uint32_t exact_limit = 256;
  /// Parts that splits may make of a primitive, on average, or a million of them all if that is
  /// more. A cell shares what is left with its halves, so input that cannot be separated takes
  /// bounded memory and linear time.
  float max_build_primitives = 4.0f;
};

/// A tree over a copy of the shapes' data; it does not refer to the spans after build().
class KdTree final : public Accelerator {
 public:
  /// Builds in time O(n log n), linear in degenerate input, in parallel.
  /// Domain: as build_accelerator() has it.
  static KdTree build(const ShapeSpans& shapes, const KdTreeConfig& config = {});

  KdTree();  ///< Of an empty world.
  KdTree(KdTree&&) noexcept;
  KdTree& operator=(KdTree&&) noexcept;
  ~KdTree() override;

  void closest_hits(std::span<const Ray> rays, QueryMask mask, std::span<Hit> hits) const override;
  void any_hits(std::span<const Ray> rays, QueryMask mask,
                std::span<std::uint8_t> occluded) const override;
  void all_hits(std::span<const Ray> rays, QueryMask mask, VisibilityMask stops,
                HitLists& hits) const override;
  void closest_hits(std::span<const RayPacket> packets, QueryMask mask,
                    std::span<HitPacket> hits) const override;
  void any_hits(std::span<const RayPacket> packets, QueryMask mask,
                std::span<std::uint32_t> occluded) const override;
  using Accelerator::all_hits;
  Hit closest_hit_with_cost(const Ray& ray, QueryMask mask, QueryCost& cost) const override;
  bool any_hit_with_cost(const Ray& ray, QueryMask mask, QueryCost& cost) const override;
  std::string_view name() const override { return "kdtree"; }
  std::size_t rays_worth_a_call() const override;
  Box3f bounds() const override;
  std::size_t bytes() const override;

 private:
  struct Data;
  std::unique_ptr<const Data> data_;
};

}  // namespace abbe
