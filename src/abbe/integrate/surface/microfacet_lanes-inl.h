/// The microfacets that light meets on rough surfaces. Highway code, compiled once per
/// instruction set.

#if defined(ABBE_INTEGRATE_SURFACE_MICROFACET_LANES_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef ABBE_INTEGRATE_SURFACE_MICROFACET_LANES_INL_H_
#undef ABBE_INTEGRATE_SURFACE_MICROFACET_LANES_INL_H_
#else
#define ABBE_INTEGRATE_SURFACE_MICROFACET_LANES_INL_H_
#endif

#include <algorithm>

#include "abbe/integrate/surface/answer-inl.h"
#include "abbe/optics/microfacet.h"

HWY_BEFORE_NAMESPACE();
namespace abbe {
namespace HWY_NAMESPACE {

inline float AlphaOf(float roughness) {
  const float rough = std::max(roughness, kSmoothRoughness);
  return rough * rough;
}

/// One microfacet normal of a rough surface, drawn once for all lanes among those visible from
/// where they come from.
/// Domain: u in [0, 1)².
template <class D>
MicrofacetLanes SampleMicrofacets(D d, int stride, const SurfaceHit& hit, const MaterialLanes& at,
                                  bool spread, const Vec2f& u) {
  MicrofacetLanes facets;
  LaneArray3 shading;
  for (int i = 0; i < stride; i += static_cast<int>(hn::Lanes(d))) {
    Store3(d, ArrivalAt(d, hit, i).shading, shading, i);
  }
  const LayerLanes* along = at.layers != nullptr && at.layers->is_anisotropic ? at.layers : nullptr;
  const int last = spread ? stride : 1;
  for (int lane = 0; lane < last; ++lane) {
    const int source = hit.lanes.test(lane) ? lane : hit.lanes.front();
    facets.alpha[lane] = AlphaOf(at.roughness[source]);
    const Vec3f normal = shading.get(source);
    Basis basis(normal);
    Vec2f alpha(facets.alpha[lane]);
    if (along != nullptr) {
      basis.tangent = along->tangent.get(source);
      basis.bitangent = along->bitangent.get(source);
      alpha = {along->alpha_t[source], along->alpha_b[source]};
    }
    Vec3f view = basis.to_local(-hit.direction.get(source));
    view.z = std::max(view.z, kLeastCosine);
    const Vec3f facet = sample_visible_normal(glm::normalize(view), alpha, u);
    facets.normal.set(lane, basis.to_world(facet));
  }
  if (!spread) {
    Splat(d, stride, facets.normal.get(0), facets.normal);
    Splat(d, stride, facets.alpha[0], facets.alpha);
  }
  return facets;
}

}  // namespace HWY_NAMESPACE
}  // namespace abbe
HWY_AFTER_NAMESPACE();

#endif  // ABBE_INTEGRATE_SURFACE_MICROFACET_LANES_INL_H_
