/// Normals of GGX microfacets, glTF's model of rough surfaces. What they let by is in
/// microfacet-inl.h.
#pragma once

#include <algorithm>
#include <cmath>

#include "abbe/base/constants.h"
#include "abbe/math/vec.h"

namespace abbe {

/// A microfacet normal among those visible from `view`, about the z axis, of microfacets as rough
/// along x and along y as `alpha` has it.
/// Domain: view of unit length with view.z > 0; alpha in (0, 1]²; u in [0, 1)².
/// Source: Heitz, Sampling the GGX Distribution of Visible Normals, JCGT 7(4), 2018.
inline Vec3f sample_visible_normal(const Vec3f& view, const Vec2f& alpha, const Vec2f& u) {
  const Vec3f stretched = glm::normalize(Vec3f(alpha.x * view.x, alpha.y * view.y, view.z));
  const float length2 = stretched.x * stretched.x + stretched.y * stretched.y;
  const Vec3f t1 = length2 > 0.0f ? Vec3f(-stretched.y, stretched.x, 0.0f) / std::sqrt(length2)
                                  : Vec3f(1.0f, 0.0f, 0.0f);
  const Vec3f t2 = glm::cross(stretched, t1);
  const float r = std::sqrt(u.x);
  const float phi = 2.0f * static_cast<float>(kPi) * u.y;
  const float p1 = r * std::cos(phi);
  const float s = 0.5f * (1.0f + stretched.z);
  const float p2 = (1.0f - s) * std::sqrt(1.0f - p1 * p1) + s * r * std::sin(phi);
  const Vec3f on_disk =
      p1 * t1 + p2 * t2 + std::sqrt(std::max(0.0f, 1.0f - p1 * p1 - p2 * p2)) * stretched;
  return glm::normalize(
      Vec3f(alpha.x * on_disk.x, alpha.y * on_disk.y, std::max(1e-6f, on_disk.z)));
}
inline Vec3f sample_visible_normal(const Vec3f& view, float alpha, const Vec2f& u) {
  return sample_visible_normal(view, Vec2f(alpha), u);
}

}  // namespace abbe
