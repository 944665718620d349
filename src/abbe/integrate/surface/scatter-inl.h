/// What a surface sends back of light that comes from elsewhere than a coherent ray: f_r of all its
/// lobes for a pair of directions, and how likely its sampled ray is to choose one. Highway code,
/// compiled once per instruction set.

#if defined(ABBE_INTEGRATE_SURFACE_SCATTER_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef ABBE_INTEGRATE_SURFACE_SCATTER_INL_H_
#undef ABBE_INTEGRATE_SURFACE_SCATTER_INL_H_
#else
#define ABBE_INTEGRATE_SURFACE_SCATTER_INL_H_
#endif

#include <hwy/highway.h>

#include "abbe/integrate/surface/answer-inl.h"
#include "abbe/integrate/surface/layers-inl.h"
#include "abbe/optics/microfacet-inl.h"
#include "abbe/optics/rough/microfacet_loss.h"

HWY_BEFORE_NAMESPACE();
namespace abbe {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

/// The half vector of two directions above a rough surface, and GGX at it, in some lanes.
template <class D>
struct HalfWay {
  VecOf<D> cos_view_half;  ///< In [0, 1].
  VecOf<D> cos_view;       ///< At least kLeastCosine.
  VecOf<D> alpha2;
  VecOf<D> root_view;     ///< Smith's.
  VecOf<D> distribution;  ///< GGX's D, sr⁻¹.
};

template <class D>
HWY_INLINE Vec3Of<D> HalfVector(D d, const Vec3Of<D>& view, const Vec3Of<D>& to_light,
                                VecOf<D>* cos_view_half) {
  const auto one = hn::Set(d, 1.0f);
  const Vec3Of<D> to_view{hn::Neg(view.x), hn::Neg(view.y), hn::Neg(view.z)};
  const auto half = Normalized3(d, Combine3(d, one, to_light, one, to_view));
  *cos_view_half = hn::Min(hn::Max(Dot3(d, to_view, half), hn::Zero(d)), one);
  return half;
}

/// D of the microfacets with that normal.
template <class D>
HWY_INLINE VecOf<D> DistributionAt(D d, const MaterialLanes& at, int i, const Vec3Of<D>& normal,
                                   const Vec3Of<D>& half, VecOf<D> alpha2) {
  const auto cos_half = Dot3(d, normal, half);
  if (at.layers != nullptr && at.layers->is_anisotropic) {
    const LayerLanes& layers = *at.layers;
    const auto t = hn::Load(d, layers.alpha_t.v + i);
    const auto b = hn::Load(d, layers.alpha_b.v + i);
    return GgxDistributionAcross(d, hn::Div(Dot3(d, half, Load3(d, layers.tangent, i)), t),
                                 hn::Div(Dot3(d, half, Load3(d, layers.bitangent, i)), b), cos_half,
                                 hn::Mul(t, b));
  }
  const auto across = Combine3(d, hn::Set(d, 1.0f), half, hn::Neg(cos_half), normal);
  return GgxDistribution(d, Dot3(d, across, across), alpha2);
}

/// The view of microfacets with a normal; but for the cosine with that.
template <class D>
HWY_INLINE HalfWay<D> ViewOf(D d, const ShadedSurface& surface, int i, const Vec3Of<D>& normal,
                             const Vec3Of<D>& half) {
  const MaterialLanes& at = surface.at;
  const auto view = Load3(d, surface.hit.direction, i);
  HalfWay<D> way;
  way.cos_view = hn::Max(hn::Load(d, surface.answer.cos_incident.v + i), hn::Set(d, kLeastCosine));
  const auto roughness = hn::Max(hn::Load(d, at.roughness.v + i), hn::Set(d, kSmoothRoughness));
  const auto alpha = hn::Mul(roughness, roughness);
  way.alpha2 = hn::Mul(alpha, alpha);
  way.root_view = SmithRootOf(d, at, i, view, way.cos_view, way.alpha2);
  way.distribution = DistributionAt(d, at, i, normal, half, way.alpha2);
  return way;
}

template <class D>
HWY_INLINE HalfWay<D> HalfWayTo(D d, const ShadedSurface& surface, int i, const Vec3Of<D>& normal,
                                const Vec3Of<D>& to_light) {
  VecOf<D> cos_view_half;
  const auto half = HalfVector(d, Load3(d, surface.hit.direction, i), to_light, &cos_view_half);
  HalfWay<D> way = ViewOf(d, surface, i, normal, half);
  way.cos_view_half = cos_view_half;
  return way;
}

/// D·G2/(4 cosines) of a rough surface in the lanes from i on: microfacets of GGX with their
/// height-correlated masking. Source: glTF 2.0, appendix B; KHR_materials_anisotropy.
template <class D>
HWY_INLINE VecOf<D> FacetLobe(D d, const ShadedSurface& surface, int i, const HalfWay<D>& way,
                              const Vec3Of<D>& to_light, VecOf<D> cos_light) {
  const auto above = hn::Max(cos_light, hn::Set(d, 1e-6f));
  const auto root_light = SmithRootOf(d, surface.at, i, to_light, above, way.alpha2);
  return hn::Mul(way.distribution,
                 SmithVisibility(d, way.cos_view, way.root_view, above, root_light));
}

/// Fresnel's k_r of its microfacets.
template <class D>
HWY_INLINE VecOf<D> FacetFresnel(D d, const ShadedSurface& surface, int i, const HalfWay<D>& way) {
  const auto eta = hn::Load(d, surface.answer.eta_ti.v + i);
  return SharesAt(d, surface.rows, surface.at, i, eta, way.cos_view_half).reflected;
}

/// The lobe f_r of light that a rough metal scatters more than once, in the lanes from i on.
template <class D>
HWY_INLINE VecOf<D> ReboundLobe(D d, const ReboundLanes& rebound, int i, VecOf<D> cos_light) {
  LaneArray cosine, light_loss;
  hn::Store(cos_light, d, cosine.v);
  for (int k = 0; k < static_cast<int>(hn::Lanes(d)); ++k) {
    light_loss[k] = MicrofacetLoss::table().at(cosine[k], rebound.alpha[i + k]);
  }
  const auto losses = hn::Mul(hn::Load(d, rebound.view_loss.v + i), hn::Load(d, light_loss.v));
  return hn::Mul(hn::Mul(hn::Load(d, rebound.factor.v + i), losses),
                 hn::Set(d, static_cast<float>(1.0 / kPi)));
}

/// How a surface scatters light from one direction along the ray that met it, in some lanes.
template <class D>
struct Scattered {
  VecOf<D> broad;   ///< f_r of lobes that no ray samples, sr⁻¹.
  VecOf<D> rough;   ///< f_r of the lobes that the sampled ray stands for, where there is one.
  VecOf<D> cosine;  ///< What both are multiplied with; at least 0.
};

/// The same under and of layers, where light from behind comes through, too. The cosines of lobes
/// about several normals are in them.
template <class D>
HWY_NOINLINE Scattered<D> LayeredFrom(D d, const ShadedSurface& surface, int i,
                                      const Vec3Of<D>& to_light) {
  const LayerLanes& layers = *surface.at.layers;
  const auto one = hn::Set(d, 1.0f);
  const auto zero = hn::Zero(d);
  const auto inverse_pi = hn::Set(d, static_cast<float>(1.0 / kPi));
  const auto arrival = ArrivalAt(d, surface.hit, i);
  const auto signed_cosine = Dot3(d, arrival.shading, to_light);
  const auto cosine = hn::Max(signed_cosine, zero);
  const auto is_above = hn::Gt(Dot3(d, arrival.facing, to_light), zero);
  const auto diffuse = hn::Load(d, surface.answer.diffuse.v + i);
  const auto coat_light = CoatAlbedo(d, surface.rows, layers, i, to_light);
  const auto under_sheen = UnderSheen(d, layers, i, cosine);

  Scattered<D> light{zero, zero, one};
  light.broad = hn::Mul(hn::Mul(hn::Mul(diffuse, inverse_pi), hn::Mul(cosine, under_sheen)),
                        UnderCoat(d, layers, i, coat_light, diffuse, CoatMean(d, layers, i)));
  VecOf<D> cos_view_half;
  const auto half = HalfVector(d, arrival.direction, to_light, &cos_view_half);
  if (layers.has_sheen) {
    LaneArray cos_light, cos_half, lobe;
    hn::Store(cosine, d, cos_light.v);
    hn::Store(hn::Max(Dot3(d, half, arrival.shading), zero), d, cos_half.v);
    for (int k = 0; k < static_cast<int>(hn::Lanes(d)); ++k) {
      lobe[k] = sheen_lobe(surface.answer.cos_incident[i + k], cos_light[k], cos_half[k],
                           layers.sheen_roughness[i + k]);
    }
    const auto sheen = hn::Mul(hn::Load(d, layers.sheen.v + i), hn::Load(d, lobe.v));
    light.broad = hn::Add(light.broad, hn::Mul(hn::Mul(sheen, cosine),
                                               UnderCoat(d, layers, i, coat_light, zero, zero)));
  }
  if (surface.has_rough_lobe) {
    const auto way = HalfWayTo(d, surface, i, arrival.shading, to_light);
    const auto k_r = FacetFresnel(d, surface, i, way);
    const auto lobe = hn::Mul(k_r, FacetLobe(d, surface, i, way, to_light, cosine));
    const auto between = hn::Min(CoatView(d, layers, i), coat_light);
    light.rough = hn::Mul(hn::Mul(hn::Mul(lobe, cosine), under_sheen),
                          UnderCoat(d, layers, i, coat_light, k_r, between));
  }
  if (surface.rebound != nullptr) {
    const auto lobe = hn::Mul(ReboundLobe(d, *surface.rebound, i, cosine), cosine);
    light.rough = hn::Add(light.rough, hn::Mul(hn::Mul(lobe, under_sheen),
                                               UnderCoat(d, layers, i, coat_light, zero, zero)));
  }
  if (surface.has_rough_coat) {
    const auto coat = CoatHalfWay(d, layers, i, arrival, half);
    const auto cos_coat = Dot3(d, Load3(d, layers.coat_normal, i), to_light);
    const auto lobe = hn::Mul(
        coat.distribution,
        SmithVisibility(d, coat.cos_view, coat.root_view, hn::Max(cos_coat, hn::Set(d, 1e-6f)),
                        SmithRoot(d, hn::Max(cos_coat, zero), coat.alpha2)));
    const auto k_r =
        hn::Mul(hn::Load(d, layers.coat.v + i), CoatFresnel(d, surface.rows, i, cos_view_half));
    light.rough = hn::Add(light.rough, hn::Mul(hn::Mul(k_r, lobe), hn::Max(cos_coat, zero)));
  }
  light.broad = hn::IfThenElseZero(is_above, light.broad);
  light.rough = hn::IfThenElseZero(is_above, light.rough);
  if (layers.has_through) {
    const auto behind = hn::Mul(hn::Max(hn::Neg(signed_cosine), zero), inverse_pi);
    const auto through =
        hn::Mul(hn::Mul(hn::Load(d, surface.answer.through.v + i), behind),
                hn::Mul(UnderCoat(d, layers, i, zero, zero, zero), UnderSheen(d, layers, i, one)));
    light.broad = hn::IfThenElse(is_above, light.broad, through);
  }
  return light;
}

/// f_r of all lobes of a surface that have a width, in the lanes from i on; 0 where the light is
/// not on their side.
/// Shape: `to_light` of unit length, away from the surface, to either side.
template <class D>
HWY_INLINE Scattered<D> ScatteredFrom(D d, const ShadedSurface& surface, int i,
                                      const Vec3Of<D>& to_light) {
  if (surface.at.layers != nullptr) return LayeredFrom(d, surface, i, to_light);
  const auto zero = hn::Zero(d);
  const auto normal = Load3(d, surface.hit.normal, i);
  const auto cos_light = Dot3(d, normal, to_light);
  const auto facing =
      FacingNormal(d, Load3(d, surface.hit.direction, i), Load3(d, surface.hit.outward, i));
  const auto sees_light = hn::And(hn::Gt(cos_light, zero), hn::Gt(Dot3(d, facing, to_light), zero));
  Scattered<D> light;
  light.cosine = hn::Max(cos_light, zero);
  light.broad =
      hn::Mul(hn::Load(d, surface.answer.diffuse.v + i), hn::Set(d, static_cast<float>(1.0 / kPi)));
  light.rough = zero;
  if (surface.has_rough_lobe) {
    const auto way = HalfWayTo(d, surface, i, normal, to_light);
    light.rough = hn::Mul(FacetFresnel(d, surface, i, way),
                          FacetLobe(d, surface, i, way, to_light, cos_light));
  }
  if (surface.rebound != nullptr) {
    light.rough = hn::Add(light.rough, ReboundLobe(d, *surface.rebound, i, cos_light));
  }
  light.broad = hn::IfThenElseZero(sees_light, light.broad);
  light.rough = hn::IfThenElseZero(sees_light, light.rough);
  return light;
}

/// The density with which the sampled ray of the rough lobes leaves in a direction, in the lanes
/// from i on: per solid angle, over all that it may do, to carry nothing included. 0 where no ray
/// samples them. In a united fan it is the same for all lanes; those of a spread one each have
/// their own view. Light sampled by other means shares Scattered::rough with that ray by it.
/// Shape:  `direction` of unit length, away from the surface.
/// Source: Heitz, Sampling the GGX Distribution of Visible Normals, JCGT 7(4), 2018: over 4 cosines
///         of the half vector, what G1 of the view leaves of D.
template <class D>
HWY_INLINE VecOf<D> SampledDensity(D d, const ShadedSurface& surface, int i,
                                   const Vec3Of<D>& direction) {
  if (!surface.samples_rough_lobe) return hn::Zero(d);
  const auto arrival = ArrivalAt(d, surface.hit, i);
  const LayerLanes* layers = surface.at.layers;
  auto of_base = hn::Zero(d);
  if (surface.has_rough_lobe) {
    const auto way = HalfWayTo(d, surface, i, arrival.shading, direction);
    of_base =
        hn::Div(hn::Mul(hn::Set(d, 0.5f), way.distribution), hn::Add(way.cos_view, way.root_view));
  }
  if (surface.rebound != nullptr) {
    const ReboundLanes& rebound = *surface.rebound;
    LaneArray cosine, density;
    hn::Store(Dot3(d, arrival.shading, direction), d, cosine.v);
    for (int k = 0; k < static_cast<int>(hn::Lanes(d)); ++k) {
      density[k] = cosine[k] * MicrofacetLoss::table().density(cosine[k], rebound.drawn_alpha);
    }
    const auto often = hn::Mul(hn::Load(d, density.v), hn::Set(d, static_cast<float>(1.0 / kPi)));
    const auto chance = hn::Set(d, rebound.chance);
    of_base = hn::Add(hn::Mul(hn::Sub(hn::Set(d, 1.0f), chance), of_base), hn::Mul(chance, often));
  }
  if (!surface.has_rough_coat) return of_base;
  VecOf<D> cos_view_half;
  const auto half = HalfVector(d, arrival.direction, direction, &cos_view_half);
  const auto coat = CoatHalfWay(d, *layers, i, arrival, half);
  const auto of_coat =
      hn::Div(hn::Mul(hn::Set(d, 0.5f), coat.distribution), hn::Add(coat.cos_view, coat.root_view));
  const auto chance = hn::Set(d, layers->coat_chance);
  return hn::Add(hn::Mul(hn::Sub(hn::Set(d, 1.0f), chance), of_base), hn::Mul(chance, of_coat));
}

/// What microfacets of a rough boundary or sheet send along the ray that met it of light from
/// behind, and how likely its refracted ray leaves to there, in some lanes.
template <class D>
struct FromBehind {
  VecOf<D> scattered;  ///< f_t·cosθ of basic radiance, sr⁻¹.
  VecOf<D> density;    ///< Per solid angle, as SampledDensity().
};

/// Where a boundary's index changes less than this, its microfacets hardly part rays: directions do
/// not tell them apart, and light is not sampled for them.
inline constexpr float kLeastBend = 1e-3f;

/// The same for light from one direction behind, in the lanes from i on: single scattering. Each
/// lane has its own half vector, and so its own density. Above the surface all is 0. Shape:
/// `to_light` of unit length, away from the surface. Domain: surface.behind. Source: Walter,
/// Marschner, Li & Torrance, Microfacet Models for Refraction through Rough
///         Surfaces, EGSR 2007: half vector and its solid angle; a sheet sends behind it the mirror
///         image of what it reflects.
template <class D>
HWY_NOINLINE FromBehind<D> ScatteredFromBehind(D d, const ShadedSurface& surface, int i,
                                               const Vec3Of<D>& to_light) {
  const auto one = hn::Set(d, 1.0f);
  const auto zero = hn::Zero(d);
  const MaterialLanes& at = surface.at;
  const auto arrival = ArrivalAt(d, surface.hit, i);
  const auto eta = hn::Load(d, surface.answer.eta_ti.v + i);
  const auto cos_behind = hn::Neg(Dot3(d, to_light, arrival.shading));
  const auto below = hn::Max(cos_behind, zero);
  const auto is_behind =
      hn::And(hn::Gt(cos_behind, zero), hn::Lt(Dot3(d, to_light, arrival.facing), zero));
  FromBehind<D> light;
  if (surface.is_sheet) {
    const auto mirrored =
        Combine3(d, one, to_light, hn::Add(cos_behind, cos_behind), arrival.shading);
    const auto way = HalfWayTo(d, surface, i, arrival.shading, mirrored);
    const auto k_t = SharesAt(d, surface.rows, at, i, eta, way.cos_view_half).refracted;
    const auto root_out = SmithRootOf(d, at, i, mirrored, below, way.alpha2);
    light.density =
        hn::Div(hn::Mul(hn::Set(d, 0.5f), way.distribution), hn::Add(way.cos_view, way.root_view));
    light.scattered =
        hn::Mul(hn::Mul(k_t, light.density),
                SmithReflectedShare(d, way.cos_view, way.root_view, cos_behind, root_out));
  } else {
    const auto back = arrival.direction;  // Away from where the lanes came.
    const auto sum = Combine3(d, one, back, hn::Neg(eta), to_light);
    const auto length2 = hn::Max(Dot3(d, sum, sum), hn::Set(d, 1e-12f));
    const auto is_up = hn::Gt(Dot3(d, sum, arrival.shading), zero);
    const auto scale = hn::Div(hn::IfThenElse(is_up, one, hn::Neg(one)), hn::Sqrt(length2));
    const Vec3Of<D> half{hn::Mul(scale, sum.x), hn::Mul(scale, sum.y), hn::Mul(scale, sum.z)};
    const auto cos_view_half = hn::Neg(Dot3(d, arrival.direction, half));
    const auto cos_light_half = hn::Neg(Dot3(d, to_light, half));
    const auto way = ViewOf(d, surface, i, arrival.shading, half);
    const auto k_t =
        SharesAt(d, surface.rows, at, i, eta, hn::Min(hn::Max(cos_view_half, zero), one)).refracted;
    const auto root_out = SmithRootOf(d, at, i, to_light, below, way.alpha2);
    // D of those visible from the view, and its half vectors per solid angle of directions.
    const auto visible =
        hn::Div(hn::Mul(hn::Add(way.distribution, way.distribution), cos_view_half),
                hn::Add(way.cos_view, way.root_view));
    const auto spread = hn::Div(hn::Mul(hn::Mul(eta, eta), cos_light_half), length2);
    const auto is_bent = hn::Gt(hn::Abs(hn::Sub(eta, one)), hn::Set(d, kLeastBend));
    const auto is_met = hn::And(hn::Gt(cos_view_half, zero), hn::Gt(cos_light_half, zero));
    const auto density = hn::IfThenElseZero(is_met, hn::Mul(visible, spread));
    light.scattered = hn::IfThenElseZero(
        is_bent, hn::Mul(hn::Mul(k_t, density), SmithRefractedShare(d, cos_behind, root_out)));
    light.density = hn::IfThenElse(is_bent, density, hn::Set(d, 1e30f));
  }
  if (at.layers != nullptr) {
    light.scattered = hn::Mul(light.scattered, hn::Load(d, at.layers->coat_through.v + i));
  }
  light.scattered = hn::IfThenElseZero(is_behind, light.scattered);
  light.density = hn::IfThenElseZero(is_behind, light.density);
  return light;
}

/// What a sampled ray carries that leaves in a direction, in the lanes from i on: f_r·cosθ of the
/// rough lobes over its density.
template <class D>
HWY_INLINE VecOf<D> SampledShare(D d, const ShadedSurface& surface, int i,
                                 const Vec3Of<D>& direction) {
  const auto light = ScatteredFrom(d, surface, i, direction);
  const auto density = SampledDensity(d, surface, i, direction);
  return hn::IfThenElseZero(hn::Gt(density, hn::Zero(d)),
                            hn::Div(hn::Mul(light.rough, light.cosine), density));
}

}  // namespace HWY_NAMESPACE
}  // namespace abbe
HWY_AFTER_NAMESPACE();

#endif  // ABBE_INTEGRATE_SURFACE_SCATTER_INL_H_
