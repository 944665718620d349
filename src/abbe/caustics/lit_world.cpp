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
  // Of a lamp with an extent those of one place are followed at a time.
  std::size_t count = flat.near.parallel_count + flat.near.point_count;
  for (const ChainsNear& place : flat.near_places) {
    count += (place.parallel_count + place.point_count) / flat.near_places.size();
  }
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
  std::vector<bool> is_one_place(tables.lights.size(), false);
  const auto look_at = [&](const ChainPath& chain) {
    const ChainSource& source = flat.sources[chain.source];
    if (!source.is_part) is_one_place[source.lamp] = true;
  };
  for (const ParallelChain& chain : flat.parallel.chains) look_at(chain);
  for (const PointChain& chain : flat.point.chains) look_at(chain);
  for (std::size_t i = 0; i < tables.lights.size(); ++i) {
    const WorldLight& light = tables.lights[i];
    if (!light.extent || (!is_one_place[i] && !tables.fog)) continue;
    notes.warn(
        "light \"" + light.name + "\"",
        is_one_place[i]
            ? "its shape counts on straight ways; there is so much flat glass that it shines "
              "from its middle through it and off mirrors"
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
