/// Places on the planes of chains, for all lanes at once. Highway code, compiled once per
/// instruction set.

#if defined(ABBE_CAUSTICS_FLAT_LIGHT_ON_PLANE_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef ABBE_CAUSTICS_FLAT_LIGHT_ON_PLANE_INL_H_
#undef ABBE_CAUSTICS_FLAT_LIGHT_ON_PLANE_INL_H_
#else
#define ABBE_CAUSTICS_FLAT_LIGHT_ON_PLANE_INL_H_
#endif

#include "abbe/caustics/flat/chain.h"
#include "abbe/math/lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace abbe {
namespace HWY_NAMESPACE {

/// A place moved across the plane of a step onto it: what a long way has rounded is undone but for
/// what lies along the plane. Places are relative to the chain's origin.
template <class D>
HWY_INLINE Vec3Of<D> OnPlane(D d, const ChainStep& step, const Vec3Of<D>& place) {
  const Vec3Of<D> normal = Set3(d, step.normal);
  const auto height = hn::Sub(Dot3(d, normal, place), hn::Set(d, step.distance_m));
  return Combine3(d, hn::Set(d, 1.0f), place, hn::Neg(height), normal);
}

}  // namespace HWY_NAMESPACE
}  // namespace abbe
HWY_AFTER_NAMESPACE();

#endif  // ABBE_CAUSTICS_FLAT_LIGHT_ON_PLANE_INL_H_
