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
#include "abbe/optics/microfacet_loss.h"

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

/// The lobe of lanes that met a rough surface: F_ms of light that meets k_r again and again.
template <class D>
ReboundLanes ReboundAt(D d, int stride, const BoundaryRows& rows, const MaterialLanes& at,
                       const SurfaceAnswer& answer) {
  const MicrofacetLoss& loss = MicrofacetLoss::table();
  ReboundLanes rebound;
  LaneArray mean;
  for (int lane = 0; lane < stride; ++lane) {
    rebound.alpha[lane] = AlphaOf(at.roughness[lane]);
    rebound.view_loss[lane] = loss.at(answer.cos_incident[lane], rebound.alpha[lane]);
    mean[lane] = loss.mean(rebound.alpha[lane]);
  }
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

/// Lets the reflected ray of microfacets stand for one of the two lobes, by chance: with the mean
/// share that they let by for single scattering, else for what goes on among them, whose direction
/// is drawn by what the first lane loses. Each is divided by its probability, which is one for all
/// lanes. Domain: u in [0, 1)².
template <class D>
void ChooseRebound(D d, int stride, const SurfaceHit& hit, const MicrofacetLanes& facets,
                   const ReboundLanes& rebound, Vec2f u, SurfaceAnswer& answer) {
  Lobe& lobe = answer.lobes[0];
  LaneArray let_by;
  LaneArray3 shading, facing;
  for (int i = 0; i < stride; i += static_cast<int>(hn::Lanes(d))) {
    const auto arrival = ArrivalAt(d, hit, i);
    hn::Store(LetBy(d, arrival, Load3(d, facets.normal, i), Load3(d, lobe.direction, i),
                    hn::Load(d, facets.alpha.v + i)),
              d, let_by.v + i);
    Store3(d, arrival.shading, shading, i);
    Store3(d, arrival.facing, facing, i);
  }
  float once = 0.0f;
  for (int lane = 0; lane < stride; ++lane) once += hit.lanes.test(lane) ? let_by[lane] : 0.0f;
  once /= static_cast<float>(hit.lanes.count());
  if (u.x < once) {
    for (int lane = 0; lane < stride; ++lane) lobe.share[lane] /= once;
    return;
  }
  const float again = 1.0f - once;
  const int leader = hit.lanes.front();
  const MicrofacetLoss& loss = MicrofacetLoss::table();
  const auto [cosine_out, density] =
      loss.draw(facets.alpha[leader], std::min((u.x - once) / again, 1.0f));
  const float sine = std::sqrt(std::max(0.0f, 1.0f - cosine_out * cosine_out));
  const float turn = 2.0f * static_cast<float>(kPi) * u.y;
  const Vec3f direction = Basis(shading.get(leader))
                              .to_world({sine * std::cos(turn), sine * std::sin(turn), cosine_out});
  for (int lane = 0; lane < stride; ++lane) {
    const float cosine = glm::dot(direction, shading.get(lane));
    const bool gets_out = glm::dot(direction, facing.get(lane)) > 0.0f;
    lobe.share[lane] = gets_out ? rebound.factor[lane] * loss.at(cosine, rebound.alpha[lane]) *
                                      (1.0f - let_by[lane]) / (again * density)
                                : 0.0f;
  }
  Splat(d, stride, direction, lobe.direction);
}

}  // namespace HWY_NAMESPACE
}  // namespace abbe
HWY_AFTER_NAMESPACE();

#endif  // ABBE_INTEGRATE_SURFACE_REBOUND_INL_H_
