#include "abbe/accel/leaf/solids.h"

#include <cmath>

#include "abbe/accel/leaf/isolated_solids.h"

namespace abbe {
SolidStore::SolidStore(const ShapeSpans& shapes)
    : ellipsoids_(shapes.ellipsoids.begin(), shapes.ellipsoids.end()),
      polyhedra_(shapes.polyhedra.begin(), shapes.polyhedra.end()),
      planes_(shapes.planes.begin(), shapes.planes.end()),
      isolated_(find_isolated_solids(shapes)),
      triangle_count_(static_cast<std::uint32_t>(shapes.triangles.size())) {}

SolidView SolidStore::view() const {
  return {ellipsoids_.data(), polyhedra_.data(),
          planes_.data(),     isolated_.data(),
          triangle_count_,    triangle_count_ + static_cast<std::uint32_t>(ellipsoids_.size())};
}

std::size_t SolidStore::bytes() const {
  return ellipsoids_.size() * sizeof(Ellipsoid) + polyhedra_.size() * sizeof(ConvexPolyhedron) +
         planes_.size() * sizeof(Plane);
}

std::optional<SolidCrossings> intersect_ellipsoid(const Ray& ray, const Ellipsoid& ellipsoid) {
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
  return SolidCrossings{std::fmin(near, far), std::fmax(near, far)};
}

std::optional<SolidCrossings> intersect_polyhedron(const Ray& ray, std::span<const Plane> planes) {
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
  return SolidCrossings{enter, leave, enter_face, leave_face};
}

}  // namespace abbe
