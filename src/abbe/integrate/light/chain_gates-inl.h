/// What stands on the bent paths of chains. Highway code, compiled once per instruction set.

#if defined(ABBE_INTEGRATE_LIGHT_CHAIN_GATES_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef ABBE_INTEGRATE_LIGHT_CHAIN_GATES_INL_H_
#undef ABBE_INTEGRATE_LIGHT_CHAIN_GATES_INL_H_
#else
#define ABBE_INTEGRATE_LIGHT_CHAIN_GATES_INL_H_
#endif

#include <cstddef>

#include "abbe/caustics/flat/light/chain_places.h"
#include "abbe/integrate/light/shadow_queue-inl.h"
#include "abbe/integrate/surface/point.h"

HWY_BEFORE_NAMESPACE();
namespace abbe {
namespace HWY_NAMESPACE {

/// A place on the facet of step s, moved off it towards another place by the rounding error that it
/// may have, so that the facet itself blocks nothing, however aslant.
inline Vec3f OffFacet(const ChainPath& chain, const ChainPlaces& met, std::size_t s, int lane,
                      const Vec3f& towards) {
  const Vec3f place = met.places[s].get(lane) + chain.origin;
  return off_surface(place, chain.steps[s].normal, met.slack_m[lane], towards - place);
}

inline Ray RayBetween(const Vec3f& from, const Vec3f& to, const Vec3f& direction_if_none) {
  const Vec3f offset = to - from;
  const float length = glm::length(offset);
  return {from, length, length > 0.0f ? offset / length : direction_if_none};
}

/// Backwards from a lit place, off its surface, to the last facet of a chain.
inline Ray LastRay(const ChainPath& chain, const ChainPlaces& met, const Vec3f& origin, int lane) {
  const std::size_t last = chain.steps.size() - 1;
  return RayBetween(origin, OffFacet(chain, met, last, lane, origin), chain.steps[last].normal);
}

/// Backwards from the facet of step s to the one before it, or to the light.
inline Ray GateRay(const ChainPath& chain, const ChainPlaces& met, const WorldLight& light,
                   std::size_t s, int lane) {
  const Vec3f from = met.places[s].get(lane) + chain.origin;
  const Vec3f& normal = chain.steps[s].normal;
  if (s > 0) {
    const Vec3f to = met.places[s - 1].get(lane) + chain.origin;
    return RayBetween(OffFacet(chain, met, s, lane, to), OffFacet(chain, met, s - 1, lane, from),
                      normal);
  }
  if (light.is_parallel) {
    return {OffFacet(chain, met, s, lane, from - light.direction), light.parallel_distance_m(from),
            -light.direction};
  }
  return RayBetween(OffFacet(chain, met, s, lane, light.position), light.position, normal);
}

/// The parts of a chain's path before its last facet on which something may stand, as gates of the
/// job that carries its light.
template <class D>
void AddGates(ShadowQueue<D>& shadows, const World& world, const ChainPath& chain,
              const ChainPlaces& met, const ShadowJob& main) {
  const WorldLight& light = world.lights[chain.light];
  for (std::size_t s = 0; s < chain.steps.size(); ++s) {
    // The segment that ends at step s.
    const ChainStep& step = chain.steps[s];
    const bool inside = step.comes_from_inside();
    if (inside && !step.is_checked) continue;
    ShadowJob gate;
    gate.sample = main.sample;
    gate.lanes = main.lanes;
    gate.spread = true;
    gate.ends_at_glass = true;
    gate.gate_of = main.data;
    if (inside) gate.media.push(step.material);
    shadows.reserve(gate);
    shadows.add(gate, [&](int lane) { return GateRay(chain, met, light, s, lane); });
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace abbe
HWY_AFTER_NAMESPACE();

#endif  // ABBE_INTEGRATE_LIGHT_CHAIN_GATES_INL_H_
