#include "abbe/scene/local_origin.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

namespace abbe {
namespace {

// Coordinates may exceed the distances that are seen by this factor: 2 of 24 bits, 3 on a grid.
constexpr double kReach = 4.0;

// The distance of a box's farthest corner.
double farthest_m(const Box3d& box, const Vec3d& place) {
  return glm::length(glm::max(glm::abs(box.low - place), glm::abs(box.high - place)));
}

}  // namespace

void place_about_local_origin(Scene& scene, std::optional<std::size_t> camera) {
  std::vector<Box3d> boxes;
  Box3d all;
  for (const Instance& instance : scene.instances) {
    boxes.push_back(bounds_of(scene, instance));
    all.extend(boxes.back());
  }
  if (all.is_empty()) return;
  const Vec3d place = camera
                          ? glm::clamp(Vec3d(scene.cameras[*camera].to_world[3]), all.low, all.high)
                          : all.center();
  double nearest_m = std::numeric_limits<double>::infinity();
  for (const Box3d& box : boxes) {
    const double distance_m = farthest_m(box, place);
    if (distance_m > 0.0) nearest_m = std::min(nearest_m, distance_m);
  }
  if (!std::isfinite(nearest_m)) return;
  // On a grid of powers of two: subtracting it from round numbers is exact, and a scene moved along
  // with all its places by round numbers has the same numbers again.
  const double step_m = std::exp2(std::ceil(std::log2(2.0 * kReach * nearest_m)));
  const Vec3d origin = step_m * glm::round(place / step_m);
  if (origin == Vec3d(0.0)) return;
  const auto move = [&](Mat4d& to_world) { to_world[3] -= Vec4d(origin, 0.0); };
  for (Instance& instance : scene.instances) move(instance.to_world);
  for (Light& light : scene.lights) move(light.to_world);
  for (Camera& other : scene.cameras) move(other.to_world);
  scene.origin_m += origin;
}

}  // namespace abbe
