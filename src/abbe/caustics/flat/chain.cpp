#include "abbe/caustics/flat/chain.h"

namespace abbe {

ChainStep make_chain_step(const FlatBodies& flat, std::uint32_t facet, ChainEvent event) {
  const Facet& of = flat.facets[facet];
  const FlatBody& body = flat.bodies[of.body];
  ChainStep step;
  step.event = event;
  step.facet = facet;
  step.material = body.material;
  step.normal = Vec3f(of.normal);
  step.distance_m = static_cast<float>(of.distance);
  step.is_checked = step.comes_from_inside() && (!body.is_convex || body.has_inclusions);
  return step;
}

}  // namespace abbe
