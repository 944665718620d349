#include "abbe/scene/scene.h"

#include <algorithm>
#include <cmath>

#include "abbe/scene/convex.h"

namespace abbe {
namespace {

void extend_by_transformed(Box3d& box, const Vec3d& point, const Mat4d& to_world) {
  const Vec3d p(to_world * Vec4d(point, 1.0));
  box.extend({p, p});
}

void extend_by_sphere(Box3d& box, const SphereShape& sphere, const Mat4d& to_world) {
  // The image of a ball is an ellipsoid; its half extent along an axis is the length of that row.
  const Vec3d center(to_world[3]);
  Vec3d half;
  for (int row = 0; row < 3; ++row) {
    half[row] =
        sphere.radius_m * glm::length(Vec3d(to_world[0][row], to_world[1][row], to_world[2][row]));
  }
  box.extend({center - half, center + half});
}

// The box the default camera is measured by; a unit cube for an empty scene.
struct Extent {
  Vec3d center{0.0};
  double radius_m = 1.0;
};

Extent extent_of(const Scene& scene) {
  const Box3d box = bounds_of(scene);
  if (box.is_empty()) return {};
  const double radius_m = 0.5 * glm::length(box.high - box.low);
  if (!std::isfinite(radius_m)) return {};
  return {box.center(), radius_m > 0.0 ? radius_m : 1.0};
}

// Rigid placement whose −Z axis looks along `direction`, +Y as near to up as can be.
Mat4d looking_along(const Vec3d& direction, const Vec3d& position) {
  const Vec3d z = -glm::normalize(direction);
  const Vec3d up = std::abs(z.y) > 0.999 ? Vec3d(0.0, 0.0, -1.0) : Vec3d(0.0, 1.0, 0.0);
  const Vec3d x = glm::normalize(glm::cross(up, z));
  const Vec3d y = glm::cross(z, x);
  return {Vec4d(x, 0.0), Vec4d(y, 0.0), Vec4d(z, 0.0), Vec4d(position, 1.0)};
}

}  // namespace

Box3d bounds_of(const Scene& scene, const Instance& instance) {
  Box3d box;
  if (const auto* mesh = std::get_if<std::uint32_t>(&instance.what)) {
    for (const Vec3f& position : scene.meshes[*mesh].positions) {
      extend_by_transformed(box, Vec3d(position), instance.to_world);
    }
    return box;
  }
  const Shape& shape = std::get<Shape>(instance.what);
  if (const auto* sphere = std::get_if<SphereShape>(&shape.geometry)) {
    extend_by_sphere(box, *sphere, instance.to_world);
  } else {
    for (const Vec3d& corner : corners_of(std::get<ConvexShape>(shape.geometry))) {
      extend_by_transformed(box, corner, instance.to_world);
    }
  }
  return box;
}

Box3d bounds_of(const Scene& scene) {
  Box3d box;
  for (const Instance& instance : scene.instances) box.extend(bounds_of(scene, instance));
  return box;
}

bool add_default_camera(Scene& scene) {
  if (!scene.cameras.empty()) return false;
  scene.cameras.push_back(framing_camera(scene));
  return true;
}

Camera framing_camera(const Scene& scene) {
  const Extent extent = extent_of(scene);
  Camera camera;
  camera.name = "default";
  const double yfov_rad = 0.7;
  camera.projection = PerspectiveCamera{yfov_rad};
  // The bounding ball touches the top and bottom of the picture, with a margin of 5 %; a little
  // from above and from the side, so that a box shows three of its faces.
  const double distance_m = 1.05 * extent.radius_m / std::sin(0.5 * yfov_rad);
  const Vec3d direction = glm::normalize(Vec3d(-0.35, -0.3, -1.0));
  camera.to_world = looking_along(direction, extent.center - distance_m * direction);
  return camera;
}

}  // namespace abbe
