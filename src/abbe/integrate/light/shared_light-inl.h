/// Light that a surface is sampled for and that the rays of its rough lobes meet as well: what
/// counts on which way. Highway code, compiled once per instruction set.
///
/// Light of shining surfaces and of the environment reaches a surface on straight ways. Samples of
/// it are drawn by the light (a spot, a direction), rays by the surface's lobes. Every way belongs
/// to one of three classes, by the lobe that it leaves the surface by and by what is on it:
/// - Broad lobes (diffuse, sheen, diffuse transmission): no ray follows them. Samples alone find
///   this light, straight through whatever lets it by, weakened.
/// - Ideal lobes (mirrors, smooth glass, a smooth coat; the camera): no sample finds their
///   direction. Rays alone do, and see what they meet whole.
/// - Rough lobes (microfacets of metals, dielectrics, coats, of rough glass and rough sheets, light
///   that goes on among them): both find it where the way is one that such a ray goes straight. A
///   sample counts n·p_l/(n·p_l + p_r), a ray p_r/(n·p_l + p_r): n the number of samples, p_l their
///   density, p_r that of the ray, both per solid angle at the surface (Veach's balance heuristic).
///   Straight are gaps of partly covering surfaces, polished sheets, and boundaries within one
///   medium: rays that pass them keep p_r, samples are weakened alike. A boundary between media
///   bends rays, a rough sheet scatters them, a mirror sends them elsewhere: behind these, a ray
///   sees light whole that no sample of its lobe finds, and samples of its lobe end there
///   (ShadowJob::is_unbent).
/// Where no ray is drawn for a rough lobe p_r is 0, and light that is never drawn (of material that
/// is seen alone, of the back of what shines to one side) has p_l 0: the other way keeps all.
///
/// p_r is one for all lanes of a united fan: weights are the same for all its wavelengths. Lanes of
/// a spread fan, and all that rough glass parts, have a ray, a place and p_r of their own each;
/// they share the spot, whose density per area is one for all. Source: Veach & Guibas, Optimally
/// Combining Sampling Techniques for Monte Carlo Rendering,
///         SIGGRAPH 1995.

#if defined(ABBE_INTEGRATE_LIGHT_SHARED_LIGHT_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef ABBE_INTEGRATE_LIGHT_SHARED_LIGHT_INL_H_
#undef ABBE_INTEGRATE_LIGHT_SHARED_LIGHT_INL_H_
#else
#define ABBE_INTEGRATE_LIGHT_SHARED_LIGHT_INL_H_
#endif

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "abbe/integrate/fan.h"
#include "abbe/integrate/lit_surface.h"
#include "abbe/integrate/surface/hit.h"
#include "abbe/integrate/surface/scatter-inl.h"
#include "abbe/world/emitters.h"
#include "abbe/world/light/environment.h"
#include "abbe/world/light/lights.h"

HWY_BEFORE_NAMESPACE();
namespace abbe {
namespace HWY_NAMESPACE {

/// Whether surfaces are sampled for light that rays meet as well.
inline bool shares_light(const World& world) {
  return world.emitters != nullptr || world.environment != nullptr;
}

/// Of how many samples of light a surface sends something on.
struct LightSamples {
  std::uint32_t all = 0;    ///< By the lobes that no ray follows.
  std::uint32_t rough = 0;  ///< The first of them also by those that rays follow; n of the weights.
};

/// What the camera sees is lit from more places, so that a pixel of few samples has little grain.
/// Narrow lobes get one: their ray finds what is large, a sample what is small, and each more would
/// only add its rare finds.
inline LightSamples light_samples_at(const Fan& fan, const ShadedSurface& surface) {
  constexpr float kNarrow = 0.06f;  // In alpha.
  const int lane = surface.hit.lanes.front();
  const LayerLanes* layers = surface.at.layers;
  const auto alpha_of = [](float roughness) { return roughness * roughness; };
  float alpha = surface.has_rough_lobe ? alpha_of(surface.at.roughness[lane]) : 0.0f;
  if (surface.has_rough_lobe && layers != nullptr && layers->is_anisotropic) {
    alpha = std::max(alpha, layers->alpha_t[lane]);
  }
  if (surface.has_rough_coat) alpha = std::max(alpha, alpha_of(layers->coat_roughness[lane]));
  const std::uint32_t all = fan.depth == 0 ? 4 : 1;
  const bool is_narrow = surface.samples_rough_lobe && alpha < kNarrow;
  const std::uint32_t rough = is_narrow ? 1 : all;
  return {surface.has_broad_lobe ? all : rough, rough};
}

/// What that light is sampled for, of a surface; no rays yet.
inline SharedRays lit_place(const World& world, const SurfaceHit& hit, std::uint32_t samples,
                            bool is_lit_from_behind) {
  const int leader = hit.lanes.front();
  SharedRays shared;
  shared.place = hit.position.get(leader);
  // What lets light through is lit from behind, too.
  const auto& layers = material_of(world, hit).layers;
  if (!is_lit_from_behind && (!layers || !layers->through)) {
    const Vec3f outward = hit.outward.get(leader);
    const bool is_front = glm::dot(hit.direction.get(leader), outward) < 0.0f;
    shared.normal = is_front ? outward : -outward;
  }
  shared.light_samples = static_cast<float>(samples);
  return shared;
}

/// The share that rays keep of a shining surface that some lanes of a fan have met.
/// Shape:  per lane; `stride` of them. Domain: fan.shared.any(), world.emitters.
HWY_MAYBE_UNUSED HWY_NOINLINE void SharesOfRays(const World& world, const FanList& list,
                                                const Fan& fan, const SurfaceHit& hit, int stride,
                                                LaneArray& share) {
  const SharedRays& shared = fan.shared;
  const auto of_lane = [&](int lane) {
    const float per_m2 = world.emitters->density({shared.place, shared.normal}, hit.primitive(lane),
                                                 hit.position.get(lane));
    if (!(per_m2 > 0.0f)) return 1.0f;
    const float way_m = list.way_m(fan, lane, stride) + hit.distance_m[lane];
    const float cosine = std::abs(glm::dot(hit.direction.get(lane), hit.outward.get(lane)));
    const float of_light = shared.light_samples * per_m2 * way_m * way_m;
    const float of_ray = list.per_sr(fan, lane, stride) * cosine;
    if (!(of_light > 0.0f)) return 1.0f;  // On the surface that sent the ray.
    return of_ray / (of_ray + of_light);
  };
  const int leader = hit.lanes.front();
  std::fill_n(share.v, stride, of_lane(leader));
  if (!fan.spread) return;
  for (int lane = leader + 1; lane < stride; ++lane) {
    if (hit.lanes.test(lane)) share[lane] = of_lane(lane);
  }
}

/// The same of an environment, in a lane whose ray goes there.
/// Units:  per_sr is the environment's own density there.
inline float share_of_ray(const SharedRays& shared, float ray_per_sr, float per_sr) {
  const float of_light = shared.light_samples * per_sr;
  return of_light > 0.0f ? ray_per_sr / (ray_per_sr + of_light) : 1.0f;
}

/// What a surface sends on of a sample of such light, before visibility, by the lobes that rays do
/// not follow and by those that they follow as well: reflecting and refracting ones.
/// Shape:  `density` of the sample per lane, per steradian.
template <class D>
HWY_INLINE void ReflectSharedLight(D d, int stride, const LitSurface& surface,
                                   const LightGeometry& geometry, const LaneArray& density,
                                   const LightSamples& samples, std::uint32_t number,
                                   LaneArray& broad, LaneArray& rough, LaneArray& through) {
  const bool is_for_rough = number < samples.rough;
  const auto part = hn::Set(d, 1.0f / static_cast<float>(samples.all));
  const bool refracts = is_for_rough && surface.shaded.behind != nullptr;
  if (!is_for_rough) Splat(d, stride, 0.0f, rough);
  if (!refracts) Splat(d, stride, 0.0f, through);
  const float* n_behind = surface.shaded.rows.n_transmitted;
  const auto rough_samples = hn::Set(d, static_cast<float>(samples.rough));
  for (int i = 0; i < stride; i += static_cast<int>(hn::Lanes(d))) {
    const auto direction = Load3(d, geometry.direction, i);
    const auto scattered = ScatteredFrom(d, surface.shaded, i, direction);
    const auto throughput = hn::Mul(hn::Load(d, surface.throughput.v + i),
                                    hn::Load(d, surface.shaded.answer.inverse_n2.v + i));
    const auto arriving =
        hn::Mul(throughput, hn::Mul(hn::Load(d, geometry.irradiance.v + i), scattered.cosine));
    hn::Store(hn::Mul(hn::Mul(arriving, part), scattered.broad), d, broad.v + i);
    if (!is_for_rough) continue;
    // The share n·p_l/(n·p_l + p_r) of the mean of n samples.
    const auto per_sr = hn::Load(d, density.v + i);
    const auto of_both =
        hn::Add(hn::Mul(rough_samples, per_sr), SampledDensity(d, surface.shaded, i, direction));
    const auto share = hn::Div(per_sr, of_both);
    hn::Store(hn::Mul(hn::Mul(arriving, share), scattered.rough), d, rough.v + i);
    if (!refracts) continue;
    const auto behind = ScatteredFromBehind(d, surface.shaded, i, direction);
    const auto kept = hn::Div(per_sr, hn::Add(hn::Mul(rough_samples, per_sr), behind.density));
    auto basic = throughput;
    if (!surface.shaded.is_sheet) {
      const auto n = RowOr(d, n_behind, i, 1.0f);
      basic = hn::Div(hn::Load(d, surface.throughput.v + i), hn::Mul(n, n));
    }
    const auto from_behind = hn::Mul(basic, hn::Load(d, geometry.irradiance.v + i));
    hn::Store(hn::Mul(hn::Mul(from_behind, kept), behind.scattered), d, through.v + i);
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace abbe
HWY_AFTER_NAMESPACE();

#endif  // ABBE_INTEGRATE_LIGHT_SHARED_LIGHT_INL_H_
