/// A value per wavelength lane, laid out for vector code.
#pragma once

#include "abbe/base/constants.h"
#include "abbe/math/vec.h"

namespace abbe {

/// One float per lane.
struct alignas(64) LaneArray {
  float v[kMaxLanes];

  float& operator[](int lane) { return v[lane]; }
  float operator[](int lane) const { return v[lane]; }
};

/// A vector of three per lane.
struct LaneArray3 {
  LaneArray x, y, z;

  void set(int lane, const Vec3f& value) {
    x[lane] = value.x;
    y[lane] = value.y;
    z[lane] = value.z;
  }
  Vec3f get(int lane) const { return {x[lane], y[lane], z[lane]}; }
};

}  // namespace abbe
