/// What stands on the bent paths of chains. Highway code, compiled once per instruction set.

#if defined(ABBE_INTEGRATE_LIGHT_CHAIN_GATES_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef ABBE_INTEGRATE_LIGHT_CHAIN_GATES_INL_H_
#undef ABBE_INTEGRATE_LIGHT_CHAIN_GATES_INL_H_
#else
#define ABBE_INTEGRATE_LIGHT_CHAIN_GATES_INL_H_
#endif

#include <cmath>
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
  return off_surface(place, chain.steps[s].normal, chain.slack_m, towards - place);
}

/// A ray that meets nothing.
inline Ray NoRay(const Vec3f& from, const Vec3f& direction) {
  return {from, 0.0f, direction};
}

/// How far a ray may be off where it ends, as a share of its length: a few roundings.
inline constexpr float kRayRounding = 4e-7f;

/// From one place to another, but for rounding errors at the ends: a place on the edge of a facet
/// may lie beyond the facet next to it, and the ray itself errs. Without any length it meets
/// nothing.
inline Ray RayBetween(const Vec3f& from, float from_slack_m, const Vec3f& to, float to_slack_m) {
  const Vec3f offset = to - from;
  const float length = glm::length(offset);
  const float t_max = length * (1.0f - kRayRounding) - from_slack_m - to_slack_m;
  if (!(t_max > 0.0f)) return NoRay(from, {0.0f, 0.0f, 1.0f});
  const Vec3f direction = offset / length;
  return {from + from_slack_m * direction, t_max, direction};
}

/// A lit place, off its surface by `offset_m`, which covers its rounding errors.
struct LitPlace {
  Vec3f origin{0.0f};
  float offset_m = 0.0f;
};

/// Whether the last facet of a chain stands on a place.
inline bool StandsOn(const ChainPath& chain, const ChainPlaces& met, const LitPlace& place,
                     int lane) {
  const std::size_t last = chain.steps.size() - 1;
  const Vec3f offset = place.origin - chain.origin - met.places[last].get(lane);
  const float near_m = kInContact * (chain.slack_m + place.offset_m);
  // Light that grazes the facet leaves it far from where it arrives.
  return std::abs(glm::dot(offset, chain.steps[last].normal)) <= near_m &&
         glm::length(offset) <= 64.0f * near_m + chain.drift_m;
}

/// Backwards from a lit place to the last facet of a chain.
inline Ray LastRay(const ChainPath& chain, const ChainPlaces& met, const LitPlace& place,
                   int lane) {
  const std::size_t last = chain.steps.size() - 1;
  if (StandsOn(chain, met, place, lane)) return NoRay(place.origin, chain.steps[last].normal);
  return RayBetween(place.origin, 0.0f, OffFacet(chain, met, last, lane, place.origin),
                    chain.slack_m);
}

/// Through the facet of step s, backwards as light goes: what lies on it is as near as rounding
/// errors of rays to it.
inline Ray RayThrough(const ChainPath& chain, const ChainPlaces& met, const LitPlace& place,
                      std::size_t s, int lane) {
  const Vec3f normal = chain.steps[s].normal;
  const bool is_last = s + 1 == chain.steps.size();
  const Vec3f next = is_last ? place.origin - chain.origin : met.places[s + 1].get(lane);
  const Vec3f here = met.places[s].get(lane);
  const float near_m = 2.0f * (chain.slack_m + kRayRounding * glm::distance(here, next));
  const Vec3f back = glm::dot(next - here, normal) > 0.0f ? -normal : normal;
  return {here + chain.origin - near_m * back, 2.0f * near_m, back};
}

/// Backwards from the facet of step s to the one before it, or to the light.
inline Ray GateRay(const ChainPath& chain, const ChainPlaces& met, const WorldLight& light,
                   std::size_t s, int lane) {
  const Vec3f from = met.places[s].get(lane) + chain.origin;
  const float slack_m = chain.slack_m;
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

/// The parts of a chain's path up to its last facet on which something may stand, as gates of the
/// job that carries its light from `light`, its source. place_of(lane) is the LitPlace.
template <class D, class PlaceOf>
void AddGates(ShadowQueue<D>& shadows, const World& world, const WorldLight& light,
              const ChainPath& chain, const ChainPlaces& met, const ShadowJob& main,
              PlaceOf&& place_of) {
  ShadowJob gate;
  gate.sample = main.sample;
  gate.lanes = main.lanes;
  gate.spread = main.spread;
  gate.gate_of = main.data;
  for (std::size_t s = 0; s < chain.steps.size(); ++s) {
    const ChainStep& step = chain.steps[s];
    gate.media = {};
    if (step.is_touched) {
      gate.at_glass = AtGlass::Ignores;
      shadows.reserve(gate);
      shadows.add(gate, [&](int lane) {
        const LitPlace place = place_of(lane);
        const Ray through = RayThrough(chain, met, place, s, lane);
        // What stands on the last facet is what it lights.
        const bool is_lit = s + 1 == chain.steps.size() && StandsOn(chain, met, place, lane);
        return is_lit ? NoRay(through.origin, through.direction) : through;
      });
    }
    // The segment that ends there.
    if (!step.is_checked) continue;
    gate.at_glass = AtGlass::Ends;
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
