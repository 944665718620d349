#include "abbe/caustics/lit_world.h"

#include <fmt/format.h>

#include <chrono>
#include <cstddef>
#include <string>
#include <utility>
#include <vector>

#include "abbe/caustics/flat/search/find.h"
#include "abbe/scene/validation.h"
#include "abbe/world/emitters.h"

namespace abbe {
namespace {

// Exact light is dear where many bodies see each other: who waits is to know for what, and how not
// to.
void tell_cost(const FlatCaustics& flat, Notes& notes) {
  constexpr std::size_t kMany = 750;
  const std::size_t count = flat.parallel.chains.size() + flat.point.chains.size();
  if (count < kMany) return;
  notes.info("",
             "light of lamps takes " + std::to_string(count) +
                 " paths through flat glass and off flat mirrors, which costs several times what "
                 "straight light does: --chain with a small number leaves out inner reflections, "
                 "--caustics off sends all of it straight");
}

// What shines is known place by place, also where places share a mesh.
void tell_emitters(const World& world, Notes& notes) {
  constexpr std::size_t kMany = std::size_t{1} << 20;
  if (!world.emitters || world.emitters->piece_count() < kMany) return;
  notes.info("",
             fmt::format("{:.3g} million triangles light others, those of a shared mesh at each "
                         "of its places, and take {:.3g} MB: --emissive-light off shares them",
                         static_cast<double>(world.emitters->piece_count()) * 1e-6,
                         static_cast<double>(world.emitters->bytes()) * 1e-6));
}

// Where a lamp with an extent still shines as one without.
void warn_of_extents(const TabulatedScene& tables, const FlatCaustics& flat, Notes& notes) {
  std::vector<bool> has_chains(tables.lights.size(), false);
  for (const ParallelChain& chain : flat.parallel.chains) has_chains[chain.light] = true;
  for (const PointChain& chain : flat.point.chains) {
    has_chains[flat.point.groups[chain.group].light] = true;
  }
  for (std::size_t i = 0; i < tables.lights.size(); ++i) {
    const WorldLight& light = tables.lights[i];
    if (!light.extent || (!has_chains[i] && !tables.fog)) continue;
    notes.warn("light \"" + light.name + "\"",
               has_chains[i] ? "its shape counts on straight ways; through flat glass and off "
                               "mirrors it shines from its middle"
                             : "its shape counts on surfaces; in fog it shines from its middle");
  }
}

}  // namespace

LitWorld make_lit_world(const Scene& scene, const WorldOptions& options,
                        const CausticOptions& caustics, const Observer& observer,
                        const Spectrum& d65, Notes& notes) {
  const auto start = std::chrono::steady_clock::now();
  validate(scene, "scene");
  TabulatedScene tables = tabulate(scene, options, observer, d65);
  FlatCaustics flat = find_flat_caustics(scene, tables, caustics, notes);
  Geometry geometry = flatten(scene, notes, options.sharing, flat.surface_is_exact);
  tell_cost(flat, notes);
  warn_of_extents(tables, flat, notes);
  World world = make_world(std::move(tables), std::move(geometry), flat.surface_is_exact,
                           options.accelerator);
  tell_emitters(world, notes);
  const std::chrono::duration<double> elapsed = std::chrono::steady_clock::now() - start;
  return {std::move(world), std::move(flat), options, caustics, elapsed.count()};
}

}  // namespace abbe
