/// Rays as the watertight triangle test sees them: sheared so that they run along an axis.
/// Source: Woop, Benthin & Wald, Watertight Ray/Triangle Intersection, JCGT 2(1), 2013.
#pragma once

#include <cmath>

#include "abbe/math/ray.h"

namespace abbe {

/// The axes of the triangle test: z is the longest component of the direction.
struct ShearAxes {
  int x, y, z;
  explicit ShearAxes(int longest) : z(longest) {
    x = z == 2 ? 0 : z + 1;
    y = x == 2 ? 0 : x + 1;
  }
  ShearAxes() : ShearAxes(2) {}
  /// Of a direction.
  explicit ShearAxes(const Vec3f& d)
      : ShearAxes(longest_axis(std::abs(d.x), std::abs(d.y), std::abs(d.z))) {}

 private:
  static int longest_axis(float x, float y, float z) {
    return x > y ? (x > z ? 0 : 2) : (y > z ? 1 : 2);
  }
};

/// A ray along its axes. Domain: the direction is finite and not zero.
struct ShearedRay {
  ShearAxes axes;
  float origin_x = 0.0f, origin_y = 0.0f, origin_z = 0.0f;
  float shear_x = 0.0f, shear_y = 0.0f, shear_z = 0.0f;

  ShearedRay() = default;
  explicit ShearedRay(const Ray& ray)
      : axes(ray.direction),
        origin_x(ray.origin[axes.x]),
        origin_y(ray.origin[axes.y]),
        origin_z(ray.origin[axes.z]) {
    shear_z = 1.0f / ray.direction[axes.z];
    shear_x = ray.direction[axes.x] * shear_z;
    shear_y = ray.direction[axes.y] * shear_z;
  }
};

}  // namespace abbe
