#include "abbe/caustics/flat/search/beam_cone.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "abbe/base/constants.h"
#include "abbe/optics/snell.h"

namespace abbe {
namespace {

constexpr double kInfinite = std::numeric_limits<double>::infinity();
constexpr double kRightAngle = 0.5 * kPi;

double angle_between(const Vec3d& a, const Vec3d& b) {
  return std::atan2(glm::length(glm::cross(a, b)), glm::dot(a, b));
}

double refracted_angle(double angle_rad, double eta_ti) {
  return std::asin(std::min(1.0, std::sin(angle_rad) / eta_ti));
}

}  // namespace

BeamCone crossing(const BeamCone& cone, const Vec3d& normal) {
  constexpr double kLeast = 1e-6;
  const double along = glm::dot(cone.axis, normal);
  if (along >= kLeast) return cone;
  BeamCone result = cone;
  if (cone.angle_rad >= kRightAngle) {
    result.axis = normal;
    result.angle_rad = kRightAngle;
    return result;
  }
  // An axis that is turned to the nearest direction of the half space is nearer to all of that.
  result.axis = glm::normalize(cone.axis + (kLeast - along) * normal);
  result.angle_rad += kLeast;
  return result;
}

AngleRange angles_with(const BeamCone& cone, const Vec3d& normal) {
  const double angle = angle_between(cone.axis, normal);
  const double acute = std::min(angle, kPi - angle);
  return {std::max(0.0, acute - cone.angle_rad), std::min(kRightAngle, acute + cone.angle_rad)};
}

std::optional<BeamCone> refracted_cone(const BeamCone& cone, const Vec3d& normal, double eta_ti_low,
                                       double eta_ti_high) {
  const AngleRange before = angles_with(cone, normal);
  if (std::sin(before.low_rad) >= eta_ti_high) return std::nullopt;
  BeamCone after = cone;
  const double eta_middle = 0.5 * (eta_ti_low + eta_ti_high);
  if (eta_ti_low >= 1.0) {
    // Refraction into a denser medium brings directions closer by 1/eta at least: the derivatives
    // of the angle are cosθ_i/(eta·cosθ_t) and, across the plane of incidence, 1/eta.
    after.axis = *refracted_direction(cone.axis, normal, eta_middle);
    double spread = 0.0;
    for (const double eta : {eta_ti_low, eta_ti_high}) {
      spread =
          std::max(spread, angle_between(after.axis, *refracted_direction(cone.axis, normal, eta)));
    }
    after.angle_rad = cone.angle_rad / eta_ti_low + spread;
    return after;
  }
  const Vec3d facing = glm::dot(cone.axis, normal) > 0.0 ? normal : -normal;
  const double low = refracted_angle(before.low_rad, eta_ti_high);
  const double high = refracted_angle(before.high_rad, eta_ti_low);
  const double acute = angle_between(cone.axis, facing);
  const Vec3d along = cone.axis - glm::dot(cone.axis, facing) * facing;
  const double sine = glm::length(along);
  if (acute <= cone.angle_rad || !(sine > 0.0)) {
    after.axis = facing;
    after.angle_rad = high;
    return after;
  }
  // In angles from the normal and about it the directions fill less than a rectangle; the distance
  // from its middle to a corner follows from the haversine of two sides and the angle between.
  const double middle = 0.5 * (low + high);
  const double half = 0.5 * (high - low);
  const double about = std::asin(std::min(1.0, std::sin(cone.angle_rad) / sine));
  const double half_sine = std::sin(0.5 * half);
  const double across = std::sin(0.5 * about) * std::sin(high);
  after.axis = std::cos(middle) * facing + (std::sin(middle) / sine) * along;
  after.angle_rad =
      2.0 * std::asin(std::min(1.0, std::sqrt(half_sine * half_sine + across * across)));
  return after;
}

std::optional<ConeSection> plane_section(const BeamCone& cone, const Vec3d& normal,
                                         double distance) {
  const double height = distance - glm::dot(normal, cone.center);
  if (height < -cone.radius_m) return std::nullopt;
  const double angle = angle_between(cone.axis, normal);
  const double steepest = angle + cone.angle_rad;
  const double slope = std::tan(std::min(angle, kRightAngle - 1e-9));
  ConeSection result;
  if (steepest >= kRightAngle - 1e-3) {
    result.center = cone.center;
    result.radius_m = kInfinite;
    return result;
  }
  const double most = std::tan(steepest);
  const double far = std::max(height, 0.0);
  result.center = cone.center + (far / std::cos(angle)) * cone.axis;
  result.radius_m = cone.radius_m * (1.0 + most) + far * (most - slope);
  return result;
}

double largest_slope(const BeamCone& cone, const Vec3d& u, const Vec3d& n) {
  // All of the cone lies in (u − s·n)·d ≤ 0 where s·(n·a) − u·a ≥ √(1 + s²)·sin(angle): from a
  // root on for cones that leave the plane steeply, between two roots for those that cross it.
  const double along = glm::dot(n, cone.axis);
  const double across = glm::dot(u, cone.axis);
  const double sine = std::sin(std::min(cone.angle_rad, kRightAngle));
  const double square = along * along - sine * sine;
  const double rest = along * along + across * across - sine * sine;
  const bool is_steep = square > 0.0 && along > 0.0;
  if (cone.angle_rad >= kRightAngle || std::abs(square) <= 1e-6) return kInfinite;
  if (!is_steep && rest <= 0.0) return kInfinite;
  const double slope = (along * across + sine * std::sqrt(std::max(0.0, rest))) / square;
  return is_steep || slope * along - across > 0.0 ? slope : kInfinite;
}

}  // namespace abbe
