/// What flat facets do to light, in double precision.
#pragma once

#include <optional>

#include "abbe/math/vec.h"
#include "abbe/world/world.h"

namespace abbe {

/// The media on the sides of a facet.
struct FacetMedia {
  const SurfaceMaterial* inside = nullptr;   ///< Its own material: glass, or a mirror's metal.
  const SurfaceMaterial* outside = nullptr;  ///< Absent: air.
};

/// A lane of a wavelength set.
struct Wave {
  int set = 0, lane = 0;
};

/// What a facet does to a ray.
struct FacetAnswer {
  double reflected = 1.0;    ///< Share of power.
  double transmitted = 0.0;  ///< Its tint counted, too; 0 at total reflection and of mirrors.
  Vec3d reflected_direction{0.0}, refracted_direction{0.0};
};

/// What a smooth untextured facet does to unpolarised light, under its thin film if it has one.
/// Domain: unit vectors; the normal points outwards, and the side is that which light comes from.
FacetAnswer answer_of(const TabulatedScene& tables, const FacetMedia& media, const Wave& wave,
                      const Vec3d& normal, const Vec3d& direction);

/// Index of refraction of a medium; 1 of air.
double index_of(const TabulatedScene& tables, const SurfaceMaterial* medium, const Wave& wave);

/// The reflected share of that alone. Domain: cosine in [0, 1].
double facet_reflectance(const TabulatedScene& tables, const FacetMedia& media, const Wave& wave,
                         double cosine, bool from_inside);

}  // namespace abbe
