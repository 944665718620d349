#include "abbe/scene/convex.h"

#include <algorithm>
#include <cmath>

namespace abbe {
namespace {

// Sines and cosines below this are rounding of the planes' numbers.
constexpr double kParallel = 1e-9;

std::vector<Vec4d> unit_planes(const ConvexShape& shape) {
  std::vector<Vec4d> planes;
  for (const Vec4d& plane : shape.planes) {
    const double length = glm::length(Vec3d(plane));
    if (length > 0.0) planes.push_back(plane / length);
  }
  return planes;
}

}  // namespace

std::vector<Vec3d> corners_of(const ConvexShape& shape) {
  const std::vector<Vec4d> planes = unit_planes(shape);
  double size = 0.0;
  for (const Vec4d& plane : planes) size = std::max(size, std::abs(plane.w));
  const double slack = 1e-9 * size;
  std::vector<Vec3d> corners;
  for (std::size_t i = 0; i < planes.size(); ++i) {
    for (std::size_t j = i + 1; j < planes.size(); ++j) {
      const Vec3d line = glm::cross(Vec3d(planes[i]), Vec3d(planes[j]));
      for (std::size_t k = j + 1; k < planes.size(); ++k) {
        const double determinant = glm::dot(line, Vec3d(planes[k]));
        if (std::abs(determinant) < kParallel) continue;
        const Vec3d corner =
            (planes[i].w * glm::cross(Vec3d(planes[j]), Vec3d(planes[k])) +
             planes[j].w * glm::cross(Vec3d(planes[k]), Vec3d(planes[i])) + planes[k].w * line) /
            determinant;
        const bool is_inside = std::all_of(planes.begin(), planes.end(), [&](const Vec4d& plane) {
          return glm::dot(Vec3d(plane), corner) <= plane.w + slack;
        });
        if (is_inside) corners.push_back(corner);
      }
    }
  }
  return corners;
}

bool is_bounded(const ConvexShape& shape) {
  // A body is unbounded if some direction leaves through no plane. The extreme ones among such
  // directions lie in two of the planes: along the cross product of their normals.
  const std::vector<Vec4d> planes = unit_planes(shape);
  bool has_direction = false;
  for (std::size_t i = 0; i < planes.size(); ++i) {
    for (std::size_t j = i + 1; j < planes.size(); ++j) {
      const Vec3d line = glm::cross(Vec3d(planes[i]), Vec3d(planes[j]));
      if (glm::length(line) < kParallel) continue;
      has_direction = true;
      for (const double sign : {-1.0, 1.0}) {
        const bool leaves = std::any_of(planes.begin(), planes.end(), [&](const Vec4d& plane) {
          return sign * glm::dot(Vec3d(plane), glm::normalize(line)) > kParallel;
        });
        if (!leaves) return false;
      }
    }
  }
  return has_direction;
}

}  // namespace abbe
