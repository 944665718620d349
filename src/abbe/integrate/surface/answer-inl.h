/// Shading for all lanes at once: what a surface does to the lanes of a fan. Highway code, compiled
/// once per instruction set.
///
/// Contract. No fused multiply-add and no reduction across lanes whose order depends on the vector
/// width, so that a result has the same bits on every instruction set level.

#if defined(ABBE_INTEGRATE_SURFACE_ANSWER_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef ABBE_INTEGRATE_SURFACE_ANSWER_INL_H_
#undef ABBE_INTEGRATE_SURFACE_ANSWER_INL_H_
#else
#define ABBE_INTEGRATE_SURFACE_ANSWER_INL_H_
#endif

#include <hwy/highway.h>

#include "abbe/integrate/surface/answer.h"
#include "abbe/math/lanes-inl.h"
#include "abbe/optics/boundary-inl.h"
#include "abbe/optics/snell-inl.h"

HWY_BEFORE_NAMESPACE();
namespace abbe {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

template <class D>
HWY_INLINE VecOf<D> RowOr(D d, const float* row, int i, float otherwise) {
  return row != nullptr ? hn::LoadU(d, row + i) : hn::Set(d, otherwise);
}

/// The geometric normal on the side that light arrives from.
template <class D>
HWY_INLINE Vec3Of<D> FacingNormal(D d, const Vec3Of<D>& direction, const Vec3Of<D>& outward) {
  const auto one = hn::Set(d, 1.0f);
  const auto from_front = hn::Lt(Dot3(d, direction, outward), hn::Zero(d));
  const auto side = hn::IfThenElse(from_front, one, hn::Neg(one));
  return {hn::Mul(side, outward.x), hn::Mul(side, outward.y), hn::Mul(side, outward.z)};
}

/// The film of a boundary in the lanes from i on; `store` holds it. None: null.
template <class D>
HWY_INLINE const FilmLanes<VecOf<D>>* FilmOf(D d, const BoundaryRows& rows, const MaterialLanes& at,
                                             int i, FilmLanes<VecOf<D>>& store) {
  if (rows.film_n == nullptr) return nullptr;
  store = {hn::LoadU(d, rows.film_n + i), hn::Load(d, at.film_thickness_nm.v + i),
           hn::Load(d, at.film_factor.v + i), hn::LoadU(d, rows.inverse_wavelength + i)};
  return &store;
}

/// Fresnel's k_r of the dielectric part of a surface.
template <class D>
HWY_INLINE VecOf<D> DielectricPart(D d, const BoundaryRows& rows, const MaterialLanes& at, int i,
                                   VecOf<D> eta, VecOf<D> cosine, VecOf<D>* cos_transmitted) {
  const auto n_medium = RowOr(d, rows.n_medium, i, 1.0f);
  FilmLanes<VecOf<D>> film;
  return DielectricBoundary(d, FilmOf(d, rows, at, i, film), cosine, eta, n_medium,
                            cos_transmitted);
}

/// Fresnel's k_r of the metallic part.
template <class D>
HWY_INLINE VecOf<D> MetalPart(D d, const BoundaryRows& rows, const MaterialLanes& at, int i,
                              VecOf<D> cosine) {
  const auto n_medium = RowOr(d, rows.n_medium, i, 1.0f);
  FilmLanes<VecOf<D>> store;
  const auto* film = FilmOf(d, rows, at, i, store);
  if (rows.conductor_n == nullptr) {
    return ColoredMetalBoundary(d, film, cosine, hn::Load(d, at.base_color.v + i), n_medium);
  }
  const auto n = hn::Div(hn::LoadU(d, rows.conductor_n + i), n_medium);
  const auto k = hn::Div(hn::LoadU(d, rows.conductor_k + i), n_medium);
  return ConductorBoundary(d, film, cosine, n, k, n_medium);
}

/// The answer of a surface to the lanes that met it: shares of light, and the directions of the
/// coherent rays. `normals` are those that light is reflected and refracted about, on the side of
/// arrival: the hit's own, or a microfacet's.
template <class D>
HWY_INLINE SurfaceAnswer AnswerOf(D d, int stride, const MediumChange& change,
                                  const BoundaryRows& rows, const SurfaceHit& hit,
                                  const LaneArray3& normals, const MaterialLanes& at) {
  const bool hidden = change.crossing == Crossing::Hidden;
  SurfaceAnswer answer;
  Lobe& reflection = answer.lobes[0];
  Lobe& refraction = answer.lobes[1];
  answer.lobe_count = change.crossing == Crossing::None ? 1 : 2;
  reflection.made_by = FanOrigin::Reflected;
  reflection.media = change.before;
  refraction.made_by = FanOrigin::Refracted;
  refraction.media = change.behind;
  const auto one = hn::Set(d, 1.0f);
  const auto zero = hn::Zero(d);
  for (int i = 0; i < stride; i += static_cast<int>(hn::Lanes(d))) {
    const auto direction = Load3(d, hit.direction, i);
    const auto facing = FacingNormal(d, direction, Load3(d, hit.outward, i));
    auto normal = Load3(d, normals, i);
    auto cosine = hn::Neg(Dot3(d, direction, normal));
    // Interpolated normals may turn away from a ray that sees the surface.
    const auto turned_away = hn::Le(cosine, zero);
    normal = Select3(d, turned_away, facing, normal);
    cosine = hn::IfThenElse(turned_away, hn::Neg(Dot3(d, direction, facing)), cosine);
    cosine = hn::Min(hn::Max(cosine, zero), one);

    const auto n_medium = RowOr(d, rows.n_medium, i, 1.0f);
    const auto eta =
        hn::Div(RowOr(d, rows.n_transmitted, i, 1.0f), RowOr(d, rows.n_incident, i, 1.0f));
    auto cos_transmitted = one;
    auto dielectric = DielectricPart(d, rows, at, i, eta, cosine, &cos_transmitted);
    if (rows.index_is_infinite) dielectric = one;
    const auto base_color = hn::Load(d, at.base_color.v + i);
    const auto metallic = hn::Load(d, at.metallic.v + i);
    const auto transmission = hn::Load(d, at.transmission.v + i);
    const auto metal = MetalPart(d, rows, at, i, cosine);
    const auto dielectric_part = hn::Sub(one, metallic);
    const auto refracted_share =
        hn::Mul(hn::Mul(dielectric_part, hn::Sub(one, dielectric)), base_color);
    auto k_r = hn::Add(hn::Mul(dielectric_part, dielectric), hn::Mul(metallic, metal));
    auto k_t = hn::Mul(refracted_share, transmission);
    auto diffuse = hn::Mul(refracted_share, hn::Sub(one, transmission));

    // Reflection about the shading normal, unless that would lead into the surface.
    auto reflected = ReflectedDirection(d, direction, normal, cosine);
    const auto cos_facing = hn::Neg(Dot3(d, direction, facing));
    reflected = Select3(d, hn::Gt(Dot3(d, reflected, facing), zero), reflected,
                        ReflectedDirection(d, direction, facing, cos_facing));
    reflected = Normalized3(d, reflected);

    auto refracted =
        RefractedDirection(d, direction, normal, cosine, cos_transmitted, hn::Div(one, eta));
    const auto stays_outside = hn::Ge(Dot3(d, refracted, facing), zero);
    refracted = Select3(d, stays_outside, direction, refracted);
    refracted = Normalized3(d, refracted);

    if (hidden) {
      k_r = zero;
      k_t = one;
      diffuse = zero;
    }
    if (change.goes_straight()) refracted = direction;
    hn::Store(cosine, d, answer.cos_incident.v + i);
    hn::Store(eta, d, answer.eta_ti.v + i);
    hn::Store(diffuse, d, answer.diffuse.v + i);
    hn::Store(hn::Div(one, hn::Mul(n_medium, n_medium)), d, answer.inverse_n2.v + i);
    hn::Store(k_r, d, reflection.share.v + i);
    hn::Store(k_t, d, refraction.share.v + i);
    Store3(d, reflected, reflection.direction, i);
    Store3(d, refracted, refraction.direction, i);
  }
  // Where there is one index for all lanes, they go on together.
  const float eta = answer.eta_ti[hit.lanes.front()];
  refraction.spreads =
      !change.goes_straight() && LanesWith(d, stride, answer.eta_ti.v, eta, hit.lanes) != hit.lanes;
  return answer;
}

}  // namespace HWY_NAMESPACE
}  // namespace abbe
HWY_AFTER_NAMESPACE();

#endif  // ABBE_INTEGRATE_SURFACE_ANSWER_INL_H_
