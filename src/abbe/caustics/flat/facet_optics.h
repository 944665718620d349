/// What flat facets do to light, in double precision.
#pragma once

#include "abbe/world/world.h"

namespace abbe {

/// Where light comes from that meets a facet.
enum class FacetSide { Outside, Inside };

/// Share of unpolarised light that a smooth untextured facet reflects, under its thin film if it
/// has one; at total internal reflection 1.
/// Domain: cosine in [0, 1]; from inside only where light can be inside. Air is outside.
double facet_reflectance(const TabulatedScene& tables, const SurfaceMaterial& material, int set,
                         int lane, double cosine, FacetSide side);

}  // namespace abbe
