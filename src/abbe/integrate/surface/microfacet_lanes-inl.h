/// The coherent lobes of rough surfaces, about one microfacet. Highway code, compiled once per
/// instruction set.

#if defined(ABBE_INTEGRATE_SURFACE_MICROFACET_LANES_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef ABBE_INTEGRATE_SURFACE_MICROFACET_LANES_INL_H_
#undef ABBE_INTEGRATE_SURFACE_MICROFACET_LANES_INL_H_
#else
#define ABBE_INTEGRATE_SURFACE_MICROFACET_LANES_INL_H_
#endif

#include <algorithm>
#include <cstddef>

#include "abbe/integrate/surface/answer-inl.h"
#include "abbe/integrate/surface/microfacet.h"

HWY_BEFORE_NAMESPACE();
namespace abbe {
namespace HWY_NAMESPACE {

/// Microfacets that lanes meet, and the roughness that they were drawn from.
struct MicrofacetLanes {
  LaneArray3 normal;
  LaneArray alpha;
};

/// One microfacet normal, drawn once for all lanes among those visible from where they come from.
/// Domain: u in [0, 1)².
template <class D>
MicrofacetLanes SampleMicrofacets(D d, int stride, const SurfaceHit& hit,
                                  const LaneArray& roughness, bool spread, const Vec2f& u) {
  MicrofacetLanes facets;
  const int last = spread ? stride : 1;
  for (int lane = 0; lane < last; ++lane) {
    const int source = hit.lanes.test(lane) ? lane : hit.lanes.front();
    const float rough = std::max(roughness[source], kSmoothRoughness);
    facets.alpha[lane] = rough * rough;
    const Basis basis(hit.normal.get(source));
    Vec3f view = basis.to_local(-hit.direction.get(source));
    view.z = std::max(view.z, 1e-4f);
    const Vec3f facet = sample_visible_normal(glm::normalize(view), facets.alpha[lane], u);
    facets.normal.set(lane, basis.to_world(facet));
  }
  if (!spread) {
    Splat(d, stride, facets.normal.get(0), facets.normal);
    Splat(d, stride, facets.alpha[0], facets.alpha);
  }
  return facets;
}

/// Weighs the lobes of a microfacet with the share of light that its neighbours let by.
inline void MaskLobes(int stride, const MicrofacetLanes& facets, const SurfaceHit& hit,
                      SurfaceAnswer& answer) {
  for (std::size_t i = 0; i < answer.lobe_count; ++i) {
    Lobe& lobe = answer.lobes[i];
    const float side = lobe.made_by == FanOrigin::Refracted ? -1.0f : 1.0f;
    for (int lane = 0; lane < stride; ++lane) {
      const float cosine = side * glm::dot(lobe.direction.get(lane), hit.normal.get(lane));
      lobe.share[lane] *=
          cosine > 0.0f ? ggx_masking(std::min(cosine, 1.0f), facets.alpha[lane]) : 0.0f;
    }
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace abbe
HWY_AFTER_NAMESPACE();

#endif  // ABBE_INTEGRATE_SURFACE_MICROFACET_LANES_INL_H_
