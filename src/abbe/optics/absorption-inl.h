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

/// Multiplies light by what a medium of the same absorption in all lanes lets through.
template <class D>
HWY_INLINE void Attenuate(D d, int stride, float per_m, const LaneArray& distance_m,
                          LaneArray& light) {
  for (int i = 0; i < stride; i += static_cast<int>(hn::Lanes(d))) {
    const auto depth = hn::Mul(hn::Set(d, per_m), hn::Load(d, distance_m.v + i));
    hn::Store(hn::Mul(hn::Load(d, light.v + i), ExpNegative(d, depth)), d, light.v + i);
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace abbe
HWY_AFTER_NAMESPACE();

#endif  // ABBE_OPTICS_ABSORPTION_INL_H_
