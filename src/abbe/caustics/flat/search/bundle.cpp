#include "abbe/caustics/flat/search/bundle.h"

#include <algorithm>
#include <cmath>

namespace abbe {

void BundleSet::bound() {
  std::vector<Vec3d> corners;
  Vec3d sum(0.0);
  for (const Bundle& bundle : bundles) {
    corners.insert(corners.end(), bundle.polygon.begin(), bundle.polygon.end());
    if (!bundle.polygon.empty()) sum += bundle.direction;
  }
  ball = {};
  if (!(glm::length(sum) > 0.0)) return;
  ball = ball_about(corners);
  axis = glm::normalize(sum);
  double cosine = 1.0;
  for (const Bundle& bundle : bundles) {
    if (!bundle.polygon.empty()) cosine = std::min(cosine, glm::dot(axis, bundle.direction));
  }
  // Wider than 84°: a cone is no help.
  tan_spread = cosine > 0.1 ? std::sqrt(std::max(0.0, 1.0 - cosine * cosine)) / cosine : 1e30;
}

bool BundleSet::may_meet(const Facet& facet) const {
  if (tan_spread > 1e29) return true;
  const Vec3d v = facet.center - ball.center;
  const double along = glm::dot(v, axis);
  const double reach = ball.radius_m + facet.radius_m;
  if (along < -reach) return false;
  const double across = std::sqrt(std::max(0.0, glm::dot(v, v) - along * along));
  return across <= reach * (1.0 + tan_spread) + std::max(along, 0.0) * tan_spread;
}

}  // namespace abbe
