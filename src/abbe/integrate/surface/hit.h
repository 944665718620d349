/// What the lanes of a fan met, in SIMD layout: the working set of shading.
#pragma once

#include <cstdint>
#include <span>

#include "abbe/integrate/surface/contact.h"
#include "abbe/integrate/surface/point.h"
#include "abbe/math/lane_array.h"
#include "abbe/math/lane_mask.h"

namespace abbe {

/// Lanes of one fan that met the same surface from the same side, and where. In a united fan the
/// geometry is the same in all lanes; it is filled in all the same, so that there is one kind of
/// shading code. Lanes that are not of the group have the geometry of its first.
struct SurfaceHit {
  LaneMask lanes;
  std::uint32_t surface = 0;         ///< Index into Geometry::surfaces.
  bool front = false;                ///< Met from outside.
  const Contact* contact = nullptr;  ///< What is there besides; null: nothing.
  /// For textures: of each lane where `points_differ`, else of the first alone.
  std::span<const SurfacePoint> points;
  bool points_differ = false;
  /// What the lanes met: each its own, or one for all.
  std::span<const std::uint32_t> primitives;

  LaneArray3 position;
  LaneArray3 direction;  ///< Of arrival.
  LaneArray3 outward;    ///< Geometric normal, out of the solid.
  LaneArray3 normal;     ///< Shading normal on the side of arrival.
  LaneArray offset_m;    ///< Step off the surface along the geometric normal.
  LaneArray distance_m;

  const SurfacePoint& point(int lane) const { return points[points_differ ? lane : 0]; }
  std::uint32_t primitive(int lane) const { return primitives[primitives.size() > 1 ? lane : 0]; }
};

/// What the surface is to a ray in `media`.
inline MediumChange change_at(const World& world, const SurfaceHit& hit, const MediumStack& media) {
  const std::uint32_t number = world.geometry.surfaces[hit.surface].material;
  const SurfaceMaterial& material = world.materials[number];
  const MetFace alone{number, material.priority, hit.front};
  return cross(media, material.transmission,
               hit.contact != nullptr ? hit.contact->all_faces() : std::span(&alone, 1));
}

/// How a ray starts that leaves the surface in a direction, met by the ray that arrived.
inline Departure departure_from(const SurfaceHit& hit, int lane, const Vec3f& direction) {
  if (hit.contact == nullptr) return {};
  const float cosine = glm::dot(direction, hit.outward.get(lane));
  const bool goes_on = (cosine < 0.0f) == hit.front;
  const Nearby nearby = goes_on ? hit.contact->beyond : hit.contact->arrival;
  if (nearby == Nearby::Nothing) return {};
  return {hit.surface, reach_along(*hit.contact, cosine)};
}
/// Of rays in `lanes`, where something is nearby on the way of any.
inline Departure departure_from(const SurfaceHit& hit, LaneMask lanes,
                                const LaneArray3& directions) {
  Departure all;
  if (hit.contact == nullptr) return all;
  for (; lanes.any(); lanes.reset(lanes.front())) {
    const int lane = lanes.front();
    const Departure own = departure_from(hit, lane, directions.get(lane));
    if (own.is_crowded()) all = {own.surface, std::max(all.reach_m, own.reach_m)};
  }
  return all;
}

inline const SurfaceMaterial& material_of(const World& world, const SurfaceHit& hit) {
  return world.materials[world.geometry.surfaces[hit.surface].material];
}

}  // namespace abbe
