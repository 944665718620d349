#include "abbe/caustics/flat/chain.h"

namespace abbe {

ChainStep make_chain_step(const FlatBodies& flat, std::uint32_t facet, ChainEvent event) {
  const Facet& of = flat.facets[facet];
  const FlatBody& body = flat.bodies[of.body];
  ChainStep step;
  step.event = event;
  step.facet = facet;
  step.material = body.material;
  if (of.beyond) step.outside = flat.bodies[*of.beyond].material;
  step.normal = Vec3f(of.normal);
  step.distance_m = static_cast<float>(of.distance);
  const FlatBody* through = step.comes_from_inside() ? &body : nullptr;
  if (!step.comes_from_inside() && of.beyond) through = &flat.bodies[*of.beyond];
  step.is_checked = through == nullptr || !through->is_convex || through->has_inclusions;
  return step;
}

}  // namespace abbe
