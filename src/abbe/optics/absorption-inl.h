/// Beer and Lambert's law for all lanes at once. Highway code, compiled once per instruction set.

#if defined(ABBE_OPTICS_ABSORPTION_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef ABBE_OPTICS_ABSORPTION_INL_H_
#undef ABBE_OPTICS_ABSORPTION_INL_H_
#else
#define ABBE_OPTICS_ABSORPTION_INL_H_
#endif

#include "abbe/math/lanes-inl.h"
#include "abbe/optics/fresnel-inl.h"

HWY_BEFORE_NAMESPACE();
namespace abbe {
namespace HWY_NAMESPACE {

/// What is left of light after a distance: light · exp(−per_m · distance).
/// Domain: per_m and distance_m >= 0.
template <class D>
HWY_INLINE VecOf<D> Attenuated(D d, VecOf<D> light, VecOf<D> per_m, VecOf<D> distance_m) {
  return hn::Mul(light, ExpNegative(d, hn::Mul(per_m, distance_m)));
}

/// The same of light in all lanes; `per_m` is one absorption for all, or a row of them.
template <class D>
HWY_INLINE void Attenuate(D d, int stride, float per_m, const LaneArray& distance_m,
                          LaneArray& light) {
  for (int i = 0; i < stride; i += static_cast<int>(hn::Lanes(d))) {
    const auto distance = hn::Load(d, distance_m.v + i);
    hn::Store(Attenuated(d, hn::Load(d, light.v + i), hn::Set(d, per_m), distance), d, light.v + i);
  }
}
template <class D>
HWY_INLINE void Attenuate(D d, int stride, const float* per_m, const LaneArray& distance_m,
                          LaneArray& light) {
  for (int i = 0; i < stride; i += static_cast<int>(hn::Lanes(d))) {
    const auto distance = hn::Load(d, distance_m.v + i);
    hn::Store(Attenuated(d, hn::Load(d, light.v + i), hn::LoadU(d, per_m + i), distance), d,
              light.v + i);
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace abbe
HWY_AFTER_NAMESPACE();

#endif  // ABBE_OPTICS_ABSORPTION_INL_H_
