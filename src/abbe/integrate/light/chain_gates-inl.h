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

/// What flat glass does to straight light of a lamp.
inline AtGlass rule_of(const FlatCaustics& caustics, std::size_t light) {
  if (caustics.of_light(light) == nullptr) return AtGlass::Passes;
  return caustics.exceeds_chains ? AtGlass::Counts : AtGlass::Ends;
}

/// Between places so close, measured in their rounding errors, nothing can stand that could be told
/// from the facets that they lie on.
inline constexpr float kInContact = 4.0f;

/// A place on the facet of step s, moved off it towards another place by the rounding error that it
/// may have, so that the facet itself blocks nothing, however aslant.
inline Vec3f OffFacet(const ChainPath& chain, const ChainPlaces& met, std::size_t s, int lane,
                      const Vec3f& towards) {
  const Vec3f place = met.places[s].get(lane) + chain.origin;
  return off_surface(place, chain.steps[s].normal, met.slack_m[lane], towards - place);
}

/// A ray that meets nothing.
inline Ray NoRay(const Vec3f& from, const Vec3f& direction) {
  return {from, 0.0f, direction};
}

/// From one place to another, but for rounding errors at the ends: a place on the edge of a facet
/// may lie beyond the facet next to it. Without any length it meets nothing.
inline Ray RayBetween(const Vec3f& from, float from_slack_m, const Vec3f& to, float to_slack_m) {
  const Vec3f offset = to - from;
  const float length = glm::length(offset);
  if (!(length > from_slack_m + to_slack_m)) return NoRay(from, {0.0f, 0.0f, 1.0f});
  const Vec3f direction = offset / length;
  return {from + from_slack_m * direction, length - from_slack_m - to_slack_m, direction};
}

/// Backwards from a lit place, off its surface, to the last facet of a chain, at that distance.
inline Ray LastRay(const ChainPath& chain, const ChainPlaces& met, const Vec3f& origin,
                   float distance_m, int lane) {
  const std::size_t last = chain.steps.size() - 1;
  const float slack_m = met.slack_m[lane];
  // The facet stands on the place.
  if (distance_m <= kInContact * slack_m) return NoRay(origin, chain.steps[last].normal);
  return RayBetween(origin, 0.0f, OffFacet(chain, met, last, lane, origin), slack_m);
}

/// Backwards from the facet of step s to the one before it, or to the light.
inline Ray GateRay(const ChainPath& chain, const ChainPlaces& met, const WorldLight& light,
                   std::size_t s, int lane) {
  const Vec3f from = met.places[s].get(lane) + chain.origin;
  const float slack_m = met.slack_m[lane];
  if (s > 0) {
    const Vec3f to = met.places[s - 1].get(lane) + chain.origin;
    const float length = glm::distance(met.places[s].get(lane), met.places[s - 1].get(lane));
    if (length <= kInContact * slack_m) return NoRay(from, chain.steps[s].normal);
    return RayBetween(OffFacet(chain, met, s, lane, to), slack_m,
                      OffFacet(chain, met, s - 1, lane, from), slack_m);
  }
  if (light.is_parallel) {
    return {OffFacet(chain, met, s, lane, from - light.direction), light.parallel_distance_m(from),
            -light.direction};
  }
  return RayBetween(OffFacet(chain, met, s, lane, light.position), slack_m, light.position, 0.0f);
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
    if (!step.is_checked) continue;
    ShadowJob gate;
    gate.sample = main.sample;
    gate.lanes = main.lanes;
    gate.spread = true;
    gate.at_glass = AtGlass::Ends;
    gate.gate_of = main.data;
    if (const auto medium = step.comes_from()) {
      gate.media.push(*medium, world.materials[*medium].priority);
    }
    shadows.reserve(gate);
    shadows.add(gate, [&](int lane) { return GateRay(chain, met, light, s, lane); });
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace abbe
HWY_AFTER_NAMESPACE();

#endif  // ABBE_INTEGRATE_LIGHT_CHAIN_GATES_INL_H_
