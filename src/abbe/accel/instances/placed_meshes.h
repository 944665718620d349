/// Meshes that stand at several places: a tree for each mesh, and one over the places.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <vector>

#include "abbe/accel/accelerator.h"
#include "abbe/accel/instances/tree.h"
#include "abbe/accel/leaf/visibility.h"

namespace abbe {

/// Everything that is not placed in one accelerator, every mesh in one of its own, in the space of
/// the mesh: a ray is moved there. Its hits are those of an accelerator over all triangles in the
/// world but for rounding: of the ray to single precision in mesh space, by one part in 2^24 of
/// its coordinates there, instead of the corners in the world. All triangles of a place see the
/// same ray: none slips through between two of them.
class PlacedMeshes final : public Accelerator {
 public:
  using Build = std::function<std::unique_ptr<const Accelerator>(const ShapeSpans&)>;

  /// Builds the parts. Domain: that of build_accelerator(), with at least one place.
  PlacedMeshes(const ShapeSpans& shapes, const Build& build);

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
  std::string_view name() const override { return rest_->name(); }
  std::size_t rays_worth_a_call() const override { return rest_->rays_worth_a_call(); }
  Box3f bounds() const override;
  std::size_t bytes() const override;

 private:
  struct Place {
    Mat3d to_mesh_linear;
    Vec3d to_mesh_offset;
    std::uint32_t mesh, first_primitive;
    VisibilityMask mask;
    bool front_only, is_mirrored;
  };
  struct Job {
    std::uint32_t search, place;
  };

  template <class Kind>
  void search(std::size_t count, QueryMask mask, Kind& kind) const;
  struct ClosestRays;
  struct AnyRays;
  struct AllRays;
  struct ClosestPackets;
  struct AnyPackets;
  struct OneRay;

  static QueryMask query_of(const Place& place, QueryMask mask);
  PlaceBeam beam_of_ray(const Ray& ray) const;
  PlaceBeam beam_of_packet(const RayPacket& packet) const;
  Ray in_mesh(const Ray& ray, const Place& place, float t_max) const;

  std::unique_ptr<const Accelerator> rest_;
  Visibility visibility_;  // Of the rest.
  std::vector<std::unique_ptr<const Accelerator>> meshes_;
  std::vector<Place> places_;
  PlaceTree tree_;
  float reach_m_ = 0.0f;
};

}  // namespace abbe
