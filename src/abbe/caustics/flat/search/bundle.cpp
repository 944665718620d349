#include "abbe/caustics/flat/search/bundle.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace abbe {

void BundleSet::bound() {
  Vec3d low(std::numeric_limits<double>::infinity());
  Vec3d high = -low;
  Vec3d sum(0.0);
  for (const Bundle& bundle : bundles) {
    for (const Vec3d& corner : bundle.polygon) {
      low = glm::min(low, corner);
      high = glm::max(high, corner);
    }
    if (!bundle.polygon.empty()) sum += bundle.direction;
  }
  radius_m = 0.0;
  if (!(glm::length(sum) > 0.0)) return;
  center = 0.5 * (low + high);
  axis = glm::normalize(sum);
  double cosine = 1.0;
  for (const Bundle& bundle : bundles) {
    if (bundle.polygon.empty()) continue;
    cosine = std::min(cosine, glm::dot(axis, bundle.direction));
    for (const Vec3d& corner : bundle.polygon) {
      radius_m = std::max(radius_m, glm::distance(corner, center));
    }
  }
  // Wider than 84°: a cone is no help.
  tan_spread = cosine > 0.1 ? std::sqrt(std::max(0.0, 1.0 - cosine * cosine)) / cosine : 1e30;
}

bool BundleSet::may_meet(const Facet& facet) const {
  if (tan_spread > 1e29) return true;
  const Vec3d v = facet.center - center;
  const double along = glm::dot(v, axis);
  const double reach = radius_m + facet.radius_m;
  if (along < -reach) return false;
  const double across = std::sqrt(std::max(0.0, glm::dot(v, v) - along * along));
  return across <= reach * (1.0 + tan_spread) + std::max(along, 0.0) * tan_spread;
}

}  // namespace abbe
