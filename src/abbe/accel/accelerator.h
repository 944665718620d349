/// What rays meet: the one interface of all accelerators, asked in batches.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "abbe/accel/query.h"
#include "abbe/accel/shapes.h"

namespace abbe {

/// Answers questions of rays about a copy of a world's shapes; immutable, and asked by any number
/// of threads. All accelerators test primitives alike (leaf/), so their answers are the same to the
/// bit. Of hits at the same distance the one of the lower primitive comes first.
///
/// A query sees the primitives that share a bit with its mask, at t in the open segment
/// (0, t_max). Shape: an answer for each ray, or packet. Domain: finite origins, finite non-zero
/// directions, whose components may be zero or denormal. Errors: none but std::bad_alloc.
class Accelerator {
 public:
  virtual ~Accelerator() = default;

  /// The nearest hit of each ray.
  virtual void closest_hits(std::span<const Ray> rays, QueryMask mask,
                            std::span<Hit> hits) const = 0;
  /// Whether each ray meets anything: 1 or 0.
  virtual void any_hits(std::span<const Ray> rays, QueryMask mask,
                        std::span<std::uint8_t> occluded) const = 0;
  /// All hits of each ray, the nearest first, up to and with the first of a primitive that shares a
  /// bit with `stops`: the list of ray i is hits[i]. A solid is met where the ray enters and where
  /// it leaves. Faces in contact are all in the list, in the order of their numbers.
  virtual void all_hits(std::span<const Ray> rays, QueryMask mask, VisibilityMask stops,
                        HitLists& hits) const = 0;

  /// The same for packets; lanes that are not active meet nothing. Without an implementation of
  /// their own they are answered ray by ray.
  virtual void closest_hits(std::span<const RayPacket> packets, QueryMask mask,
                            std::span<HitPacket> hits) const;
  /// Whether each lane meets anything: one bit for each.
  virtual void any_hits(std::span<const RayPacket> packets, QueryMask mask,
                        std::span<std::uint32_t> occluded) const;
  /// The list of a lane is hits[16·packet + lane].
  virtual void all_hits(std::span<const RayPacket> packets, QueryMask mask, VisibilityMask stops,
                        HitLists& hits) const;

  /// The nearest hit of one ray; adds the work that it takes alone.
  virtual Hit closest_hit_with_cost(const Ray& ray, QueryMask mask, QueryCost& cost) const = 0;
  /// Whether one ray meets anything, likewise.
  virtual bool any_hit_with_cost(const Ray& ray, QueryMask mask, QueryCost& cost) const = 0;

  virtual std::string_view name() const = 0;  ///< One of accelerator_names().

  /// So many rays are worth a call: fewer in each cost more time per ray.
  virtual std::size_t rays_worth_a_call() const = 0;

  virtual Box3f bounds() const = 0;       ///< Of all primitives; empty if there is none.
  virtual std::size_t bytes() const = 0;  ///< Memory held, shapes included.
};

/// The names that build_accelerator() knows; the first is the one to use.
const std::vector<std::string>& accelerator_names();

/// Builds the accelerator of that name: `kdtree`, or `brute`, which tests every primitive.
/// Domain: every position finite, every triangle of non-zero area (drop others before), fewer than
///         2^31 primitives; any of the spans may be empty. They are not referred to afterwards.
/// Errors: a usage error about `accelerator` that lists the names, for any other name.
std::unique_ptr<const Accelerator> build_accelerator(std::string_view name,
                                                     const ShapeSpans& shapes);

}  // namespace abbe
