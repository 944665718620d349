#include "abbe/caustics/flat/facet_optics.h"

#include "abbe/optics/boundary.h"

namespace abbe {

double facet_reflectance(const TabulatedScene& tables, const SurfaceMaterial& material, int set,
                         int lane, double cosine, FacetSide side) {
  const auto value = [&](RowId row) { return static_cast<double>(tables.row(row, set)[lane]); };
  Boundary boundary;
  if (!(material.metallic > 0.0f)) {
    (side == FacetSide::Outside ? boundary.n : boundary.n_incident) = value(material.index);
  } else if (material.is_conductor) {
    boundary.kind = BoundaryKind::Conductor;
    boundary.n = value(material.conductor_n);
    boundary.k = value(material.conductor_k);
  } else {
    boundary.kind = BoundaryKind::ColoredMetal;
    boundary.f0 = value(material.base_color);
  }
  if (material.film) {
    boundary.film = {value(material.film->index),
                     static_cast<double>(material.film->thickness_max_nm),
                     static_cast<double>(material.film->factor)};
    boundary.wavelength_nm = 1.0 / value(tables.inverse_wavelength);
  }
  return boundary_reflectance(boundary, cosine);
}

}  // namespace abbe
