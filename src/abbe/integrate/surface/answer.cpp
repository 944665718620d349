#include "abbe/integrate/surface/answer.h"

namespace abbe {

BoundaryRows boundary_rows(const World& world, const SurfaceMaterial& material,
                           const MediumChange& change, int set) {
  const auto index_of = [&](const std::optional<std::uint32_t>& medium) {
    return medium ? world.row(world.materials[*medium].index, set) : nullptr;
  };
  BoundaryRows rows;
  rows.index_is_infinite = material.index_is_infinite;
  rows.n_medium = index_of(change.arrives_in);
  rows.n_incident = rows.n_medium;
  rows.n_transmitted =
      change.is_boundary() ? index_of(change.goes_into()) : world.row(material.index, set);
  if (material.is_conductor) {
    rows.conductor_n = world.row(material.conductor_n, set);
    rows.conductor_k = world.row(material.conductor_k, set);
  }
  if (material.film) {
    rows.film_n = world.row(material.film->index, set);
    rows.inverse_wavelength = world.row(world.inverse_wavelength, set);
  }
  return rows;
}

}  // namespace abbe
