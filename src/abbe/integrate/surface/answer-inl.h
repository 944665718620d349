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
#include "abbe/optics/microfacet-inl.h"
#include "abbe/optics/snell-inl.h"

HWY_BEFORE_NAMESPACE();
namespace abbe {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

/// Rough surfaces seen at a lower cosine are seen at this one.
inline constexpr float kLeastCosine = 1e-4f;

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

/// What a dielectric reflects in a lane, and what it leaves out for the lane's part of what is
/// behind.
template <class D>
struct DielectricShares {
  VecOf<D> reflected, taken;
};

/// KHR_materials_specular of a dielectric's reflectance: at normal incidence what colour and factor
/// make of it, at grazing the factor. What is behind loses what the strongest channel reflects, so
/// that it keeps its hue. Total reflection is as it is: light has nowhere else to go. The same to
/// the last bits where both are 1. An infinite index, whose reflectance has no angles, goes by
/// Schlick's rule.
/// Units: eta = n_transmitted / n_incident.
template <class D>
HWY_INLINE DielectricShares<D> WithSpecular(D d, const BoundaryRows& rows, const LayerLanes& layers,
                                            int i, VecOf<D> eta, VecOf<D> cosine,
                                            VecOf<D> reflected, VecOf<D> cos_transmitted) {
  const auto one = hn::Set(d, 1.0f);
  const auto zero = hn::Zero(d);
  auto f0 = one;
  auto grazing = SchlickReflectance(d, zero, one, cosine);
  if (!rows.index_is_infinite) {
    const auto root = hn::Div(hn::Sub(eta, one), hn::Add(eta, one));
    f0 = hn::Mul(root, root);
    grazing = hn::Div(hn::Sub(reflected, f0), hn::Max(hn::Sub(one, f0), hn::Set(d, 1e-6f)));
  }
  const auto factor = hn::Load(d, layers.specular.v + i);
  const auto of = [&](const LaneArray& color) {
    const auto colored = hn::Min(hn::Mul(f0, hn::Load(d, color.v + i)), one);
    const auto mixed = hn::Add(colored, hn::Mul(hn::Sub(one, colored), grazing));
    const auto part = hn::Mul(factor, hn::Min(hn::Max(mixed, zero), one));
    return hn::IfThenElse(hn::Gt(cos_transmitted, zero), part, reflected);
  };
  return {of(layers.specular_color), of(layers.specular_most)};
}

/// Light that arrives at a surface in some lanes, and the normals on its side.
template <class D>
struct Arrival {
  Vec3Of<D> direction;
  Vec3Of<D> facing;   ///< The geometric normal.
  Vec3Of<D> shading;  ///< What light is reflected and refracted about.
};

template <class D>
HWY_INLINE Arrival<D> ArrivalAt(D d, const SurfaceHit& hit, int i) {
  const auto direction = Load3(d, hit.direction, i);
  const auto facing = FacingNormal(d, direction, Load3(d, hit.outward, i));
  const auto normal = Load3(d, hit.normal, i);
  // Interpolated normals may turn away from a ray that sees the surface.
  const auto turned_away = hn::Ge(Dot3(d, direction, normal), hn::Zero(d));
  return {direction, facing, Select3(d, turned_away, facing, normal)};
}

/// Shares of power at a boundary that light meets at some angle.
template <class D>
struct BoundaryShares {
  VecOf<D> reflected, refracted, diffuse;
  VecOf<D> through;  ///< Diffusely, to the other side.
  VecOf<D> cos_transmitted;
};

template <class D>
HWY_INLINE BoundaryShares<D> SharesAt(D d, const BoundaryRows& rows, const MaterialLanes& at, int i,
                                      VecOf<D> eta, VecOf<D> cosine) {
  const auto one = hn::Set(d, 1.0f);
  BoundaryShares<D> shares;
  shares.cos_transmitted = one;
  auto dielectric = DielectricPart(d, rows, at, i, eta, cosine, &shares.cos_transmitted);
  if (rows.index_is_infinite) dielectric = one;
  auto taken = dielectric;
  if (at.layers != nullptr && at.layers->has_specular) {
    const auto both =
        WithSpecular(d, rows, *at.layers, i, eta, cosine, dielectric, shares.cos_transmitted);
    dielectric = both.reflected;
    taken = both.taken;
  }
  const auto metallic = hn::Load(d, at.metallic.v + i);
  const auto transmission = hn::Load(d, at.transmission.v + i);
  const auto metal = MetalPart(d, rows, at, i, cosine);
  const auto dielectric_part = hn::Sub(one, metallic);
  const auto enters = hn::Mul(dielectric_part, hn::Sub(one, taken));
  const auto behind = hn::Mul(enters, hn::Load(d, at.base_color.v + i));
  shares.reflected = hn::Add(hn::Mul(dielectric_part, dielectric), hn::Mul(metallic, metal));
  // A film's reflectance rounds; behind total reflection there is nothing at all.
  shares.refracted = hn::IfThenElseZero(hn::Gt(shares.cos_transmitted, hn::Zero(d)),
                                        hn::Mul(behind, transmission));
  if (rows.index_is_infinite) shares.refracted = hn::Zero(d);
  shares.diffuse = hn::Mul(behind, hn::Sub(one, transmission));
  shares.through = hn::Zero(d);
  if (at.layers != nullptr && at.layers->has_through) {
    const auto part = hn::Load(d, at.layers->through.v + i);
    const auto color = hn::Load(d, at.layers->through_color.v + i);
    shares.through = hn::Mul(hn::Mul(enters, hn::Sub(one, transmission)), hn::Mul(part, color));
    shares.diffuse = hn::Mul(shares.diffuse, hn::Sub(one, part));
  }
  return shares;
}

/// Where the coherent rays of a boundary go, and what share of their light gets there.
template <class D>
struct CoherentRays {
  Vec3Of<D> reflected, refracted;
  VecOf<D> reflected_share, refracted_share;
};

/// Those of a smooth surface: about the shading normal, unless that would lead to the wrong side.
template <class D>
HWY_INLINE CoherentRays<D> SmoothRays(D d, const Arrival<D>& arrival, VecOf<D> cosine,
                                      VecOf<D> cos_transmitted, VecOf<D> eta) {
  const auto& [direction, facing, normal] = arrival;
  const auto one = hn::Set(d, 1.0f);
  const auto zero = hn::Zero(d);
  auto reflected = ReflectedDirection(d, direction, normal, cosine);
  const auto cos_facing = hn::Neg(Dot3(d, direction, facing));
  reflected = Select3(d, hn::Gt(Dot3(d, reflected, facing), zero), reflected,
                      ReflectedDirection(d, direction, facing, cos_facing));
  auto refracted =
      RefractedDirection(d, direction, normal, cosine, cos_transmitted, hn::Div(one, eta));
  const auto stays_outside = hn::Ge(Dot3(d, refracted, facing), zero);
  refracted = Select3(d, stays_outside, direction, refracted);
  return {Normalized3(d, reflected), Normalized3(d, refracted), one, one};
}

/// Smith's root of a direction away from a rough surface, whose cosine with its normal is at hand.
template <class D>
HWY_INLINE VecOf<D> SmithRootOf(D d, const MaterialLanes& at, int i, const Vec3Of<D>& direction,
                                VecOf<D> cosine, VecOf<D> alpha2) {
  if (at.layers == nullptr || !at.layers->is_anisotropic) return SmithRoot(d, cosine, alpha2);
  const LayerLanes& layers = *at.layers;
  const auto along_t = Dot3(d, direction, Load3(d, layers.tangent, i));
  const auto along_b = Dot3(d, direction, Load3(d, layers.bitangent, i));
  return SmithRootAcross(d, cosine, hn::Mul(along_t, hn::Load(d, layers.alpha_t.v + i)),
                         hn::Mul(along_b, hn::Load(d, layers.alpha_b.v + i)));
}

/// Of light that a microfacet reflects, the share that its neighbours let by.
template <class D>
HWY_INLINE VecOf<D> LetBy(D d, const Arrival<D>& arrival, const MaterialLanes& at, int i,
                          const Vec3Of<D>& facet, const Vec3Of<D>& reflected, VecOf<D> alpha) {
  const auto cos_view =
      hn::Max(hn::Neg(Dot3(d, arrival.direction, arrival.shading)), hn::Set(d, kLeastCosine));
  const auto alpha2 = hn::Mul(alpha, alpha);
  const auto cos_out = Dot3(d, reflected, arrival.shading);
  const auto root_view = SmithRootOf(d, at, i, arrival.direction, cos_view, alpha2);
  const auto root_out = SmithRootOf(d, at, i, reflected, hn::Max(cos_out, hn::Zero(d)), alpha2);
  const auto share = SmithReflectedShare(d, cos_view, root_view, cos_out, root_out);
  return hn::IfThenElseZero(hn::Lt(Dot3(d, arrival.direction, facet), hn::Zero(d)), share);
}

/// Those of a microfacet: what would lead to the wrong side carries nothing, of the rest what its
/// neighbours let by. A thin sheet sends behind it the mirror image of what it reflects.
/// Source: Heitz & d'Eon, Importance Sampling Microfacet-Based BSDFs, EGSR 2014: the weights;
///         KHR_materials_transmission: the sheet.
template <class D>
HWY_INLINE CoherentRays<D> FacetRays(D d, const Arrival<D>& arrival, const MaterialLanes& at, int i,
                                     const Vec3Of<D>& facet, VecOf<D> alpha,
                                     const BoundaryShares<D>& shares, VecOf<D> eta, bool is_sheet) {
  const auto& [direction, facing, normal] = arrival;
  const auto one = hn::Set(d, 1.0f);
  const auto zero = hn::Zero(d);
  const auto cosine = hn::Neg(Dot3(d, direction, facet));

  CoherentRays<D> rays;
  rays.reflected = Normalized3(d, ReflectedDirection(d, direction, facet, cosine));
  const auto let_by = LetBy(d, arrival, at, i, facet, rays.reflected, alpha);
  rays.reflected_share = hn::IfThenElseZero(hn::Gt(Dot3(d, rays.reflected, facing), zero), let_by);
  if (is_sheet) {
    const auto twice_down = hn::Mul(hn::Set(d, -2.0f), Dot3(d, rays.reflected, normal));
    rays.refracted = Combine3(d, one, rays.reflected, twice_down, normal);
    rays.refracted_share = let_by;
  } else {
    rays.refracted =
        RefractedDirection(d, direction, facet, cosine, shares.cos_transmitted, hn::Div(one, eta));
  }
  rays.refracted = Normalized3(d, rays.refracted);
  if (!is_sheet) {
    const auto cos_behind = hn::Neg(Dot3(d, rays.refracted, normal));
    const auto root =
        SmithRootOf(d, at, i, rays.refracted, hn::Max(cos_behind, zero), hn::Mul(alpha, alpha));
    rays.refracted_share =
        hn::IfThenElseZero(hn::Gt(cosine, zero), SmithRefractedShare(d, cos_behind, root));
  }
  rays.refracted_share =
      hn::IfThenElseZero(hn::Lt(Dot3(d, rays.refracted, facing), zero), rays.refracted_share);
  return rays;
}

/// The answer of a surface to the lanes that met it: shares of light, and the directions of the
/// coherent rays. They turn about the normal of the hit, or about those of `facets`, if any.
template <class D>
HWY_INLINE SurfaceAnswer AnswerOf(D d, int stride, const MediumChange& change,
                                  const BoundaryRows& rows, const SurfaceHit& hit,
                                  const MaterialLanes& at, const MicrofacetLanes* facets) {
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
    const auto arrival = ArrivalAt(d, hit, i);
    const auto normal = facets != nullptr ? Load3(d, facets->normal, i) : arrival.shading;
    auto cosine = hn::Neg(Dot3(d, arrival.direction, normal));
    cosine = hn::Min(hn::Max(cosine, zero), one);
    const auto n_medium = RowOr(d, rows.n_medium, i, 1.0f);
    const auto eta =
        hn::Div(RowOr(d, rows.n_transmitted, i, 1.0f), RowOr(d, rows.n_incident, i, 1.0f));
    auto shares = SharesAt(d, rows, at, i, eta, cosine);
    auto rays = facets != nullptr
                    ? FacetRays(d, arrival, at, i, normal, hn::Load(d, facets->alpha.v + i), shares,
                                eta, change.crossing == Crossing::Thin)
                    : SmoothRays(d, arrival, cosine, shares.cos_transmitted, eta);
    if (hidden) shares = {zero, one, zero, zero, one};
    if (change.goes_straight() && facets == nullptr) rays.refracted = arrival.direction;
    hn::Store(cosine, d, answer.cos_incident.v + i);
    hn::Store(eta, d, answer.eta_ti.v + i);
    hn::Store(shares.diffuse, d, answer.diffuse.v + i);
    if (at.layers != nullptr && at.layers->has_through) {
      hn::Store(shares.through, d, answer.through.v + i);
    }
    hn::Store(hn::Div(one, hn::Mul(n_medium, n_medium)), d, answer.inverse_n2.v + i);
    hn::Store(hn::Mul(shares.reflected, rays.reflected_share), d, reflection.share.v + i);
    hn::Store(hn::Mul(shares.refracted, rays.refracted_share), d, refraction.share.v + i);
    Store3(d, rays.reflected, reflection.direction, i);
    Store3(d, rays.refracted, refraction.direction, i);
  }
  // Where there is one index for all lanes, they go on together.
  const float eta = answer.eta_ti[hit.lanes.front()];
  refraction.spreads =
      !change.goes_straight() && LanesWith(d, stride, answer.eta_ti.v, eta, hit.lanes) != hit.lanes;
  refraction.is_straight = change.goes_straight() && facets == nullptr;
  refraction.is_bent = !change.goes_straight();
  return answer;
}

}  // namespace HWY_NAMESPACE
}  // namespace abbe
HWY_AFTER_NAMESPACE();

#endif  // ABBE_INTEGRATE_SURFACE_ANSWER_INL_H_
