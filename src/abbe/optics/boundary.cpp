#include "abbe/optics/boundary.h"

#include <algorithm>
#include <cmath>
#include <complex>

#include "abbe/optics/fresnel.h"
#include "abbe/optics/thin_film.h"

namespace abbe {
namespace {

double bare_reflectance(const Boundary& boundary, double cos_incident) {
  switch (boundary.kind) {
    case BoundaryKind::Conductor:
      return fresnel_conductor(cos_incident, boundary.n, boundary.k, boundary.n_incident);
    case BoundaryKind::ColoredMetal:
      return fresnel_schlick(cos_incident, boundary.f0);
    case BoundaryKind::Dielectric:
      break;
  }
  return fresnel_dielectric(cos_incident, boundary.n / boundary.n_incident).reflectance();
}

std::complex<double> index_behind(const Boundary& boundary) {
  if (boundary.kind != BoundaryKind::ColoredMetal) return {boundary.n, boundary.k};
  const double root = std::sqrt(std::min(boundary.f0, 0.9999));
  return boundary.n_incident * ((1.0 + root) / (1.0 - root));
}

}  // namespace

double boundary_reflectance(const Boundary& boundary, double cos_incident) {
  const double bare = bare_reflectance(boundary, cos_incident);
  if (!boundary.film || !(boundary.film->thickness_nm > 0.0)) return bare;
  const double covered = thin_film_reflectance(cos_incident, boundary.n_incident, boundary.film->n,
                                               index_behind(boundary), boundary.film->thickness_nm,
                                               boundary.wavelength_nm);
  return bare + boundary.film->share * (covered - bare);
}

}  // namespace abbe
