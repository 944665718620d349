#include "abbe/caustics/flat/point_chain.h"

#include <algorithm>
#include <limits>

namespace abbe {

double FaceFrame::distance_inside(const Vec2d& at_m) const {
  double best = -std::numeric_limits<double>::infinity();
  for (const std::vector<Vec3f>& edges : pieces) {
    double least = std::numeric_limits<double>::infinity();
    for (const Vec3f& edge : edges) {
      least =
          std::min(least, static_cast<double>(edge.x) * at_m.x +
                              static_cast<double>(edge.y) * at_m.y + static_cast<double>(edge.z));
    }
    best = std::max(best, least);
  }
  return best;
}

void set_start(PointChain& chain) {
  const UnfoldedFace& face = chain.faces[chain.crossings[0]];
  const Vec3d offset = chain.lamp - face.origin;
  const Vec2d below(glm::dot(face.u, offset), glm::dot(face.v, offset));
  chain.start = glm::distance(below, face.center) <= face.radius_m ? below : Vec2d(0.0);
  chain.start_place = on_face(face, chain.start);
}

}  // namespace abbe
