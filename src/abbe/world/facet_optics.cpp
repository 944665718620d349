#include "abbe/world/facet_optics.h"

#include <cmath>
#include <complex>

#include "abbe/optics/fresnel.h"
#include "abbe/optics/thin_film.h"

namespace abbe {

double facet_reflectance(const World& world, const SurfaceMaterial& material, int set, int lane,
                         double cosine, FacetSide side) {
  const auto value = [&](RowId row) { return static_cast<double>(world.row(row, set)[lane]); };
  std::complex<double> behind = 1.0;
  double before = 1.0;
  double bare = 0.0;
  if (material.metallic > 0.0f) {
    if (material.is_conductor) {
      behind = {value(material.conductor_n), value(material.conductor_k)};
      bare = fresnel_conductor(cosine, behind.real(), behind.imag());
    } else {
      // A metal known by its colour alone: under a film, the index of that colour.
      const double f0 = value(material.base_color);
      const double root = std::sqrt(std::min(f0, 0.9999));
      behind = (1.0 + root) / (1.0 - root);
      bare = fresnel_schlick(cosine, f0, 1.0);
    }
  } else {
    const double n = value(material.index);
    if (side == FacetSide::Outside) {
      behind = n;
    } else {
      before = n;
    }
    bare = fresnel_dielectric(cosine, behind.real() / before).reflectance();
  }
  if (!material.film || !(material.film->thickness_max_nm > 0.0f)) return bare;
  const double film = thin_film_reflectance(cosine, before, value(material.film->index), behind,
                                            static_cast<double>(material.film->thickness_max_nm),
                                            1.0 / value(world.inverse_wavelength));
  return bare + static_cast<double>(material.film->factor) * (film - bare);
}

}  // namespace abbe
