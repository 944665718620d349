#include "abbe/caustics/lit_world.h"

#include <chrono>
#include <utility>

#include "abbe/caustics/flat/search/find.h"
#include "abbe/scene/validation.h"

namespace abbe {

LitWorld make_lit_world(const Scene& scene, const WorldOptions& options,
                        const CausticOptions& caustics, const Observer& observer,
                        const Spectrum& d65, Notes& notes) {
  const auto start = std::chrono::steady_clock::now();
  validate(scene, "scene");
  TabulatedScene tables = tabulate(scene, options, observer, d65);
  Geometry geometry = flatten(scene, notes, options.sharing);
  FlatCaustics flat = find_flat_caustics(scene, tables, caustics, notes);
  World world = make_world(std::move(tables), std::move(geometry), flat.surface_is_exact,
                           options.accelerator);
  const std::chrono::duration<double> elapsed = std::chrono::steady_clock::now() - start;
  return {std::move(world), std::move(flat), options, caustics, elapsed.count()};
}

}  // namespace abbe
