/// Fog for all lanes at once. Highway code, compiled once per instruction set.

#if defined(ABBE_INTEGRATE_FOG_FOG_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef ABBE_INTEGRATE_FOG_FOG_INL_H_
#undef ABBE_INTEGRATE_FOG_FOG_INL_H_
#else
#define ABBE_INTEGRATE_FOG_FOG_INL_H_
#endif

#include "abbe/base/constants.h"
#include "abbe/math/lanes-inl.h"
#include "abbe/optics/fresnel-inl.h"
#include "abbe/world/world.h"

HWY_BEFORE_NAMESPACE();
namespace abbe {
namespace HWY_NAMESPACE {

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
