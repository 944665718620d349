/// GGX microfacets for all lanes at once: how their normals are spread, and what they hide from
/// each other by Smith's rule. Highway code, compiled once per instruction set.
///
/// Contract. No fused multiply-add: the same bits on every instruction set level. Cosines are those
/// with the normal of the surface, alpha is roughness².
/// Source: Walter, Marschner, Li & Torrance, Microfacet Models for Refraction through Rough
///         Surfaces, EGSR 2007; Heitz, Understanding the Masking-Shadowing Function, JCGT 3(2),
///         2014.

#if defined(ABBE_OPTICS_MICROFACET_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef ABBE_OPTICS_MICROFACET_INL_H_
#undef ABBE_OPTICS_MICROFACET_INL_H_
#else
#define ABBE_OPTICS_MICROFACET_INL_H_
#endif

#include <hwy/highway.h>

#include "abbe/base/constants.h"

HWY_BEFORE_NAMESPACE();
namespace abbe {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

/// How microfacet normals are spread: D, in sr⁻¹. Of the sine, not the cosine, which loses narrow
/// lobes to rounding.
/// Domain: sin2_half = sin² of the angle of the microfacet in [0, 1], alpha2 = alpha² > 0.
template <class D, class V>
HWY_INLINE V GgxDistribution(D d, V sin2_half, V alpha2) {
  const V bracket = hn::Add(alpha2, hn::Mul(sin2_half, hn::Sub(hn::Set(d, 1.0f), alpha2)));
  return hn::Div(hn::Mul(alpha2, hn::Set(d, static_cast<float>(1.0 / kPi))),
                 hn::Mul(bracket, bracket));
}

/// √(cos²(1 − α²) + α²) = cos·(1 + 2Λ), of Smith's Λ.
/// Domain: cosine in [0, 1].
template <class D, class V>
HWY_INLINE V SmithRoot(D d, V cosine, V alpha2) {
  const V one = hn::Set(d, 1.0f);
  return hn::Sqrt(hn::Add(hn::Mul(hn::Mul(cosine, cosine), hn::Sub(one, alpha2)), alpha2));
}

/// The same of microfacets that are rougher along one direction: of a direction's parts along both,
/// times the roughness along them.
template <class D, class V>
HWY_INLINE V SmithRootAcross(D, V cosine, V rough_t, V rough_b) {
  return hn::Sqrt(hn::Add(hn::Mul(cosine, cosine),
                          hn::Add(hn::Mul(rough_t, rough_t), hn::Mul(rough_b, rough_b))));
}

/// D of such microfacets. Domain: parts of the half vector along both directions over the roughness
/// along them, its cosine; alpha2 the product of both.
template <class D, class V>
HWY_INLINE V GgxDistributionAcross(D d, V steep_t, V steep_b, V cos_half, V alpha2) {
  const V bracket = hn::Add(hn::Mul(cos_half, cos_half),
                            hn::Add(hn::Mul(steep_t, steep_t), hn::Mul(steep_b, steep_b)));
  return hn::Div(hn::Set(d, static_cast<float>(1.0 / kPi)),
                 hn::Mul(alpha2, hn::Mul(bracket, bracket)));
}

/// G2/(4 cos_view cos_light) of reflection: the share of microfacets that both sides see, with
/// heights that correlate. The lobe is F·D times this. `root_view` and `root_light` are Smith's.
/// Domain: cosines in (0, 1].
template <class D, class V>
HWY_INLINE V SmithVisibility(D d, V cos_view, V root_view, V cos_light, V root_light) {
  return hn::Div(hn::Set(d, 0.5f),
                 hn::Add(hn::Mul(cos_light, root_view), hn::Mul(cos_view, root_light)));
}

/// G2/G1(view): of light that visible microfacets reflect, the share that gets out.
/// Domain: cos_view in (0, 1], cos_out <= 1; exactly 0 for cos_out <= 0: below the surface;
///         root_out that of a cosine of at least 0.
template <class D, class V>
HWY_INLINE V SmithReflectedShare(D d, V cos_view, V root_view, V cos_out, V root_out) {
  const V out = hn::Max(cos_out, hn::Zero(d));
  return hn::Div(hn::Mul(out, hn::Add(cos_view, root_view)),
                 hn::Add(hn::Mul(out, root_view), hn::Mul(cos_view, root_out)));
}

/// G1(out): of light that visible microfacets refract, the share that gets out on the other side,
/// where heights are independent.
/// Domain: cos_out <= 1, with the normal of the other side; exactly 0 for cos_out <= 0.
template <class D, class V>
HWY_INLINE V SmithRefractedShare(D d, V cos_out, V root_out) {
  const V out = hn::Max(cos_out, hn::Zero(d));
  return hn::Div(hn::Add(out, out), hn::Add(out, root_out));
}

}  // namespace HWY_NAMESPACE
}  // namespace abbe
HWY_AFTER_NAMESPACE();

#endif  // ABBE_OPTICS_MICROFACET_INL_H_
