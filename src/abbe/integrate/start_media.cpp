#include "abbe/integrate/start_media.h"

#include <algorithm>
#include <cmath>
#include <span>
#include <vector>

#include "abbe/accel/query.h"
#include "abbe/integrate/surface/point.h"
#include "abbe/math/ray.h"

namespace abbe {

MediumStack start_media(const World& world, const Vec3f& place, const Vec3f& direction) {
  const auto holds = [&](const Box3f& box) {
    return glm::all(glm::lessThanEqual(box.low, place)) &&
           glm::all(glm::lessThanEqual(place, box.high));
  };
  MediumStack start;
  if (!holds(world.media_bounds)) return start;
  if (std::none_of(world.medium_boxes.begin(), world.medium_boxes.end(), holds)) return start;
  const Ray ray{place, kInfinity, direction};
  HitLists hits;
  world.accelerator->all_hits(std::span(&ray, 1), kTransparentBit | kExactGlassBit, 0, hits);
  MediumStack media;
  std::vector<std::uint32_t> left;  // Innermost first.
  const float reach_m = std::max({std::abs(place.x), std::abs(place.y), std::abs(place.z)});
  std::uint32_t last_surface = kNoPrimitive;
  bool last_front = false;
  float last_t = 0.0f;
  for (const Hit& hit : hits[0]) {
    const SurfacePoint point = surface_point(world, place, direction, hit);
    const std::uint32_t number = world.geometry.surfaces[point.surface].material;
    const bool front = glm::dot(direction, point.normal) < 0.0f;
    const SurfaceMaterial& material = world.materials[number];
    if (material.transmission != Transmission::Medium) continue;
    // Through the edge of two triangles a ray meets one face twice.
    const bool is_same = point.surface == last_surface && front == last_front;
    if (is_same && hit.t - last_t <= 4e-7f * (hit.t + reach_m)) continue;
    last_surface = point.surface;
    last_front = front;
    last_t = hit.t;
    if (!front && !media.contains(number)) left.push_back(number);
    const MetFace face{number, material.priority, front};
    media = cross(media, material.transmission, {&face, 1}).behind;
  }
  for (std::size_t i = left.size(); i-- > 0;) {
    start.push(left[i], world.materials[left[i]].priority);
  }
  return start;
}

}  // namespace abbe
