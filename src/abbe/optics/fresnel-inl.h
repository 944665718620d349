/// Fresnel reflectances, smooth reflectances and exponentials for all lanes at once: Highway code,
/// compiled once per instruction set.
///
/// Contract. Nothing here uses a fused multiply-add, so that a result has the same bits on every
/// instruction set level. Unless a function says otherwise, the relative error against the closed
/// forms of optics/fresnel.h is below 2e-6 where the result exceeds 1e-3, and the absolute error
/// below 2e-7 elsewhere; every result lies in [0, 1].

#if defined(ABBE_OPTICS_FRESNEL_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef ABBE_OPTICS_FRESNEL_INL_H_
#undef ABBE_OPTICS_FRESNEL_INL_H_
#else
#define ABBE_OPTICS_FRESNEL_INL_H_
#endif

#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace abbe {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

/// Fraction of unpolarised light reflected at a smooth dielectric boundary, and the cosine of the
/// refracted ray.
/// Units:  eta_ti = n_transmitted / n_incident.
/// Domain: cos_incident in [0, 1], eta_ti in [1e-3, 1e3]; at total internal reflection exactly 1,
///         and *cos_transmitted exactly 0. Exactly 0 where eta_ti is 1 (but at cos_incident 0).
/// Source: Born & Wolf, Principles of Optics, 7th ed., 1.5.2.
template <class D, class V>
HWY_INLINE V DielectricReflectance(D d, V cos_incident, V eta_ti, V* cos_transmitted) {
  const V one = hn::Set(d, 1.0f);
  const V zero = hn::Zero(d);
  // g = eta·cos_t. Written with (eta − 1)(eta + 1), equal indices give g = cos_i to the last bit.
  const V eta_squared_minus_1 = hn::Mul(hn::Sub(eta_ti, one), hn::Add(eta_ti, one));
  const V g_squared = hn::Add(eta_squared_minus_1, hn::Mul(cos_incident, cos_incident));
  const auto is_refracted = hn::Gt(g_squared, zero);
  const V g = hn::Sqrt(hn::Max(g_squared, zero));
  *cos_transmitted = hn::Min(hn::Div(g, eta_ti), one);

  const V s_ratio = hn::Div(hn::Sub(cos_incident, g), hn::Add(cos_incident, g));
  const V p_cosine = hn::Mul(hn::Mul(eta_ti, eta_ti), cos_incident);
  const V p_ratio = hn::Div(hn::Sub(p_cosine, g), hn::Add(p_cosine, g));
  const V both = hn::Add(hn::Mul(s_ratio, s_ratio), hn::Mul(p_ratio, p_ratio));
  return hn::IfThenElse(is_refracted, hn::Mul(both, hn::Set(d, 0.5f)), one);
}

/// Fraction of unpolarised light reflected at a smooth conductor.
/// Units:  n and k of the conductor over the index of the medium of incidence.
/// Domain: cos_incident in [0, 1], n_over_incident > 0, k_over_incident >= 0, both below 1e4.
/// Source: Born & Wolf, Principles of Optics, 7th ed., 14.2.
template <class D, class V>
HWY_INLINE V ConductorReflectance(D d, V cos_incident, V n_over_incident, V k_over_incident) {
  const V one = hn::Set(d, 1.0f);
  const V zero = hn::Zero(d);
  const V half = hn::Set(d, 0.5f);
  const V tiny = hn::Set(d, 1e-30f);
  const V cos_squared = hn::Mul(cos_incident, cos_incident);
  const V sin_squared = hn::Max(hn::Sub(one, cos_squared), zero);

  // (a + ib)² = (n + ik)² − sin²: real part `re`, modulus `modulus`, and ab = nk.
  const V nk = hn::Mul(n_over_incident, k_over_incident);
  const V re = hn::Sub(
      hn::Mul(hn::Sub(n_over_incident, k_over_incident), hn::Add(n_over_incident, k_over_incident)),
      sin_squared);
  const V modulus = hn::Sqrt(hn::Add(hn::Mul(re, re), hn::Mul(hn::Set(d, 4.0f), hn::Mul(nk, nk))));
  // a² = (modulus + re)/2 cancels where k exceeds n, as in silver; there b² does not, and a = nk/b.
  const V larger_squared = hn::Mul(half, hn::Add(modulus, hn::Abs(re)));
  const V larger = hn::Sqrt(larger_squared);
  const V smaller = hn::Div(nk, hn::Max(larger, tiny));
  const V a = hn::IfThenElse(hn::Ge(re, zero), larger, smaller);

  const V sum_s = hn::Add(modulus, cos_squared);
  const V twice_s = hn::Mul(hn::Add(cos_incident, cos_incident), a);
  const V reflectance_s =
      hn::Div(hn::Max(hn::Sub(sum_s, twice_s), zero), hn::Max(hn::Add(sum_s, twice_s), tiny));
  const V sum_p = hn::Add(hn::Mul(cos_squared, modulus), hn::Mul(sin_squared, sin_squared));
  const V twice_p = hn::Mul(twice_s, sin_squared);
  const V ratio_p =
      hn::Div(hn::Max(hn::Sub(sum_p, twice_p), zero), hn::Max(hn::Add(sum_p, twice_p), tiny));
  return hn::Min(hn::Mul(hn::Mul(half, reflectance_s), hn::Add(one, ratio_p)), one);
}

/// Schlick's approximation: f0 + (f90 − f0)(1 − cos)⁵.
/// Domain: cos in [0, 1], f0 and f90 in [0, 1].
/// Source: Schlick, CGF 13(3), 1994.
template <class D, class V>
HWY_INLINE V SchlickReflectance(D d, V f0, V f90, V cosine) {
  const V m = hn::Max(hn::Sub(hn::Set(d, 1.0f), cosine), hn::Zero(d));
  const V m2 = hn::Mul(m, m);
  const V m5 = hn::Mul(hn::Mul(m2, m2), m);
  return hn::Add(f0, hn::Mul(hn::Sub(f90, f0), m5));
}

/// Jakob and Hanika's smooth reflectance ½ + x/(2√(1 + x²)), x = (c0·s + c1)·s + c2.
/// Units:  s = (λ − 595 nm)/235 nm, as in color/uplift.h.
/// Domain: |x| < 1e18; from |x| = 4096 on exactly 0 or 1. Absolute error below 2e-7 for |x| < 1e3.
template <class D, class V>
HWY_INLINE V SigmoidValue(D d, V c0, V c1, V c2, V s) {
  const V half = hn::Set(d, 0.5f);
  const V x = hn::Add(hn::Mul(hn::Add(hn::Mul(c0, s), c1), s), c2);
  const V root = hn::Sqrt(hn::Add(hn::Set(d, 1.0f), hn::Mul(x, x)));
  return hn::Add(half, hn::Mul(half, hn::Div(x, root)));
}

/// exp(−x).
/// Domain: x >= 0, infinity included. Relative error below 1e-6; exactly 1 at 0, exactly 0 from
///         x = 87 on, where single precision runs out of normal numbers.
template <class D, class V>
HWY_INLINE V ExpNegative(D d, V x) {
  const hn::RebindToSigned<D> di;
  const V limit = hn::Set(d, 87.0f);
  const V bounded = hn::Min(x, limit);
  // exp(−x) = 2^−n · exp(t), with n the nearest integer to x/ln 2. ln 2 is taken in two parts, of
  // which the first has so few bits that its product with n is exact.
  const V n = hn::Round(hn::Mul(bounded, hn::Set(d, 1.44269504088896341f)));
  const V t = hn::Add(hn::Sub(hn::Mul(n, hn::Set(d, 0.693359375f)), bounded),
                      hn::Mul(n, hn::Set(d, -2.12194440054690583e-4f)));
  // Taylor's series: |t| <= 0.347, so that the first term left out is below 6e-9.
  V series = hn::Set(d, 1.0f / 5040.0f);
  series = hn::Add(hn::Mul(series, t), hn::Set(d, 1.0f / 720.0f));
  series = hn::Add(hn::Mul(series, t), hn::Set(d, 1.0f / 120.0f));
  series = hn::Add(hn::Mul(series, t), hn::Set(d, 1.0f / 24.0f));
  series = hn::Add(hn::Mul(series, t), hn::Set(d, 1.0f / 6.0f));
  series = hn::Add(hn::Mul(series, t), hn::Set(d, 0.5f));
  series = hn::Add(hn::Mul(series, t), hn::Set(d, 1.0f));
  series = hn::Add(hn::Mul(series, t), hn::Set(d, 1.0f));
  const auto exponent = hn::Sub(hn::Set(di, 127), hn::ConvertTo(di, n));
  const V power = hn::BitCast(d, hn::ShiftLeft<23>(exponent));
  return hn::IfThenElseZero(hn::Lt(x, limit), hn::Mul(series, power));
}

}  // namespace HWY_NAMESPACE
}  // namespace abbe
HWY_AFTER_NAMESPACE();

#endif  // ABBE_OPTICS_FRESNEL_INL_H_
