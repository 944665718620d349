#include "abbe/world/world.h"

#include <fmt/format.h>

#include <chrono>

#include "abbe/base/error.h"
#include "abbe/world/materials.h"

namespace abbe {
namespace {

std::vector<VisibilityMask> masks_of(const World& world) {
  std::vector<VisibilityMask> masks;
  masks.reserve(world.geometry.primitive_surface.size());
  for (const std::uint32_t surface : world.geometry.primitive_surface) {
    const SurfaceMaterial& material = world.materials[world.geometry.surfaces[surface].material];
    masks.push_back(!material.lets_light_pass()            ? kOpaqueBit
                    : world.surface_is_exact[surface] != 0 ? kExactGlassBit
                                                           : kTransparentBit);
  }
  return masks;
}

}  // namespace

World make_world(const Scene& scene, const WorldOptions& options, const Observer& observer,
                 const Spectrum& d65, Notes& notes) {
  const auto start = std::chrono::steady_clock::now();
  const std::vector<Spectrum> lamps = lamp_spectra(scene, d65);
  World world(LaneModel(options.mode, options.wavelengths, observer, d65, lamps,
                        options.development, options.uplift, options.frozen));
  world.xyz_weights = world.lanes.xyz_weights();
  world.importance = world.lanes.importance();
  if (scene.materials.size() > kMaxMaterials) {
    throw_input_error(scene.name, fmt::format("{} materials", scene.materials.size()),
                      fmt::format("at most {}", kMaxMaterials));
  }
  tabulate_materials(scene, world);
  tabulate_lights(scene, world);

  world.geometry = flatten(scene, notes);
  add_chains(scene, options.caustics, notes, world);
  const std::vector<VisibilityMask> masks = masks_of(world);
  for (const VisibilityMask mask : masks) world.visibility_bits |= mask;
  world.accelerator = build_accelerator(options.accelerator, world.geometry.shapes(masks));
  world.build_seconds =
      std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  return world;
}

}  // namespace abbe
