/// What the lanes of a fan met, in SIMD layout: the working set of shading.
#pragma once

#include "base/constants.h"
#include "integrate/fan.h"
#include "math/vec.h"

namespace abbe {

/// One float per lane.
struct alignas(64) LaneArray {
  float v[kMaxLanes];

  float& operator[](int lane) { return v[lane]; }
  float operator[](int lane) const { return v[lane]; }
};

struct LaneArray3 {
  LaneArray x, y, z;

  void set(int lane, const Vec3f& value) {
    x[lane] = value.x;
    y[lane] = value.y;
    z[lane] = value.z;
  }
  Vec3f get(int lane) const { return {x[lane], y[lane], z[lane]}; }
};

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
