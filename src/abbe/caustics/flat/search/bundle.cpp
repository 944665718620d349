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

}  // namespace abbe
