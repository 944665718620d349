#include "abbe/accel/leaf/solids.h"

#include <cmath>

namespace abbe {
namespace {

// The answer is a float: what rounds to 0 or to t_max is outside the open segment.
bool is_inside(double t, float t_max) {
  const auto rounded = static_cast<float>(t);
  return rounded > 0.0f && rounded < t_max;
}

}  // namespace

std::optional<SolidHit> intersect_ellipsoid(const Ray& ray, const Ellipsoid& ellipsoid) {
  const Vec3d o =
      ellipsoid.world_to_unit_linear * Vec3d(ray.origin) + ellipsoid.world_to_unit_offset;
  const Vec3d d = ellipsoid.world_to_unit_linear * Vec3d(ray.direction);
  const double dd = glm::dot(d, d);
  const double closest = -glm::dot(o, d) / dd;
  // From the closest point instead of b² − ac: no cancellation from far away.
  const Vec3d p = o + closest * d;
  const double inside = 1.0 - glm::dot(p, p);
  if (!(inside >= 0.0)) return std::nullopt;
  const double half_chord = std::sqrt(inside / dd);
  const double c = glm::dot(o, o) - 1.0;
  // The root nearer to the origin by Vieta: both terms of the farther one have the same sign.
  const double far = closest >= 0.0 ? closest + half_chord : closest - half_chord;
  const double near = far != 0.0 ? c / (dd * far) : 0.0;
  const double first = std::fmin(near, far);
  const double second = std::fmax(near, far);
  if (is_inside(first, ray.t_max)) return SolidHit{first, 0};
  if (is_inside(second, ray.t_max)) return SolidHit{second, 0};
  return std::nullopt;
}

std::optional<SolidHit> intersect_polyhedron(const Ray& ray, std::span<const Plane> planes) {
  const Vec3d o(ray.origin);
  const Vec3d d(ray.direction);
  // Distances are compared as fractions, so that only two are divided.
  double enter_distance = -1.0, enter_slope = 0.0;
  double leave_distance = 1.0, leave_slope = 0.0;
  std::uint32_t enter_face = 0;
  std::uint32_t leave_face = 0;
  for (std::uint32_t i = 0; i < planes.size(); ++i) {
    const double towards = glm::dot(planes[i].normal, d);
    const double distance = planes[i].distance - glm::dot(planes[i].normal, o);
    // Beyond the plane, and not on the way back to it.
    if (distance < 0.0 && towards >= 0.0) return std::nullopt;
    if (towards < 0.0) {
      if (-distance * enter_slope > enter_distance * -towards) {
        enter_distance = -distance;
        enter_slope = -towards;
        enter_face = i;
      }
    } else if (distance * leave_slope < leave_distance * towards) {
      leave_distance = distance;
      leave_slope = towards;
      leave_face = i;
    }
  }
  const double enter = enter_distance / enter_slope;
  const double leave = leave_distance / leave_slope;
  if (!(enter <= leave)) return std::nullopt;
  if (is_inside(enter, ray.t_max)) return SolidHit{enter, enter_face};
  if (is_inside(leave, ray.t_max)) return SolidHit{leave, leave_face};
  return std::nullopt;
}

}  // namespace abbe
