/// Rays as the watertight triangle test sees them: sheared so that they run along an axis.
/// Source: Woop, Benthin & Wald, Watertight Ray/Triangle Intersection, JCGT 2(1), 2013.
#pragma once

#include <cmath>

#include "abbe/accel/shapes.h"
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

/// Whether a triangle is met from behind. The axes are an even permutation and shearing turns
/// nothing round, so that the determinant of the test has the sign of −normal·z, and a ray the
/// direction of shear_z along z.
inline bool is_from_behind(float determinant, float shear_z) {
  return (determinant < 0.0f) != (shear_z < 0.0f);
}

/// Whether a triangle that is there from the front only is not there for a query that meets it.
inline bool is_culled(QueryMask mask, float determinant, float shear_z) {
  return (mask & (is_from_behind(determinant, shear_z) ? kCullBack : kCullFront)) != 0;
}

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
