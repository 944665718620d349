#include "abbe/caustics/flat/search/obstacles.h"

#include <algorithm>
#include <cmath>

namespace abbe {
namespace {

// Rounding errors of places on facets, as a share of their coordinates: a few of single precision.
constexpr double kRounding = 1e-6;

}  // namespace

Obstacles::Obstacles(const Scene& scene, const FlatBodies& flat)
    : flat_(flat), is_glass_(scene.instances.size(), false) {
  for (const Instance& instance : scene.instances) boxes_.push_back(bounds_of(scene, instance));
  for (const FlatBody& body : flat.bodies) is_glass_[body.instance] = !body.is_mirror;
}

void Obstacles::mark(ChainPath& chain) {
  double reach_m = glm::length(Vec3d(chain.origin));
  for (std::size_t s = 0; s < chain.steps.size(); ++s) {
    ChainStep& step = chain.steps[s];
    const Facet& facet = flat_.facets[step.facet];
    reach_m = std::max(reach_m, glm::distance(facet.center, Vec3d(chain.origin)) + facet.radius_m);
    step.is_touched = step.event != ChainEvent::ReflectInside &&
                      !flat_.bodies[facet.body].is_mirror && may_be_touched(step.facet);
    if (s == 0 || !step.is_checked) continue;
    const auto [low, high] = std::minmax(chain.steps[s - 1].facet, step.facet);
    const auto [entry, is_new] = known_.try_emplace((std::uint64_t{low} << 32u) | high, true);
    if (is_new) entry->second = may_stand_between(low, high);
    step.is_checked = entry->second;
  }
  chain.slack_m = static_cast<float>(kRounding * reach_m);
}

Box3d Obstacles::box_of_face(std::uint32_t facet) const {
  Box3d box;
  const Facet& plane = flat_.facets[facet];
  for (std::size_t f = facet; f < flat_.facets.size(); ++f) {
    const Facet& piece = flat_.facets[f];
    if (piece.body != plane.body || piece.normal != plane.normal) break;
    for (const Vec3d& corner : piece.corners) box.extend({corner, corner});
  }
  return box;
}

bool Obstacles::may_be_touched(std::uint32_t facet) {
  const auto [entry, is_new] = known_touched_.try_emplace(facet, false);
  if (!is_new) return entry->second;
  Box3d box = box_of_face(facet);
  // As far as a chain's rounding errors may reach.
  const Vec3d far = glm::max(glm::abs(box.low), glm::abs(box.high));
  const double near_m = 8.0 * kRounding * (far.x + far.y + far.z);
  box.low -= near_m;
  box.high += near_m;
  for (std::uint32_t i = 0; i < boxes_.size() && !entry->second; ++i) {
    entry->second = !is_glass_[i] && !are_apart(boxes_[i], box);
  }
  return entry->second;
}

bool Obstacles::may_stand_between(std::uint32_t facet, std::uint32_t other) {
  Box3d hull = box_of_face(facet);
  hull.extend(box_of_face(other));
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
