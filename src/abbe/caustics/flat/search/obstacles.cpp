#include "abbe/caustics/flat/search/obstacles.h"

#include <algorithm>

namespace abbe {
Obstacles::Obstacles(const Scene& scene, const FlatBodies& flat) : flat_(flat) {
  for (const Instance& instance : scene.instances) boxes_.push_back(bounds_of(scene, instance));
}

void Obstacles::mark(std::vector<ChainStep>& steps) {
  for (std::size_t s = 1; s < steps.size(); ++s) {
    if (!steps[s].is_checked) continue;
    const auto [low, high] = std::minmax(steps[s - 1].facet, steps[s].facet);
    const auto [entry, is_new] = known_.try_emplace((std::uint64_t{low} << 32u) | high, true);
    if (is_new) entry->second = may_stand_between(low, high);
    steps[s].is_checked = entry->second;
  }
}

bool Obstacles::may_stand_between(std::uint32_t facet, std::uint32_t other) {
  Box3d hull;
  for (const std::uint32_t first : {facet, other}) {
    // With what follows of its face.
    const Facet& plane = flat_.facets[first];
    for (std::size_t f = first; f < flat_.facets.size(); ++f) {
      const Facet& piece = flat_.facets[f];
      if (piece.body != plane.body || piece.normal != plane.normal) break;
      for (const Vec3d& corner : piece.corners) hull.extend({corner, corner});
    }
  }
  const FlatBody& body = flat_.bodies[flat_.facets[facet].body];
  const FlatBody& other_body = flat_.bodies[flat_.facets[other].body];
  for (std::uint32_t i = 0; i < boxes_.size(); ++i) {
    // A ray that leaves a convex body does not come back to it.
    if (body.is_convex && i == body.instance) continue;
    if (other_body.is_convex && i == other_body.instance) continue;
    if (!are_apart(boxes_[i], hull)) return true;
  }
  return false;
}

}  // namespace abbe
