/// What the lanes of a fan met, in SIMD layout: the working set of shading.
#pragma once

#include "abbe/math/lane_array.h"

namespace abbe {

/// Lanes of one fan that met the same surface from the same side. In a united fan the geometry is
/// the same in all lanes; it is filled in all the same, so that there is one kind of shading code.
struct Interaction {
  LaneArray3 position;
  LaneArray3 direction;  ///< Of arrival.
  LaneArray3 outward;    ///< Geometric normal, out of the solid.
  LaneArray3 normal;     ///< Shading normal on the side of arrival.
  LaneArray offset_m;    ///< Step off the surface along the geometric normal.
  LaneArray distance_m;

  LaneArray base_color;  ///< Reflectance of the base colour.
  LaneArray emission;
  LaneArray metallic, roughness, transmission, alpha;

  LaneArray film_factor, film_thickness_nm;  ///< Filled where the material has a film.

  LaneArray throughput;
};

}  // namespace abbe
