/// Light that a place on an emitter sends to the lanes of a fan. Highway code, compiled once per
/// instruction set.

#if defined(ABBE_INTEGRATE_LIGHT_EMITTED_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef ABBE_INTEGRATE_LIGHT_EMITTED_INL_H_
#undef ABBE_INTEGRATE_LIGHT_EMITTED_INL_H_
#else
#define ABBE_INTEGRATE_LIGHT_EMITTED_INL_H_
#endif

#include <algorithm>
#include <cmath>
#include <span>

#include "abbe/integrate/surface/layers-inl.h"
#include "abbe/integrate/surface/material_lanes-inl.h"
#include "abbe/integrate/surface/point.h"
#include "abbe/optics/fresnel.h"
#include "abbe/optics/rough/layer_albedo.h"
#include "abbe/world/emitters.h"
#include "abbe/world/light/lights.h"

HWY_BEFORE_NAMESPACE();
namespace abbe {
namespace HWY_NAMESPACE {

/// An emitter at a spot; of one that has no triangles, what materials ask.
inline SurfacePoint point_of(const World& world, const WorldEmitters::Spot& spot) {
  if (world.geometry.is_triangle(spot.primitive)) {
    Hit hit;
    hit.primitive = spot.primitive;
    hit.u = spot.weights.x;
    hit.v = spot.weights.y;
    return triangle_point(world, triangle_frame(world, spot.primitive), hit);
  }
  SurfacePoint point;
  point.surface = world.geometry.surface_of(spot.primitive);
  point.normal = point.shading_normal = point.coat_normal = spot.normal;
  return point;
}

/// Radiance of an emitter at a spot, per lane, as rays that meet it see it. Returns a bound, along
/// the normal, on where rays meet it instead.
template <class D>
float EmissionAt(D d, const World& world, const WorldEmitters::Spot& spot, int set,
                 LaneArray& radiance) {
  const SurfacePoint point = point_of(world, spot);
  const SurfaceMaterial& material =
      world.materials[world.geometry.surfaces[point.surface].material];
  const MaterialSample here = material_sample(world, material, point, 0.0f);
  LaneArray scale;
  if (!here.emission.uses_row) Splat(d, world.lanes.lane_stride(), here.emission_scale, scale);
  FillEmission(d, world, material, std::span(&here.emission, 1), scale, set, radiance);
  if (here.alpha != 1.0f) {
    for (int lane = 0; lane < world.lanes.lane_stride(); ++lane) radiance[lane] *= here.alpha;
  }
  const Vec3f size = glm::abs(spot.position);
  return 2.0f * point.offset_m + 1e-6f * (size.x + size.y + size.z);
}

/// What the clearcoat of an emitter leaves of its light on the way to places of lanes, as for rays
/// that see it from there.
/// Units:  n_medium per lane, of the medium between; null: 1.
inline void DimByCoat(const World& world, const WorldEmitters::Spot& spot,
                      const LaneArray3& positions, const float* n_medium, LaneArray& radiance) {
  const SurfaceMaterial& material =
      world.materials[world.geometry.surfaces[world.geometry.surface_of(spot.primitive)].material];
  if (!material.layers || !material.layers->coat) return;
  const SurfacePoint point = point_of(world, spot);
  const LayerSample layers = layer_sample(world, material, point, 0.0f);
  const Vec3f own = material.coat_has_own_normal() ? point.coat_normal : point.shading_normal;
  for (int lane = 0; lane < world.lanes.lane_stride(); ++lane) {
    const Vec3f way = glm::normalize(positions.get(lane) - spot.position);
    const float side = glm::dot(way, spot.normal) < 0.0f ? -1.0f : 1.0f;
    if (side < 0.0f && material.transmission != Transmission::None) continue;
    float cosine = side * glm::dot(way, own);
    if (!(cosine > 0.0f)) cosine = side * glm::dot(way, spot.normal);
    const double eta = kCoatIndex / (n_medium != nullptr ? n_medium[lane] : 1.0f);
    const float reflected =
        layers.coat_roughness >= kSmoothRoughness
            ? LayerAlbedo::table().coat(cosine, layers.coat_roughness)
            : static_cast<float>(fresnel_dielectric(std::min(1.0, static_cast<double>(cosine)), eta)
                                     .reflectance());
    radiance[lane] *= 1.0f - layers.coat * reflected;
  }
}

/// The way from places of lanes to a spot, and what arrives there of `radiance` per density of the
/// spot: L·cosθ/(r²·p). On demand also that density per steradian.
inline void LightFromSpot(const WorldEmitters::Spot& spot, int stride, const LaneArray& radiance,
                          const LaneArray3& positions, LightGeometry& geometry,
                          LaneArray* density = nullptr) {
  for (int lane = 0; lane < stride; ++lane) {
    const Vec3f way = spot.position - positions.get(lane);
    const float distance2 = std::max(glm::dot(way, way), 1e-30f);
    const float distance = std::sqrt(distance2);
    const Vec3f direction = way / distance;
    const float cosine = -glm::dot(direction, spot.normal);
    const float shown = spot.two_sided ? std::abs(cosine) : std::max(cosine, 0.0f);
    geometry.direction.set(lane, direction);
    geometry.distance_m[lane] = distance;
    const float per_shown = distance2 * spot.per_m2;
    geometry.irradiance[lane] = radiance[lane] * shown / per_shown;
    if (density != nullptr) (*density)[lane] = per_shown / std::max(shown, 1e-15f);
  }
}

/// From just off a surface to a spot, and not up to where rays meet the emitter: that is up to
/// `rounding_m` off along its normal. The start has moved aside, too; it is aimed at anew.
inline Ray ray_to_spot(const WorldEmitters::Spot& spot, float rounding_m, const Vec3f& origin) {
  const Vec3f way = spot.position - origin;
  const float distance = std::max(glm::length(way), 1e-30f);
  const Vec3f direction = way / distance;
  const float cosine = std::max(std::abs(glm::dot(direction, spot.normal)), 1e-3f);
  const float end_m = distance - 1e-5f * distance - rounding_m / cosine;
  return {origin, std::max(end_m, 0.0f), direction};
}

}  // namespace HWY_NAMESPACE
}  // namespace abbe
HWY_AFTER_NAMESPACE();

#endif  // ABBE_INTEGRATE_LIGHT_EMITTED_INL_H_
