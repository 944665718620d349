#include "abbe/world/chains.h"

#include <algorithm>

#include "abbe/world/parallel_chains.h"
#include "abbe/world/point_chains.h"
#include "abbe/world/world.h"

namespace abbe {
namespace {

// Marks bodies that something reaches into or lies in, by their boxes.
void find_inclusions(const Scene& scene, World& world) {
  std::vector<Box3f> boxes;
  for (const Instance& instance : scene.instances) boxes.push_back(bounds_of(scene, instance));
  for (FlatBody& body : world.flat.bodies) {
    const Box3f& own = boxes[body.instance];
    body.has_inclusions = false;
    for (std::size_t i = 0; i < boxes.size(); ++i) {
      if (i == body.instance) continue;
      const bool apart = glm::any(glm::lessThan(boxes[i].high, own.low)) ||
                         glm::any(glm::lessThan(own.high, boxes[i].low));
      body.has_inclusions |= !apart;
    }
  }
}

// The chains of all lights; names a body if there are too many of them.
std::optional<std::uint32_t> find_chains(const Scene& scene, const CausticOptions& options,
                                         World& world) {
  world.chains.clear();
  world.chain_rows.clear();
  world.point_chains = {};
  double started = 0.0;
  double cut = 0.0;
  for (std::uint32_t light = 0; light < scene.lights.size(); ++light) {
    const bool is_parallel = scene.lights[light].type == LightType::Directional;
    const ChainYield yield = is_parallel ? add_parallel_chains(scene, options, light, world)
                                         : add_point_chains(scene, options, light, world);
    if (yield.too_large) return yield.too_large;
    // Lux on square metres and candela in steradians are both lumens.
    started += yield.started * scene.lights[light].intensity;
    cut += yield.cut * scene.lights[light].intensity;
  }
  world.caustics.share_cut = started > 0.0 ? cut / started : 0.0;
  return std::nullopt;
}

void find_index_ranges(World& world) {
  for (const SurfaceMaterial& material : world.materials) {
    for (int set = 0; set < world.lanes.set_count(); ++set) {
      const float* n = world.row(material.index, set);
      const auto [least, greatest] = std::minmax_element(n, n + world.lanes.lane_count());
      world.index_ranges.push_back(Vec2d(*least, *greatest));
    }
  }
}

}  // namespace

ChainStep make_chain_step(const World& world, std::uint32_t facet, ChainEvent event) {
  const Facet& of = world.flat.facets[facet];
  const FlatBody& body = world.flat.bodies[of.body];
  ChainStep step;
  step.event = event;
  step.facet = facet;
  step.material = body.material;
  step.normal = Vec3f(of.normal);
  step.distance_m = static_cast<float>(of.distance);
  step.is_checked = step.comes_from_inside() && (!body.is_convex || body.has_inclusions);
  return step;
}

void add_chains(const Scene& scene, const CausticOptions& options, Notes& notes, World& world) {
  world.surface_is_exact.assign(world.geometry.surfaces.size(), 0);
  if (!options.exact || scene.lights.empty()) return;
  world.flat = find_flat_bodies(scene, notes);
  find_inclusions(scene, world);
  while (const auto too_large = find_chains(scene, options, world)) {
    drop_body(world.flat, *too_large, "it has too many chains of facets to count them out", notes);
  }
  world.caustics.bodies = world.flat.bodies.size();
  world.caustics.facets = world.flat.facets.size();
  world.caustics.fallbacks = world.flat.fallbacks;
  if (world.flat.bodies.empty()) return;
  for (const FlatBody& body : world.flat.bodies) {
    if (!body.is_mirror) world.surface_is_exact[body.instance] = 1;
  }
  for (WorldLight& light : world.lights) light.has_chains = true;
  std::stable_sort(world.chains.begin(), world.chains.end(),
                   [](const Chain& a, const Chain& b) { return a.largest > b.largest; });
  sort_point_chains(world.point_chains);
  if (!world.point_chains.chains.empty()) find_index_ranges(world);
  world.caustics.chains = world.chains.size() + world.point_chains.chains.size();
}

}  // namespace abbe
