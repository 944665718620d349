#include "support/gems.h"

#include <cmath>

#include "abbe/base/constants.h"

namespace abbe::test {
namespace {

constexpr int kFold = 8;

// A point at a radius, an azimuth in eighths of a turn, and a height.
Vec3d at(double radius, double eighths, double height) {
  const double azimuth = 2.0 * kPi * eighths / kFold;
  return {radius * std::cos(azimuth), height, radius * std::sin(azimuth)};
}

// The plane through three points, its normal away from the axis' middle.
Vec4d plane_through(const Vec3d& a, const Vec3d& b, const Vec3d& c) {
  Vec3d normal = glm::normalize(glm::cross(b - a, c - a));
  double distance = glm::dot(normal, a);
  if (distance < glm::dot(normal, Vec3d(0.0, -0.2, 0.0))) {
    normal = -normal;
    distance = -distance;
  }
  return {normal, distance};
}

enum class Cut { Single, Simple, Brilliant };

ConvexShape cut_gem(Cut cut) {
  const double crown = std::tan(34.5 * kPi / 180.0);
  const double pavilion = std::tan(40.75 * kPi / 180.0);
  const double half = std::cos(kPi / kFold);  // Of half an eighth: from corner to middle of a side.
  const double table_radius = 0.56;
  const double table_height = (1.0 - table_radius) * crown;
  const double star_radius = 0.5 * (table_radius * half + 1.0);
  const double lower_radius = 1.0 - 0.77;
  ConvexShape gem;
  gem.planes.push_back({0.0, 1.0, 0.0, table_height});
  for (int k = 0; k < kFold; ++k) {
    // Bezels and mains pass through the girdle at k, stars and halves belong to k + 1/2.
    const double next = k + 1.0;
    const double middle = k + 0.5;
    const Vec3d girdle = at(1.0, k, 0.0);
    const Vec3d girdle_middle = at(1.0, middle, 0.0);
    const Vec3d girdle_next = at(1.0, next, 0.0);
    const Vec3d star = at(star_radius, middle, (1.0 - star_radius * half) * crown);
    const Vec3d lower = at(lower_radius, middle, -(1.0 - lower_radius * half) * pavilion);
    const Vec3d tangent = at(1.0, k + 2.0, 0.0);
    gem.planes.push_back(
        plane_through(girdle, girdle + tangent, at(table_radius, k, table_height)));
    if (cut != Cut::Single) {
      gem.planes.push_back(plane_through(at(table_radius, k, table_height),
                                         at(table_radius, next, table_height), star));
    }
    if (cut == Cut::Simple) gem.planes.push_back(plane_through(star, girdle, girdle_next));
    if (cut == Cut::Brilliant) {
      gem.planes.push_back(plane_through(star, girdle, girdle_middle));
      gem.planes.push_back(plane_through(star, girdle_middle, girdle_next));
    }
    gem.planes.push_back(plane_through(girdle, girdle + tangent, {0.0, -pavilion, 0.0}));
    if (cut == Cut::Brilliant) {
      gem.planes.push_back(plane_through(lower, girdle, girdle_middle));
      gem.planes.push_back(plane_through(lower, girdle_middle, girdle_next));
    }
  }
  return gem;
}

}  // namespace

ConvexShape brilliant() {
  return cut_gem(Cut::Brilliant);
}
ConvexShape single_cut() {
  return cut_gem(Cut::Single);
}
ConvexShape simple_brilliant() {
  return cut_gem(Cut::Simple);
}

}  // namespace abbe::test
