#include "abbe/integrate/start_media.h"

#include <algorithm>
#include <span>
#include <vector>

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
  for (const Hit& hit : hits[0]) {
    const SurfacePoint point = surface_point(world, place, direction, hit);
    const std::uint32_t number = world.geometry.surfaces[point.surface].material;
    const bool front = glm::dot(direction, point.normal) < 0.0f;
    const MediumChange change = cross(media, number, world.materials[number].transmission, front);
    if (change.crossing == Crossing::Leave && !media.contains(number)) left.push_back(number);
    media = change.behind;
  }
  for (std::size_t i = left.size(); i-- > 0;) start.push(left[i]);
  return start;
}

}  // namespace abbe
