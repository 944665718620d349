/// What a surface sends back of the light that arrives from a lamp. Highway code, compiled once per
/// instruction set.

#if defined(ABBE_INTEGRATE_LIGHT_REFLECTED_LIGHT_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef ABBE_INTEGRATE_LIGHT_REFLECTED_LIGHT_INL_H_
#undef ABBE_INTEGRATE_LIGHT_REFLECTED_LIGHT_INL_H_
#else
#define ABBE_INTEGRATE_LIGHT_REFLECTED_LIGHT_INL_H_
#endif

#include <hwy/highway.h>

#include "abbe/integrate/lit_surface.h"
#include "abbe/integrate/surface/answer-inl.h"
#include "abbe/optics/microfacet-inl.h"
#include "abbe/optics/microfacet_loss.h"
#include "abbe/world/lights.h"

HWY_BEFORE_NAMESPACE();
namespace abbe {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

/// The rough lobe f_r of a surface in the lanes from i on: microfacets of GGX with its
/// height-correlated masking. Source: glTF 2.0, appendix B.
template <class D>
HWY_INLINE VecOf<D> RoughLobe(D d, const LitSurface& surface, int i, const Vec3Of<D>& normal,
                              const Vec3Of<D>& to_light, VecOf<D> cos_light) {
  const MaterialLanes& at = surface.at;
  const SurfaceAnswer& answer = surface.answer;
  const auto one = hn::Set(d, 1.0f);
  const auto zero = hn::Zero(d);
  const auto view = Load3(d, surface.where.hit.direction, i);
  const Vec3Of<D> to_view{hn::Neg(view.x), hn::Neg(view.y), hn::Neg(view.z)};
  const auto half = Normalized3(d, Combine3(d, one, to_light, one, to_view));
  const auto across = Combine3(d, one, half, hn::Neg(Dot3(d, normal, half)), normal);
  const auto cos_view_half = hn::Min(hn::Max(Dot3(d, to_view, half), zero), one);
  const auto cos_view = hn::Max(hn::Load(d, answer.cos_incident.v + i), hn::Set(d, kLeastCosine));
  const auto roughness = hn::Max(hn::Load(d, at.roughness.v + i), hn::Set(d, kSmoothRoughness));
  const auto alpha = hn::Mul(roughness, roughness);
  const auto alpha2 = hn::Mul(alpha, alpha);
  const auto lobe =
      hn::Mul(GgxDistribution(d, Dot3(d, across, across), alpha2),
              SmithVisibility(d, cos_view, hn::Max(cos_light, hn::Set(d, 1e-6f)), alpha2));
  const auto fresnel =
      SharesAt(d, surface.rows, at, i, hn::Load(d, answer.eta_ti.v + i), cos_view_half).reflected;
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

/// Light that would reach the camera by direct reflection of what arrives from a lamp, per lane,
/// before visibility: throughput/n² · E · f_r · cosθ.
template <class D>
HWY_INLINE void ReflectLight(D d, int stride, const LitSurface& surface,
                             const LightGeometry& geometry, float* contribution) {
  const SurfaceHit& hit = surface.where.hit;
  const SurfaceAnswer& answer = surface.answer;
  const auto zero = hn::Zero(d);
  const auto inverse_pi = hn::Set(d, static_cast<float>(1.0 / kPi));
  const int step = static_cast<int>(hn::Lanes(d));
  for (int i = 0; i < stride; i += step) {
    const auto view = Load3(d, hit.direction, i);
    const auto outward = Load3(d, hit.outward, i);
    const auto normal = Load3(d, hit.normal, i);
    const auto to_light = Load3(d, geometry.direction, i);
    const auto cos_light = Dot3(d, normal, to_light);
    const auto facing = FacingNormal(d, view, outward);
    const auto sees_light =
        hn::And(hn::Gt(cos_light, zero), hn::Gt(Dot3(d, facing, to_light), zero));

    auto reflected = hn::Mul(hn::Load(d, answer.diffuse.v + i), inverse_pi);
    if (surface.has_rough_lobe) {
      reflected = hn::Add(reflected, RoughLobe(d, surface, i, normal, to_light, cos_light));
    }
    if (surface.rebound != nullptr) {
      reflected = hn::Add(reflected, ReboundLobe(d, *surface.rebound, i, cos_light));
    }
    const auto arriving = hn::Mul(hn::Load(d, geometry.irradiance.v + i), cos_light);
    const auto throughput =
        hn::Mul(hn::Load(d, surface.throughput.v + i), hn::Load(d, answer.inverse_n2.v + i));
    const auto light_out =
        hn::IfThenElseZero(sees_light, hn::Mul(hn::Mul(throughput, arriving), reflected));
    hn::StoreU(light_out, d, contribution + i);
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace abbe
HWY_AFTER_NAMESPACE();

#endif  // ABBE_INTEGRATE_LIGHT_REFLECTED_LIGHT_INL_H_
