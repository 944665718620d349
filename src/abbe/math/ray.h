/// Rays and boxes.
#pragma once

#include <algorithm>

#include "abbe/base/constants.h"
#include "abbe/math/vec.h"

namespace abbe {

/// The half-open segment origin + t·direction, t in (0, t_max).
/// Units:  metres when direction is a unit vector; accelerators take any finite non-zero direction.
struct Ray {
  Vec3f origin{0.0f};
  float t_max = kInfinity;
  Vec3f direction{0.0f, 0.0f, 1.0f};
};

/// An axis-aligned box; empty when any low exceeds its high.
struct Box3f {
  Vec3f low{kInfinity};
  Vec3f high{-kInfinity};

  void extend(const Vec3f& point) {
    low = glm::vec3(std::min(low.x, point.x), std::min(low.y, point.y), std::min(low.z, point.z));
    high =
        glm::vec3(std::max(high.x, point.x), std::max(high.y, point.y), std::max(high.z, point.z));
  }
  void extend(const Box3f& other) {
    extend(other.low);
    extend(other.high);
  }
  bool is_empty() const { return low.x > high.x || low.y > high.y || low.z > high.z; }
  Vec3f center() const { return 0.5f * low + 0.5f * high; }
  Vec3f size() const { return high - low; }
};

}  // namespace abbe
