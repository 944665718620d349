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
#include "abbe/optics/microfacet-inl.h"
#include "abbe/optics/microfacet_loss.h"

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
  VecOf<D> distribution;  ///< GGX's D, sr⁻¹.
};

template <class D>
HWY_INLINE HalfWay<D> HalfWayTo(D d, const ShadedSurface& surface, int i, const Vec3Of<D>& normal,
                                const Vec3Of<D>& to_light) {
  const auto one = hn::Set(d, 1.0f);
  const auto view = Load3(d, surface.hit.direction, i);
  const Vec3Of<D> to_view{hn::Neg(view.x), hn::Neg(view.y), hn::Neg(view.z)};
  const auto half = Normalized3(d, Combine3(d, one, to_light, one, to_view));
  const auto across = Combine3(d, one, half, hn::Neg(Dot3(d, normal, half)), normal);
  HalfWay<D> way;
  way.cos_view_half = hn::Min(hn::Max(Dot3(d, to_view, half), hn::Zero(d)), one);
  way.cos_view = hn::Max(hn::Load(d, surface.answer.cos_incident.v + i), hn::Set(d, kLeastCosine));
  const auto roughness =
      hn::Max(hn::Load(d, surface.at.roughness.v + i), hn::Set(d, kSmoothRoughness));
  const auto alpha = hn::Mul(roughness, roughness);
  way.alpha2 = hn::Mul(alpha, alpha);
  way.distribution = GgxDistribution(d, Dot3(d, across, across), way.alpha2);
  return way;
}

/// The rough lobe f_r of a surface in the lanes from i on: microfacets of GGX with its
/// height-correlated masking. Source: glTF 2.0, appendix B.
template <class D>
HWY_INLINE VecOf<D> RoughLobe(D d, const ShadedSurface& surface, int i, const HalfWay<D>& way,
                              VecOf<D> cos_light) {
  const auto lobe =
      hn::Mul(way.distribution,
              SmithVisibility(d, way.cos_view, hn::Max(cos_light, hn::Set(d, 1e-6f)), way.alpha2));
  const auto eta = hn::Load(d, surface.answer.eta_ti.v + i);
  const auto fresnel = SharesAt(d, surface.rows, surface.at, i, eta, way.cos_view_half).reflected;
  return hn::Mul(fresnel, lobe);
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
  VecOf<D> cosine;  ///< Of the light with the shading normal, at least 0.
};

/// f_r of all lobes of a surface that have a width, in the lanes from i on; 0 where the light is
/// not on their side.
/// Shape: `to_light` of unit length, away from the surface.
template <class D>
HWY_INLINE Scattered<D> ScatteredFrom(D d, const ShadedSurface& surface, int i,
                                      const Vec3Of<D>& to_light) {
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
    light.rough = RoughLobe(d, surface, i, way, cos_light);
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
  const auto normal = ArrivalAt(d, surface.hit, i).shading;
  const auto way = HalfWayTo(d, surface, i, normal, direction);
  const auto root = SmithRoot(d, way.cos_view, way.alpha2);
  const auto once =
      hn::Div(hn::Mul(hn::Set(d, 0.5f), way.distribution), hn::Add(way.cos_view, root));
  if (surface.rebound == nullptr) return once;
  const ReboundLanes& rebound = *surface.rebound;
  LaneArray cosine, density;
  hn::Store(Dot3(d, normal, direction), d, cosine.v);
  for (int k = 0; k < static_cast<int>(hn::Lanes(d)); ++k) {
    density[k] = cosine[k] * MicrofacetLoss::table().density(cosine[k], rebound.drawn_alpha);
  }
  const auto often = hn::Mul(hn::Load(d, density.v), hn::Set(d, static_cast<float>(1.0 / kPi)));
  const auto chance = hn::Set(d, rebound.chance);
  return hn::Add(hn::Mul(hn::Sub(hn::Set(d, 1.0f), chance), once), hn::Mul(chance, often));
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
