/// Reflectance of a boundary under one thin layer, for all lanes at once: Highway code, compiled
/// once per instruction set.
///
/// Contract. No fused multiply-add: a result has the same bits on every instruction set level. The
/// absolute error against optics/thin_film.h is below 1e-5 for layers of up to ten wavelengths;
/// beyond, it grows with the thickness, as the phase does. Every result lies in [0, 1].

#if defined(ABBE_OPTICS_THIN_FILM_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef ABBE_OPTICS_THIN_FILM_INL_H_
#undef ABBE_OPTICS_THIN_FILM_INL_H_
#else
#define ABBE_OPTICS_THIN_FILM_INL_H_
#endif

#include <hwy/highway.h>

#include "abbe/optics/fresnel-inl.h"

HWY_BEFORE_NAMESPACE();
namespace abbe {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

/// What a wave meets between the faces of a layer: cos β and sin(β)/q, where q is the index of the
/// layer times the cosine in it and β = 2π·waves·q. Both are real also where q² < 0; there both
/// are divided by exp|β|, which cancels in every ratio of amplitudes.
template <class V>
struct LayerPhase {
  V cosine, sine_over_q;
};

/// Domain: waves in [0, 1e6]; q_squared finite.
template <class D, class V>
HWY_INLINE LayerPhase<V> PhaseOfLayer(D d, V q_squared, V waves) {
  constexpr float kTwoPi = 6.28318530717958648f;
  constexpr float kHalfPi = 1.57079632679489662f;
  const auto set = [d](float x) { return hn::Set(d, x); };
  const V one = set(1.0f);
  const V zero = hn::Zero(d);
  const V q = hn::Sqrt(hn::Abs(q_squared));
  const V turns = hn::Mul(waves, q);
  const V two_pi_waves = hn::Mul(set(kTwoPi), waves);

  // Quarter turns: the nearest whole number of them is taken off without rounding.
  const V quarters = hn::Mul(set(4.0f), turns);
  const V whole = hn::Round(quarters);
  const V y = hn::Mul(set(kHalfPi), hn::Sub(quarters, whole));
  const V y2 = hn::Mul(y, y);
  // Taylor's series for |y| <= π/4: the first terms left out are below 2e-9.
  V sinc = set(1.0f / 362880.0f);
  sinc = hn::Add(hn::Mul(sinc, y2), set(-1.0f / 5040.0f));
  sinc = hn::Add(hn::Mul(sinc, y2), set(1.0f / 120.0f));
  sinc = hn::Add(hn::Mul(sinc, y2), set(-1.0f / 6.0f));
  sinc = hn::Add(hn::Mul(sinc, y2), one);
  V cosine = set(-1.0f / 3628800.0f);
  cosine = hn::Add(hn::Mul(cosine, y2), set(1.0f / 40320.0f));
  cosine = hn::Add(hn::Mul(cosine, y2), set(-1.0f / 720.0f));
  cosine = hn::Add(hn::Mul(cosine, y2), set(1.0f / 24.0f));
  cosine = hn::Add(hn::Mul(cosine, y2), set(-0.5f));
  cosine = hn::Add(hn::Mul(cosine, y2), one);
  const V sine = hn::Mul(y, sinc);
  // whole mod 4, in floating point.
  const V quadrant = hn::Sub(whole, hn::Mul(set(4.0f), hn::Floor(hn::Mul(set(0.25f), whole))));
  const auto is_odd = hn::Or(hn::Eq(quadrant, one), hn::Eq(quadrant, set(3.0f)));
  const V first = hn::IfThenElse(is_odd, sine, cosine);
  const V second = hn::IfThenElse(is_odd, cosine, sine);
  const auto cosine_is_negative = hn::Or(hn::Eq(quadrant, one), hn::Eq(quadrant, set(2.0f)));
  const auto sine_is_negative = hn::Ge(quadrant, set(2.0f));
  LayerPhase<V> phase;
  phase.cosine = hn::IfThenElse(cosine_is_negative, hn::Neg(first), first);
  const V signed_sine = hn::IfThenElse(sine_is_negative, hn::Neg(second), second);
  // In the first quarter sin(β)/q is taken from the series, which has a value also at q = 0.
  phase.sine_over_q = hn::IfThenElse(hn::Eq(whole, zero), hn::Mul(two_pi_waves, sinc),
                                     hn::Div(signed_sine, hn::Max(q, set(1e-20f))));

  const auto is_evanescent = hn::Lt(q_squared, zero);
  if (hn::AllFalse(d, is_evanescent)) return phase;
  const V x = hn::Mul(set(kTwoPi), turns);
  const V decay = ExpNegative(d, x);
  const V decay_squared = hn::Mul(decay, decay);
  const V half = set(0.5f);
  const V x2 = hn::Mul(x, x);
  V sinhc = set(1.0f / 5040.0f);
  sinhc = hn::Add(hn::Mul(sinhc, x2), set(1.0f / 120.0f));
  sinhc = hn::Add(hn::Mul(sinhc, x2), set(1.0f / 6.0f));
  sinhc = hn::Add(hn::Mul(sinhc, x2), one);
  const V near = hn::Mul(hn::Mul(two_pi_waves, sinhc), decay);
  const V far = hn::Div(hn::Mul(half, hn::Sub(one, decay_squared)), hn::Max(q, set(1e-20f)));
  phase.cosine =
      hn::IfThenElse(is_evanescent, hn::Mul(half, hn::Add(one, decay_squared)), phase.cosine);
  phase.sine_over_q =
      hn::IfThenElse(is_evanescent, hn::IfThenElse(hn::Lt(x, half), near, far), phase.sine_over_q);
  return phase;
}

/// A complex number per lane.
template <class V>
struct ComplexLanes {
  V re, im;
};

/// The characteristic matrix of a layer, [[cos β, −i·quotient], [−i·product, cos β]], for one
/// polarisation: `product` is its admittance times sin β, `quotient` sin β over that admittance.
/// The admittance of a medium is u/v.
template <class V>
struct LayerMatrix {
  V cosine, quotient, product;
};

/// |r|² of one polarisation: the fields at the front of the layer follow from those at its back by
/// its matrix; with (B, C) = matrix·(v3, u3) the amplitude is r = (u1·B − v1·C)/(u1·B + v1·C). It
/// is Airy's sum with the denominators multiplied out, so that it has no gap where a wave runs
/// along the layer or along the boundary. Source: Born & Wolf, 1.6.2 and 1.6.4.
template <class D, class V>
HWY_INLINE V LayerReflectance(D d, V u1, V v1, const ComplexLanes<V>& u3, const ComplexLanes<V>& v3,
                              const LayerMatrix<V>& layer) {
  const V b_re = hn::Mul(u1, hn::Add(hn::Mul(layer.cosine, v3.re), hn::Mul(layer.quotient, u3.im)));
  const V b_im = hn::Mul(u1, hn::Sub(hn::Mul(layer.cosine, v3.im), hn::Mul(layer.quotient, u3.re)));
  const V c_re = hn::Mul(v1, hn::Add(hn::Mul(layer.cosine, u3.re), hn::Mul(layer.product, v3.im)));
  const V c_im = hn::Mul(v1, hn::Sub(hn::Mul(layer.cosine, u3.im), hn::Mul(layer.product, v3.re)));
  const auto squared = [](V x, V y) { return hn::Add(hn::Mul(x, x), hn::Mul(y, y)); };
  const V difference = squared(hn::Sub(b_re, c_re), hn::Sub(b_im, c_im));
  const V sum = squared(hn::Add(b_re, c_re), hn::Add(b_im, c_im));
  return hn::Div(difference, hn::Max(sum, hn::Set(d, 1e-30f)));
}

/// Fraction of unpolarised light reflected at a boundary with one lossless layer on it; see
/// thin_film_reflectance().
/// Units:  all indices over that of the medium of incidence; waves is the thickness of the layer in
///         wavelengths of that medium.
/// Domain: cos_incident in [0, 1]; film and n in [1e-3, 1e3], k in [0, 1e3], waves in [0, 1e6].
///         k = 0 is a dielectric; exactly 1 at total internal reflection.
template <class D, class V>
HWY_INLINE V ThinFilmReflectance(D d, V cos_incident, V film_over_incident, V n_over_incident,
                                 V k_over_incident, V waves) {
  const V one = hn::Set(d, 1.0f);
  const V zero = hn::Zero(d);
  const V half = hn::Set(d, 0.5f);
  const V cos_squared = hn::Mul(cos_incident, cos_incident);
  const auto squared_minus_1 = [one](V n) { return hn::Mul(hn::Sub(n, one), hn::Add(n, one)); };

  const V film_squared = hn::Mul(film_over_incident, film_over_incident);
  const V q2_squared = hn::Add(squared_minus_1(film_over_incident), cos_squared);
  const LayerPhase<V> phase = PhaseOfLayer(d, q2_squared, waves);

  // q3² = (n + ik)² − sin². Whichever part of its root does not cancel is taken from the modulus.
  const V nk = hn::Mul(n_over_incident, k_over_incident);
  const V k_squared = hn::Mul(k_over_incident, k_over_incident);
  const V re = hn::Add(squared_minus_1(n_over_incident), hn::Sub(cos_squared, k_squared));
  const V modulus = hn::Sqrt(hn::Add(hn::Mul(re, re), hn::Mul(hn::Set(d, 4.0f), hn::Mul(nk, nk))));
  const V larger = hn::Sqrt(hn::Mul(half, hn::Add(modulus, hn::Abs(re))));
  const V smaller = hn::Div(nk, hn::Max(larger, hn::Set(d, 1e-30f)));
  const auto is_positive = hn::Ge(re, zero);
  const ComplexLanes<V> q3{hn::IfThenElse(is_positive, larger, smaller),
                           hn::IfThenElse(is_positive, smaller, larger)};
  const ComplexLanes<V> e3{hn::Sub(hn::Mul(n_over_incident, n_over_incident), k_squared),
                           hn::Add(nk, nk)};

  const V q2_sine = hn::Mul(q2_squared, phase.sine_over_q);
  const V s = LayerReflectance(d, cos_incident, one, q3, {one, zero},
                               LayerMatrix<V>{phase.cosine, phase.sine_over_q, q2_sine});
  const V p = LayerReflectance(d, one, cos_incident, e3, q3,
                               LayerMatrix<V>{phase.cosine, hn::Div(q2_sine, film_squared),
                                              hn::Mul(film_squared, phase.sine_over_q)});
  return hn::Min(hn::Mul(half, hn::Add(s, p)), one);
}

}  // namespace HWY_NAMESPACE
}  // namespace abbe
HWY_AFTER_NAMESPACE();

#endif  // ABBE_OPTICS_THIN_FILM_INL_H_
