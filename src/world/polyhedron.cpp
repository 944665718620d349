#include "world/polyhedron.h"

#include <algorithm>
#include <cmath>

namespace abbe {
namespace {

std::optional<Vec3d> intersection(const Plane& a, const Plane& b, const Plane& c) {
  const Vec3d bc = glm::cross(b.normal, c.normal);
  const double determinant = glm::dot(a.normal, bc);
  // The sine of the angle between a plane and the line of the other two: below this the corner's
  // place has no meaning.
  if (std::abs(determinant) < 1e-9) return std::nullopt;
  return (a.distance * bc + b.distance * glm::cross(c.normal, a.normal) +
          c.distance * glm::cross(a.normal, b.normal)) /
         determinant;
}

}  // namespace

std::optional<std::vector<Vec3d>> polyhedron_corners(std::span<const Plane> planes) {
  double size = 0.0;
  for (const Plane& plane : planes) size = std::max(size, std::abs(plane.distance));
  // A large cube around everything: a corner on it shows that the solid has no end.
  const double far = std::max(size, 1e-6) * 1e6;
  std::vector<Plane> all(planes.begin(), planes.end());
  for (int axis = 0; axis < 3; ++axis) {
    for (const double sign : {-1.0, 1.0}) {
      Plane plane;
      plane.normal = Vec3d(0.0);
      plane.normal[axis] = sign;
      plane.distance = far;
      all.push_back(plane);
    }
  }
  std::vector<Vec3d> corners;
  const double tolerance = 1e-9 * std::max(size, 1e-6);
  for (std::size_t i = 0; i < all.size(); ++i) {
    for (std::size_t j = i + 1; j < all.size(); ++j) {
      for (std::size_t k = j + 1; k < all.size(); ++k) {
        const std::optional<Vec3d> corner = intersection(all[i], all[j], all[k]);
        if (!corner) continue;
        const bool at_far = k >= planes.size();
        const double slack = at_far ? 1e-9 * far : tolerance;
        const bool inside = std::all_of(all.begin(), all.end(), [&](const Plane& plane) {
          return glm::dot(plane.normal, *corner) <= plane.distance + slack;
        });
        if (!inside) continue;
        if (at_far) return std::nullopt;
        corners.push_back(*corner);
      }
    }
  }
  if (corners.size() < 4) return std::nullopt;
  for (const Plane& plane : planes) {
    // Flat solids have all corners on one plane.
    const bool flat = std::all_of(corners.begin(), corners.end(), [&](const Vec3d& corner) {
      return std::abs(glm::dot(plane.normal, corner) - plane.distance) <= 2.0 * tolerance;
    });
    if (flat) return std::nullopt;
  }
  return corners;
}

}  // namespace abbe
