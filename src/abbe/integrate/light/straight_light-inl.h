/// Light of lamps that arrives straight. Highway code, compiled once per instruction set.

#if defined(ABBE_INTEGRATE_LIGHT_STRAIGHT_LIGHT_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef ABBE_INTEGRATE_LIGHT_STRAIGHT_LIGHT_INL_H_
#undef ABBE_INTEGRATE_LIGHT_STRAIGHT_LIGHT_INL_H_
#else
#define ABBE_INTEGRATE_LIGHT_STRAIGHT_LIGHT_INL_H_
#endif

#include <hwy/highway.h>

#include "abbe/integrate/light/light_geometry.h"
#include "abbe/math/lanes-inl.h"
#include "abbe/world/world.h"

HWY_BEFORE_NAMESPACE();
namespace abbe {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

/// KHR_lights_punctual's window of distance and cone of a spot, for a lamp in direction `to_light`.
template <class D>
HWY_INLINE VecOf<D> LampWindow(D d, const WorldLight& light, VecOf<D> distance,
                               const Vec3Of<D>& to_light) {
  const auto one = hn::Set(d, 1.0f);
  const auto zero = hn::Zero(d);
  auto window = one;
  if (light.range_m < kInfinity) {
    const auto ratio = hn::Div(distance, hn::Set(d, light.range_m));
    const auto ratio2 = hn::Mul(ratio, ratio);
    window = hn::Max(hn::Min(hn::Sub(one, hn::Mul(ratio2, ratio2)), one), zero);
  }
  if (light.type == LightType::Spot) {
    const auto cosine = Dot3(d, to_light, Set3(d, -light.direction));
    const auto cone = hn::Max(hn::Min(hn::Add(hn::Mul(cosine, hn::Set(d, light.spot_scale)),
                                              hn::Set(d, light.spot_offset)),
                                      one),
                              zero);
    window = hn::Mul(window, hn::Mul(cone, cone));
  }
  return window;
}

/// Light of a lamp that arrives straight, per lane, before visibility: Φ/r² and
/// KHR_lights_punctual's window and cone, or the irradiance of parallel light inside its beam.
template <class D>
HWY_INLINE void StraightLight(D d, int stride, const WorldLight& light, const float* light_row,
                              const LaneArray3& positions, LightGeometry& geometry) {
  const auto one = hn::Set(d, 1.0f);
  const auto zero = hn::Zero(d);
  const int step = static_cast<int>(hn::Lanes(d));
  for (int i = 0; i < stride; i += step) {
    Vec3Of<D> to_light;
    auto attenuation = one;
    auto distance = hn::Set(d, kInfinity);
    if (light.type == LightType::Directional) {
      to_light = Set3(d, -light.direction);
      if (light.is_beam) {
        const auto position = Load3(d, positions, i);
        const auto from_light =
            Combine3(d, one, position, hn::Set(d, -1.0f), Set3(d, light.position));
        const auto along = Dot3(d, from_light, Set3(d, light.direction));
        const auto x = hn::Abs(Dot3(d, from_light, Set3(d, light.beam_x)));
        const auto y = hn::Abs(Dot3(d, from_light, Set3(d, light.beam_y)));
        const auto inside =
            hn::And(hn::Ge(along, zero), hn::And(hn::Le(x, hn::Set(d, light.beam_half_x_m)),
                                                 hn::Le(y, hn::Set(d, light.beam_half_y_m))));
        attenuation = hn::IfThenElseZero(inside, one);
        distance = hn::Max(along, zero);
      }
    } else {
      const auto position = Load3(d, positions, i);
      const Vec3Of<D> offset{hn::Sub(hn::Set(d, light.position.x), position.x),
                             hn::Sub(hn::Set(d, light.position.y), position.y),
                             hn::Sub(hn::Set(d, light.position.z), position.z)};
      const auto distance2 = hn::Max(Dot3(d, offset, offset), hn::Set(d, 1e-30f));
      distance = hn::Sqrt(distance2);
      const auto inverse = hn::Div(one, distance);
      to_light = {hn::Mul(offset.x, inverse), hn::Mul(offset.y, inverse),
                  hn::Mul(offset.z, inverse)};
      attenuation = hn::Mul(hn::Div(one, distance2), LampWindow(d, light, distance, to_light));
    }
    Store3(d, to_light, geometry.direction, i);
    hn::Store(distance, d, geometry.distance_m.v + i);
    hn::Store(hn::Mul(hn::LoadU(d, light_row + i), attenuation), d, geometry.irradiance.v + i);
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace abbe
HWY_AFTER_NAMESPACE();

#endif  // ABBE_INTEGRATE_LIGHT_STRAIGHT_LIGHT_INL_H_
