/// Directions behind a boundary, for all lanes at once. Highway code, compiled once per instruction
/// set.
///
/// Contract. No fused multiply-add: the same bits on every instruction set level. The directions
/// are those of optics/snell.h but for roundings.

#if defined(ABBE_OPTICS_SNELL_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef ABBE_OPTICS_SNELL_INL_H_
#undef ABBE_OPTICS_SNELL_INL_H_
#else
#define ABBE_OPTICS_SNELL_INL_H_
#endif

#include <hwy/highway.h>

#include "abbe/math/lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace abbe {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

/// Mirror direction about a normal that faces the ray, not normalised.
/// Domain: unit vectors, cos_incident = −direction·normal.
template <class D>
HWY_INLINE Vec3Of<D> ReflectedDirection(D d, const Vec3Of<D>& direction, const Vec3Of<D>& normal,
                                        VecOf<D> cos_incident) {
  return Combine3(d, hn::Set(d, 1.0f), direction, hn::Add(cos_incident, cos_incident), normal);
}

/// Snell's law: t = eta·d + (eta·cos_i − cos_t)·n, not normalised.
/// Units:  eta = n_incident / n_transmitted.
/// Domain: unit vectors, the normal faces the ray; cosines in [0, 1], cos_transmitted that behind
///         the boundary. Without a meaning at total internal reflection.
/// Source: Born & Wolf, Principles of Optics, 7th ed., 1.5.1.
template <class D>
HWY_INLINE Vec3Of<D> RefractedDirection(D d, const Vec3Of<D>& direction, const Vec3Of<D>& normal,
                                        VecOf<D> cos_incident, VecOf<D> cos_transmitted,
                                        VecOf<D> eta_it) {
  return Combine3(d, eta_it, direction, hn::Sub(hn::Mul(eta_it, cos_incident), cos_transmitted),
                  normal);
}

}  // namespace HWY_NAMESPACE
}  // namespace abbe
HWY_AFTER_NAMESPACE();

#endif  // ABBE_OPTICS_SNELL_INL_H_
