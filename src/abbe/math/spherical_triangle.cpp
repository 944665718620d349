#include "abbe/math/spherical_triangle.h"

#include <algorithm>
#include <cmath>

#include "abbe/base/constants.h"

namespace abbe {
namespace {

// The angle between the great circles with these poles; either may be of any length.
double angle_between(const Vec3d& a, const Vec3d& b) {
  return std::atan2(glm::length(glm::cross(a, b)), glm::dot(a, b));
}

Vec3d unit_across(const Vec3d& v, const Vec3d& axis) {
  const Vec3d across = v - glm::dot(v, axis) * axis;
  const double length = glm::length(across);
  return length > 0.0 ? across / length : Vec3d(0.0);
}

}  // namespace

double solid_angle(const Vec3d& a, const Vec3d& b, const Vec3d& c) {
  const double la = glm::length(a), lb = glm::length(b), lc = glm::length(c);
  const double volume = std::abs(glm::dot(a, glm::cross(b, c)));
  const double sum = la * lb * lc + glm::dot(a, b) * lc + glm::dot(a, c) * lb + glm::dot(b, c) * la;
  return 2.0 * std::atan2(volume, sum);
}

Vec3d direction_to_triangle(const Vec3d& corner_a, const Vec3d& corner_b, const Vec3d& corner_c,
                            const Vec2d& u) {
  const Vec3d a = glm::normalize(corner_a), b = glm::normalize(corner_b),
              c = glm::normalize(corner_c);
  const Vec3d ab = glm::cross(a, b), bc = glm::cross(b, c), ca = glm::cross(c, a);
  const double alpha = angle_between(ab, -ca);
  const double beta = angle_between(bc, -ab);
  const double gamma = angle_between(ca, -bc);
  // The part of the triangle at the side ab whose area is u.x of it ends at a corner c' on ca.
  const double area = u.x * (alpha + beta + gamma - kPi);
  const double cos_alpha = std::cos(alpha), sin_alpha = std::sin(alpha);
  const double cos_phi = std::cos(area - alpha), sin_phi = std::sin(area - alpha);
  const double k1 = cos_phi - cos_alpha;
  const double k2 = sin_phi + sin_alpha * glm::dot(a, b);
  const double divisor = (k2 * sin_phi + k1 * cos_phi) * sin_alpha;
  double cos_b = 1.0;
  if (divisor != 0.0) {
    cos_b = std::clamp(((k2 * cos_phi - k1 * sin_phi) * cos_alpha - k2) / divisor, -1.0, 1.0);
  }
  const double sin_b = std::sqrt(std::max(0.0, 1.0 - cos_b * cos_b));
  const Vec3d c_part = cos_b * a + sin_b * unit_across(c, a);
  const double cos_theta = 1.0 - u.y * (1.0 - glm::dot(c_part, b));
  const double sin_theta = std::sqrt(std::max(0.0, 1.0 - cos_theta * cos_theta));
  return glm::normalize(cos_theta * b + sin_theta * unit_across(c_part, b));
}

}  // namespace abbe
