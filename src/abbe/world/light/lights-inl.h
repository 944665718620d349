/// Light of lamps for all lanes at once, by their kind. Highway code, compiled once per instruction
/// set.

#if defined(ABBE_WORLD_LIGHT_LIGHTS_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef ABBE_WORLD_LIGHT_LIGHTS_INL_H_
#undef ABBE_WORLD_LIGHT_LIGHTS_INL_H_
#else
#define ABBE_WORLD_LIGHT_LIGHTS_INL_H_
#endif

#include <algorithm>

#include "abbe/math/segment-inl.h"
#include "abbe/world/light/lights.h"

HWY_BEFORE_NAMESPACE();
namespace abbe {
namespace HWY_NAMESPACE {

/// The window of a lamp: what its range and cone leave of Φ/r².
/// Units:  `cosine` of the angle between the direction in which it shines and the light's own.
/// Domain: no parallel light; D in single or double precision.
/// Source: KHR_lights_punctual.
template <class D>
HWY_INLINE VecOf<D> LampWindow(D d, const WorldLight& light, VecOf<D> distance_m, VecOf<D> cosine) {
  using T = hn::TFromD<D>;
  const auto one = hn::Set(d, T{1});
  const auto zero = hn::Zero(d);
  auto window = one;
  if (light.range_m < kInfinity) {
    const auto ratio = hn::Div(distance_m, hn::Set(d, static_cast<T>(light.range_m)));
    const auto ratio2 = hn::Mul(ratio, ratio);
    window = hn::Max(hn::Min(hn::Sub(one, hn::Mul(ratio2, ratio2)), one), zero);
  }
  if (light.is_spot) {
    const auto along = hn::Mul(cosine, hn::Set(d, static_cast<T>(light.spot_scale)));
    const auto off = hn::Add(along, hn::Set(d, static_cast<T>(light.spot_offset)));
    const auto cone = hn::Max(hn::Min(off, one), zero);
    window = hn::Mul(window, hn::Mul(cone, cone));
  }
  return window;
}

/// What range, cone and shape of a lamp leave of Φ/r² where its light comes as if from its middle:
/// flat ones shine to one side, by Lambert's law. Units and domain: as LampWindow.
template <class D>
HWY_INLINE VecOf<D> WindowFromMiddle(D d, const WorldLight& light, VecOf<D> distance_m,
                                     VecOf<D> cosine) {
  const auto window = LampWindow(d, light, distance_m, cosine);
  const bool is_flat = light.extent && light.extent->is_flat();
  return is_flat ? hn::Mul(window, hn::Max(cosine, hn::Zero(d))) : window;
}

/// Light of a lamp that arrives straight, per lane, before visibility: Φ/r² and the lamp's window,
/// or the irradiance of parallel light inside its beam.
template <class D>
HWY_INLINE void StraightLight(D d, int stride, const WorldLight& light, const float* light_row,
                              const LaneArray3& positions, LightGeometry& geometry) {
  const auto one = hn::Set(d, 1.0f);
  const auto zero = hn::Zero(d);
  for (int i = 0; i < stride; i += static_cast<int>(hn::Lanes(d))) {
    Vec3Of<D> to_light;
    auto attenuation = one;
    auto distance = hn::Set(d, kInfinity);
    const auto position = Load3(d, positions, i);
    if (light.is_parallel) {
      to_light = Set3(d, -light.direction);
      if (light.beam) {
        const auto from_light =
            Combine3(d, one, position, hn::Set(d, -1.0f), Set3(d, light.position));
        const auto along = Dot3(d, from_light, Set3(d, light.direction));
        const auto x = hn::Abs(Dot3(d, from_light, Set3(d, light.beam->x)));
        const auto y = hn::Abs(Dot3(d, from_light, Set3(d, light.beam->y)));
        const auto inside =
            hn::And(hn::Ge(along, zero), hn::And(hn::Le(x, hn::Set(d, light.beam->half_x_m)),
                                                 hn::Le(y, hn::Set(d, light.beam->half_y_m))));
        attenuation = hn::IfThenElseZero(inside, one);
        distance = hn::Max(along, zero);
      }
    } else {
      const Vec3Of<D> offset{hn::Sub(hn::Set(d, light.position.x), position.x),
                             hn::Sub(hn::Set(d, light.position.y), position.y),
                             hn::Sub(hn::Set(d, light.position.z), position.z)};
      const auto distance2 = hn::Max(Dot3(d, offset, offset), hn::Set(d, 1e-30f));
      distance = hn::Sqrt(distance2);
      const auto inverse = hn::Div(one, distance);
      to_light = {hn::Mul(offset.x, inverse), hn::Mul(offset.y, inverse),
                  hn::Mul(offset.z, inverse)};
      const auto cosine = Dot3(d, to_light, Set3(d, -light.direction));
      attenuation = hn::Mul(hn::Div(one, distance2), WindowFromMiddle(d, light, distance, cosine));
    }
    Store3(d, to_light, geometry.direction, i);
    hn::Store(distance, d, geometry.distance_m.v + i);
    hn::Store(hn::Mul(hn::LoadU(d, light_row + i), attenuation), d, geometry.irradiance.v + i);
  }
}

/// The parts of rays inside a beam.
template <class D>
HWY_INLINE void SegmentsInBeam(D d, int stride, const WorldLight& light, const LaneRays& rays,
                               LaneSegments& lit) {
  for (int i = 0; i < stride; i += static_cast<int>(hn::Lanes(d))) {
    const auto origin = Combine3(d, hn::Set(d, 1.0f), Load3(d, rays.origin, i), hn::Set(d, -1.0f),
                                 Set3(d, light.position));
    const auto direction = Load3(d, rays.direction, i);
    auto begin = hn::Zero(d);
    auto end = hn::Load(d, rays.end_m.v + i);
    const auto clip = [&](const Vec3f& normal, float half_m) {
      const auto n = Set3(d, normal);
      ClipSegment(d, hn::Add(Dot3(d, n, origin), hn::Set(d, half_m)), Dot3(d, n, direction), begin,
                  end);
    };
    clip(light.direction, 0.0f);
    clip(light.beam->x, light.beam->half_x_m);
    clip(-light.beam->x, light.beam->half_x_m);
    clip(light.beam->y, light.beam->half_y_m);
    clip(-light.beam->y, light.beam->half_y_m);
    hn::Store(begin, d, lit.begin_m.v + i);
    hn::Store(hn::Max(begin, end), d, lit.end_m.v + i);
  }
}

/// The part of every ray that a lamp shines on, whatever stands in between. Returns whether it is
/// anything in any lane.
/// Domain: all lanes have the same ray unless `has_ray_per_lane`.
template <class D>
HWY_INLINE bool LampSegments(D d, int stride, bool has_ray_per_lane, const WorldLight& light,
                             const LaneRays& rays, LaneSegments& lit) {
  const int last = has_ray_per_lane ? stride : 1;
  if (light.beam) {
    SegmentsInBeam(d, stride, light, rays, lit);
  } else {
    for (int lane = 0; lane < last; ++lane) {
      RaySegment segment{0.0f, rays.end_m[lane]};
      if (light.is_spot) {
        segment =
            segment_in_cone(light, rays.origin.get(lane), rays.direction.get(lane), segment.end_m);
      }
      lit.begin_m[lane] = segment.begin_m;
      lit.end_m[lane] = std::max(segment.begin_m, segment.end_m);
    }
    if (!has_ray_per_lane) lit.splat(d, stride);
  }
  bool any = false;
  for (int lane = 0; lane < last; ++lane) any |= lit.begin_m[lane] < lit.end_m[lane];
  return any;
}

}  // namespace HWY_NAMESPACE
}  // namespace abbe
HWY_AFTER_NAMESPACE();

#endif  // ABBE_WORLD_LIGHT_LIGHTS_INL_H_
