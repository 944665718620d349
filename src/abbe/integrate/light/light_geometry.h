/// Light of lamps on its way to lanes, in SIMD layout.
#pragma once

#include "abbe/math/lane_array.h"

namespace abbe {

/// Where light comes from in every lane: unit directions to it, and how much of it.
struct LightGeometry {
  LaneArray3 direction;
  LaneArray distance_m;
  LaneArray irradiance;  ///< Across that direction, before visibility.
};

}  // namespace abbe
