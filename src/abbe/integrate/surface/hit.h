/// What the lanes of a fan met, in SIMD layout: the working set of shading.
#pragma once

#include <cstdint>
#include <span>

#include "abbe/integrate/surface/point.h"
#include "abbe/math/lane_array.h"
#include "abbe/math/lane_mask.h"

namespace abbe {

/// Lanes of one fan that met the same surface from the same side, and where. In a united fan the
/// geometry is the same in all lanes; it is filled in all the same, so that there is one kind of
/// shading code. Lanes that are not of the group have the geometry of its first.
struct SurfaceHit {
  LaneMask lanes;
  std::uint32_t surface = 0;  ///< Index into Geometry::surfaces.
  bool front = false;         ///< Met from outside.
  /// For textures: of each lane where `points_differ`, else of the first alone.
  std::span<const SurfacePoint> points;
  bool points_differ = false;

  LaneArray3 position;
  LaneArray3 direction;  ///< Of arrival.
  LaneArray3 outward;    ///< Geometric normal, out of the solid.
  LaneArray3 normal;     ///< Shading normal on the side of arrival.
  LaneArray offset_m;    ///< Step off the surface along the geometric normal.
  LaneArray distance_m;

  const SurfacePoint& point(int lane) const { return points[points_differ ? lane : 0]; }
};

inline const SurfaceMaterial& material_of(const World& world, const SurfaceHit& hit) {
  return world.materials[world.geometry.surfaces[hit.surface].material];
}

}  // namespace abbe
