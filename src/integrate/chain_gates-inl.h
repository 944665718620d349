/// What stands on the bent ways of chains. Highway code, compiled once per instruction set.

#if defined(ABBE_INTEGRATE_CHAIN_GATES_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef ABBE_INTEGRATE_CHAIN_GATES_INL_H_
#undef ABBE_INTEGRATE_CHAIN_GATES_INL_H_
#else
#define ABBE_INTEGRATE_CHAIN_GATES_INL_H_
#endif

#include <algorithm>
#include <cstddef>

#include "integrate/chains-inl.h"
#include "integrate/shadow_queue-inl.h"

HWY_BEFORE_NAMESPACE();
namespace abbe {
namespace HWY_NAMESPACE {

/// Backwards from the facet of step s to the one before it, or to the light.
inline Ray GateRay(const Chain& chain, const ChainWay& way, const WorldLight& light, std::size_t s,
                   int lane) {
  const Vec3f from = way.places[s].get(lane) + chain.origin;
  Ray ray;
  if (s > 0) {
    const Vec3f back = way.places[s - 1].get(lane) + chain.origin - from;
    const float length = glm::length(back);
    ray.direction = length > 0.0f ? back / length : chain.steps[s].normal;
    ray.t_max = length;
  } else if (light.type == LightType::Directional) {
    ray.direction = -light.direction;
    ray.t_max = light.is_beam ? glm::dot(from - light.position, light.direction) : kInfinity;
  } else {
    const Vec3f back = light.position - from;
    ray.t_max = glm::length(back);
    ray.direction = back / ray.t_max;
  }
  const float step_m = way.slack_m[lane];
  const float side = glm::dot(ray.direction, chain.steps[s].normal) < 0.0f ? -1.0f : 1.0f;
  ray.origin = from + side * step_m * chain.steps[s].normal;
  ray.t_max = std::max(0.0f, ray.t_max - (s > 0 ? 2.0f * step_m : 0.0f));
  return ray;
}

/// The parts of a chain's way before its last facet on which something may stand, as gates of the
/// job that carries its light.
template <class D>
void AddGates(ShadowQueue<D>& shadows, const World& world, const Chain& chain, const ChainWay& way,
              const ShadowJob& main) {
  const WorldLight& light = world.lights[chain.light];
  for (std::size_t s = 0; s < chain.steps.size(); ++s) {
    // The way that ends at step s.
    const ChainStep& step = chain.steps[s];
    const bool inside = step.event == ChainEvent::Leave || step.event == ChainEvent::ReflectInside;
    if (inside && !step.is_checked) continue;
    ShadowJob gate;
    gate.sample = main.sample;
    gate.lanes = main.lanes;
    gate.spread = true;
    gate.ends_at_glass = true;
    gate.gate_of = main.data;
    if (inside) gate.media.push(step.material);
    shadows.reserve(gate);
    shadows.add(gate, [&](int lane) { return GateRay(chain, way, light, s, lane); });
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace abbe
HWY_AFTER_NAMESPACE();

#endif  // ABBE_INTEGRATE_CHAIN_GATES_INL_H_
