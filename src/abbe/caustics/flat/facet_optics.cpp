#include "abbe/caustics/flat/facet_optics.h"

#include <algorithm>
#include <cmath>

#include "abbe/optics/boundary.h"
#include "abbe/optics/snell.h"

namespace abbe {
namespace {

double value(const TabulatedScene& tables, RowId row, const Wave& wave) {
  return static_cast<double>(tables.row(row, wave.set)[wave.lane]);
}

}  // namespace

double index_of(const TabulatedScene& tables, const SurfaceMaterial* medium, const Wave& wave) {
  return medium != nullptr ? value(tables, medium->index, wave) : 1.0;
}

double facet_reflectance(const TabulatedScene& tables, const FacetMedia& media, const Wave& wave,
                         double cosine, bool from_inside) {
  const SurfaceMaterial& material = *media.inside;
  Boundary boundary;
  boundary.n_incident = index_of(tables, media.outside, wave);
  if (!(material.metallic > 0.0f)) {
    boundary.n = value(tables, material.index, wave);
    if (from_inside) std::swap(boundary.n, boundary.n_incident);
  } else if (material.is_conductor) {
    boundary.kind = BoundaryKind::Conductor;
    boundary.n = value(tables, material.conductor_n, wave);
    boundary.k = value(tables, material.conductor_k, wave);
  } else {
    boundary.kind = BoundaryKind::ColoredMetal;
    boundary.f0 = value(tables, material.base_color, wave);
  }
  if (material.film) {
    boundary.film = {value(tables, material.film->index, wave),
                     static_cast<double>(material.film->thickness_max_nm),
                     static_cast<double>(material.film->factor)};
    boundary.wavelength_nm = 1.0 / value(tables, tables.inverse_wavelength, wave);
  }
  return boundary_reflectance(boundary, cosine);
}

FacetAnswer answer_of(const TabulatedScene& tables, const FacetMedia& media, const Wave& wave,
                      const Vec3d& normal, const Vec3d& direction) {
  const double slope = glm::dot(direction, normal);
  const bool from_inside = slope > 0.0;
  const double cosine = std::min(1.0, std::abs(slope));
  FacetAnswer answer;
  answer.reflected = facet_reflectance(tables, media, wave, cosine, from_inside);
  answer.reflected_direction = reflected_direction(direction, normal);
  if (media.inside->metallic > 0.0f) return answer;
  const double inside = index_of(tables, media.inside, wave);
  const double outside = index_of(tables, media.outside, wave);
  const double eta = from_inside ? outside / inside : inside / outside;
  const auto refracted = refracted_direction(direction, normal, eta);
  if (!refracted) return answer;
  answer.refracted_direction = *refracted;
  answer.transmitted = (1.0 - answer.reflected) * value(tables, media.inside->base_color, wave);
  return answer;
}

}  // namespace abbe
