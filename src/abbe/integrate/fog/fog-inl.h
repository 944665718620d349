/// Fog for all lanes at once. Highway code, compiled once per instruction set.

#if defined(ABBE_INTEGRATE_FOG_FOG_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef ABBE_INTEGRATE_FOG_FOG_INL_H_
#undef ABBE_INTEGRATE_FOG_FOG_INL_H_
#else
#define ABBE_INTEGRATE_FOG_FOG_INL_H_
#endif

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>

#include "abbe/base/constants.h"
#include "abbe/integrate/light/light_geometry.h"
#include "abbe/math/lanes-inl.h"
#include "abbe/optics/fresnel-inl.h"
#include "abbe/world/world.h"

HWY_BEFORE_NAMESPACE();
namespace abbe {
namespace HWY_NAMESPACE {

/// Whether light has come a known way from this lamp: the sun shines from outside the fog.
inline bool HasDistance(const WorldLight& light) {
  return light.type != LightType::Directional || light.is_beam;
}

/// Multiplies by what fog lets through over a distance.
template <class D>
HWY_INLINE void FogAttenuate(D d, int stride, float extinction_per_m, const LaneArray& distance_m,
                             LaneArray& light) {
  for (int i = 0; i < stride; i += static_cast<int>(hn::Lanes(d))) {
    const auto depth = hn::Mul(hn::Set(d, extinction_per_m), hn::Load(d, distance_m.v + i));
    hn::Store(hn::Mul(hn::Load(d, light.v + i), ExpNegative(d, depth)), d, light.v + i);
  }
}

/// A stretch of every lane's ray.
struct Stretch {
  LaneArray begin_m, end_m;
};

/// The part of a ray [0, end) where normal·x + offset ≥ 0 on all side planes of a chain, or that
/// lies in a beam. Returns whether it is anything in any lane of positive weight.
template <class D>
HWY_INLINE void ClipStretch(D d, VecOf<D> height, VecOf<D> slope, VecOf<D>& begin, VecOf<D>& end) {
  const auto zero = hn::Zero(d);
  // height + t·slope ≥ 0.
  const auto crossing = hn::Div(hn::Neg(height), slope);
  begin = hn::IfThenElse(hn::Gt(slope, zero), hn::Max(begin, crossing), begin);
  end = hn::IfThenElse(hn::Lt(slope, zero), hn::Min(end, crossing), end);
  const auto never = hn::And(hn::Eq(slope, zero), hn::Lt(height, zero));
  end = hn::IfThenElse(never, hn::Neg(hn::Set(d, 1.0f)), end);
}

template <class D>
HWY_INLINE bool StretchInChain(D d, const World& world, const Chain& chain, int set,
                               const LaneArray3& origins, const LaneArray3& directions,
                               const LaneArray& ends_m, Stretch& stretch) {
  const auto zero = hn::Zero(d);
  const int stride = world.lanes.lane_stride();
  const float* rows = world.chain_rows.data() + chain.rows +
                      static_cast<std::size_t>(set) * chain.array_count() * stride;
  const float* sides = rows + (1 + 3 * chain.steps.size()) * stride;
  bool any = false;
  for (int i = 0; i < stride; i += static_cast<int>(hn::Lanes(d))) {
    const auto origin = Combine3(d, hn::Set(d, 1.0f), Load3(d, origins, i), hn::Set(d, -1.0f),
                                 Set3(d, chain.origin));
    const auto direction = Load3(d, directions, i);
    auto begin = zero;
    auto end = hn::IfThenElseZero(hn::Gt(hn::LoadU(d, rows + i), zero), hn::Load(d, ends_m.v + i));
    for (int side = 0; side < chain.side_count && !hn::AllFalse(d, hn::Lt(begin, end)); ++side) {
      const float* plane = sides + static_cast<std::size_t>(side) * 4 * stride;
      const Vec3Of<D> normal{hn::LoadU(d, plane + i), hn::LoadU(d, plane + stride + i),
                             hn::LoadU(d, plane + 2 * stride + i)};
      ClipStretch(d, hn::Add(Dot3(d, normal, origin), hn::LoadU(d, plane + 3 * stride + i)),
                  Dot3(d, normal, direction), begin, end);
    }
    any |= !hn::AllFalse(d, hn::Lt(begin, end));
    hn::Store(begin, d, stretch.begin_m.v + i);
    hn::Store(hn::Max(begin, end), d, stretch.end_m.v + i);
  }
  return any;
}

template <class D>
HWY_INLINE bool StretchInBeam(D d, int stride, const WorldLight& light, const LaneArray3& origins,
                              const LaneArray3& directions, const LaneArray& ends_m,
                              Stretch& stretch) {
  bool any = false;
  for (int i = 0; i < stride; i += static_cast<int>(hn::Lanes(d))) {
    const auto origin = Combine3(d, hn::Set(d, 1.0f), Load3(d, origins, i), hn::Set(d, -1.0f),
                                 Set3(d, light.position));
    const auto direction = Load3(d, directions, i);
    auto begin = hn::Zero(d);
    auto end = hn::Load(d, ends_m.v + i);
    const auto clip = [&](const Vec3f& normal, float half_m) {
      const auto n = Set3(d, normal);
      ClipStretch(d, hn::Add(Dot3(d, n, origin), hn::Set(d, half_m)), Dot3(d, n, direction), begin,
                  end);
    };
    clip(light.direction, 0.0f);
    clip(light.beam_x, light.beam_half_x_m);
    clip(-light.beam_x, light.beam_half_x_m);
    clip(light.beam_y, light.beam_half_y_m);
    clip(-light.beam_y, light.beam_half_y_m);
    any |= !hn::AllFalse(d, hn::Lt(begin, end));
    hn::Store(begin, d, stretch.begin_m.v + i);
    hn::Store(hn::Max(begin, end), d, stretch.end_m.v + i);
  }
  return any;
}

/// A stretch of one ray; nothing where end ≤ begin.
struct StretchM {
  float begin_m = 0.0f, end_m = 0.0f;
};

/// The part of a ray [0, end) inside the cone of a spot.
inline StretchM stretch_in_cone(const WorldLight& light, const Vec3f& origin,
                                const Vec3f& direction, float end_m) {
  // cos θ · spot_scale + spot_offset is positive inside.
  const float cosine = std::clamp(-light.spot_offset / light.spot_scale, 0.0f, 1.0f);
  const Vec3f from_tip = origin - light.position;
  const float slope = glm::dot(direction, light.direction);
  const float height = glm::dot(from_tip, light.direction);
  const float c2 = cosine * cosine;
  // Inside both cones of the tip where a t² + 2 b t + c ≥ 0; of these the lit one lies ahead.
  const float a = slope * slope - c2;
  const float b = slope * height - c2 * glm::dot(direction, from_tip);
  const float c = height * height - c2 * glm::dot(from_tip, from_tip);
  const float discriminant = b * b - a * c;
  if (discriminant < 0.0f) return a > 0.0f && height > 0.0f ? StretchM{0.0f, end_m} : StretchM{};
  if (a == 0.0f) {
    // Along the surface of the cone: one crossing.
    if (b == 0.0f) return height > 0.0f && c >= 0.0f ? StretchM{0.0f, end_m} : StretchM{};
    const float t = -0.5f * c / b;
    return slope > 0.0f ? StretchM{std::max(0.0f, t), end_m} : StretchM{0.0f, std::min(t, end_m)};
  }
  const float root = std::sqrt(discriminant);
  const float q = b > 0.0f ? -(b + root) : root - b;
  float near = q / a;
  float far = q != 0.0f ? c / q : near;
  if (near > far) std::swap(near, far);
  if (a > 0.0f) {
    return slope > 0.0f ? StretchM{std::max(0.0f, far), end_m}
                        : StretchM{0.0f, std::min(near, end_m)};
  }
  const bool ahead = height + 0.5f * (near + far) * slope > 0.0f;
  return ahead ? StretchM{std::max(0.0f, near), std::min(far, end_m)} : StretchM{};
}

/// Places on rays, and the light that one metre of fog there sends back along them and through the
/// fog before: throughput · albedo · σ/(4π) · exp(−σ t) · weight · piece_share.
template <class D>
HWY_INLINE void FogPlaces(D d, int stride, const WorldFog& fog, const float* albedo_row,
                          float piece_share, const LaneArray3& origins,
                          const LaneArray3& directions, const LaneArray& distance_m,
                          const LaneArray& weight_m, const LaneArray& throughput,
                          LaneArray3& places, LaneArray& scattered) {
  const float share = fog.extinction_per_m * static_cast<float>(0.25 / kPi) * piece_share;
  for (int i = 0; i < stride; i += static_cast<int>(hn::Lanes(d))) {
    const auto t = hn::Load(d, distance_m.v + i);
    Store3(d, Combine3(d, hn::Set(d, 1.0f), Load3(d, origins, i), t, Load3(d, directions, i)),
           places, i);
    const auto through = ExpNegative(d, hn::Mul(hn::Set(d, fog.extinction_per_m), t));
    const auto albedo = hn::Mul(hn::LoadU(d, albedo_row + i), hn::Set(d, share));
    hn::Store(hn::Mul(hn::Mul(hn::Load(d, throughput.v + i), albedo),
                      hn::Mul(through, hn::Load(d, weight_m.v + i))),
              d, scattered.v + i);
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace abbe
HWY_AFTER_NAMESPACE();

#endif  // ABBE_INTEGRATE_FOG_FOG_INL_H_
