/// Light that goes on among the microfacets of rough metals: a lobe of its own, beside that of
/// single scattering. Highway code, compiled once per instruction set.
/// Source: Kulla & Conty, Revisiting Physically Based Shading at Imageworks, SIGGRAPH 2017 course.

#if defined(ABBE_INTEGRATE_SURFACE_REBOUND_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef ABBE_INTEGRATE_SURFACE_REBOUND_INL_H_
#undef ABBE_INTEGRATE_SURFACE_REBOUND_INL_H_
#else
#define ABBE_INTEGRATE_SURFACE_REBOUND_INL_H_
#endif

#include <algorithm>
#include <cmath>

#include "abbe/base/constants.h"
#include "abbe/integrate/surface/microfacet_lanes-inl.h"
#include "abbe/integrate/surface/scatter-inl.h"
#include "abbe/optics/rough/microfacet_loss.h"

HWY_BEFORE_NAMESPACE();
namespace abbe {
namespace HWY_NAMESPACE {

/// The mean of the metallic part's k_r over light from all around: Gauss's rule of three points for
/// the weight 2μ, exact for Schlick's rule.
template <class D>
HWY_INLINE VecOf<D> MeanMetalPart(D d, const BoundaryRows& rows, const MaterialLanes& at, int i) {
  constexpr float kCosines[3] = {0.21234054f, 0.59053314f, 0.91141204f};
  constexpr float kWeights[3] = {0.13965396f, 0.45848221f, 0.40186383f};
  auto sum = hn::Zero(d);
  for (int k = 0; k < 3; ++k) {
    const auto value = MetalPart(d, rows, at, i, hn::Set(d, kCosines[k]));
    sum = hn::Add(sum, hn::Mul(hn::Set(d, kWeights[k]), value));
  }
  return sum;
}

/// The lobe where `lanes` met a rough surface: F_ms of light that meets k_r again and again.
template <class D>
ReboundLanes ReboundAt(D d, int stride, const BoundaryRows& rows, const MaterialLanes& at,
                       const SurfaceAnswer& answer, const LaneMask& lanes) {
  const MicrofacetLoss& loss = MicrofacetLoss::table();
  ReboundLanes rebound;
  LaneArray mean;
  rebound.drawn_alpha = AlphaOf(at.roughness[lanes.front()]);
  for (int lane = 0; lane < stride; ++lane) {
    rebound.alpha[lane] = AlphaOf(at.roughness[lane]);
    rebound.view_loss[lane] = loss.at(answer.cos_incident[lane], rebound.alpha[lane]);
    mean[lane] = loss.mean(rebound.alpha[lane]);
    if (lanes.test(lane)) rebound.chance += rebound.view_loss[lane];
  }
  rebound.chance /= static_cast<float>(lanes.count());
  const auto one = hn::Set(d, 1.0f);
  for (int i = 0; i < stride; i += static_cast<int>(hn::Lanes(d))) {
    const auto lost = hn::Load(d, mean.v + i);
    const auto k_r = MeanMetalPart(d, rows, at, i);
    const auto often =
        hn::Div(hn::Mul(hn::Mul(k_r, k_r), hn::Sub(one, lost)), hn::Sub(one, hn::Mul(k_r, lost)));
    const auto metallic = hn::Load(d, at.metallic.v + i);
    hn::Store(hn::Div(hn::Mul(metallic, often), lost), d, rebound.factor.v + i);
  }
  return rebound;
}

/// Where light that goes on among microfacets leaves them: one direction for all lanes.
/// Domain: u in [0, 1)².
template <class D>
Vec3f DrawRebound(D d, const SurfaceHit& hit, const ReboundLanes& rebound, const Vec2f& u) {
  const float cosine = MicrofacetLoss::table().draw(rebound.drawn_alpha, std::min(u.x, 1.0f));
  const float sine = std::sqrt(std::max(0.0f, 1.0f - cosine * cosine));
  const float turn = 2.0f * static_cast<float>(kPi) * u.y;
  const int step = static_cast<int>(hn::Lanes(d));
  const int leader = hit.lanes.front();
  LaneArray3 shading;
  Store3(d, ArrivalAt(d, hit, leader / step * step).shading, shading, leader / step * step);
  return Basis(shading.get(leader))
      .to_world({sine * std::cos(turn), sine * std::sin(turn), cosine});
}

/// Lets one reflected ray stand for all rough lobes of a surface: by chance it goes where the
/// microfacets of `lobe` send it, or where light that goes on among them leaves, or where those of
/// a rough coat send it. What it carries is all lobes over the density of all ways to its
/// direction. Domain: u, on_coat in [0, 1)², which in [0, 1).
template <class D>
void ChooseRay(D d, int stride, const ShadedSurface& surface, bool spread, const Vec2f& u,
               float which, const Vec2f& on_coat, Lobe& lobe) {
  const LayerLanes* layers = surface.at.layers;
  if (layers != nullptr && which < layers->coat_chance) {
    ReflectAtCoat(d, stride, surface.hit, *layers, spread, on_coat, lobe.direction);
  } else if (surface.rebound != nullptr && u.x < surface.rebound->chance) {
    Splat(d, stride,
          DrawRebound(d, surface.hit, *surface.rebound, {u.x / surface.rebound->chance, u.y}),
          lobe.direction);
  }
  for (int i = 0; i < stride; i += static_cast<int>(hn::Lanes(d))) {
    hn::Store(SampledShare(d, surface, i, Load3(d, lobe.direction, i)), d, lobe.share.v + i);
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace abbe
HWY_AFTER_NAMESPACE();

#endif  // ABBE_INTEGRATE_SURFACE_REBOUND_INL_H_
