#include "abbe/world/light/lamp_shape.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <variant>

#include "abbe/base/constants.h"
#include "abbe/math/spherical_triangle.h"

namespace abbe {
namespace {

// A place above a flat lamp sees it by its two triangles.
std::optional<LampSpot> on_rectangle(const RectangleLamp& lamp, const LampExtent& extent,
                                     const Vec3f& middle, const Vec3f& direction, const Vec3f& from,
                                     const Vec2f& u) {
  const Vec3d way = Vec3d(middle) - Vec3d(from);
  const double height = -glm::dot(Vec3d(direction), way);
  if (!(height > 0.0)) return std::nullopt;
  const Vec3d x = 0.5 * lamp.width_m * Vec3d(extent.x), y = 0.5 * lamp.height_m * Vec3d(extent.y);
  const std::array<Vec3d, 4> corners{way - x - y, way + x - y, way + x + y, way - x + y};
  const double area = lamp.width_m * lamp.height_m;
  LampSpot spot;
  spot.normal = direction;
  spot.radiance = static_cast<float>(1.0 / area);
  const double first = solid_angle(corners[0], corners[1], corners[2]);
  const double all = first + solid_angle(corners[0], corners[2], corners[3]);
  if (all < kLeastSolidAngle_sr) {
    const Vec3d at = Vec3d(middle) + (2.0 * static_cast<double>(u.x) - 1.0) * x +
                     (2.0 * static_cast<double>(u.y) - 1.0) * y;
    spot.position = Vec3f(at);
    spot.per_m2 = static_cast<float>(1.0 / area);
    return spot;
  }
  // What is left of a number that has decided between two parts is a number again.
  double left = static_cast<double>(u.x) * all;
  Vec3d to_lamp;
  if (left < first) {
    to_lamp = direction_to_triangle(corners[0], corners[1], corners[2],
                                    {left / first, static_cast<double>(u.y)});
  } else {
    left = std::min((left - first) / (all - first), 1.0);
    to_lamp =
        direction_to_triangle(corners[0], corners[2], corners[3], {left, static_cast<double>(u.y)});
  }
  const double cosine = -glm::dot(to_lamp, Vec3d(direction));
  if (!(cosine > 0.0)) return std::nullopt;
  const double distance = height / cosine;
  spot.position = Vec3f(Vec3d(from) + distance * to_lamp);
  spot.per_m2 = static_cast<float>(cosine / (distance * distance * all));
  return spot;
}

std::optional<LampSpot> on_disk(const DiskLamp& lamp, const LampExtent& extent, const Vec3f& middle,
                                const Vec3f& direction, const Vec3f& from, const Vec2f& u) {
  if (!(glm::dot(direction, from - middle) > 0.0f)) return std::nullopt;
  const double radius = lamp.radius_m * std::sqrt(static_cast<double>(u.x));
  const double turn = 2.0 * kPi * static_cast<double>(u.y);
  LampSpot spot;
  spot.position = middle + static_cast<float>(radius * std::cos(turn)) * extent.x +
                  static_cast<float>(radius * std::sin(turn)) * extent.y;
  spot.normal = direction;
  spot.per_m2 = spot.radiance = static_cast<float>(1.0 / (kPi * lamp.radius_m * lamp.radius_m));
  return spot;
}

// Unit vectors across an axis.
std::array<Vec3d, 2> across(const Vec3d& axis) {
  const Vec3d off = std::abs(axis.x) < 0.5 ? Vec3d(1.0, 0.0, 0.0) : Vec3d(0.0, 1.0, 0.0);
  const Vec3d x = glm::normalize(glm::cross(axis, off));
  return {x, glm::cross(axis, x)};
}

// A direction about an axis, evenly by solid angle up to 1 − `depth` of its cosine.
Vec3d in_cone(const Vec3d& axis, double depth, const Vec2f& u) {
  const double off = static_cast<double>(u.x) * depth;
  const double sine = std::sqrt(std::max(0.0, off * (2.0 - off)));
  const double turn = 2.0 * kPi * static_cast<double>(u.y);
  const auto [x, y] = across(axis);
  return (1.0 - off) * axis + sine * (std::cos(turn) * x + std::sin(turn) * y);
}

std::optional<LampSpot> on_ball(const SphereLamp& lamp, const Vec3f& middle, const Vec3f& from,
                                const Vec2f& u) {
  const Vec3d way = Vec3d(middle) - Vec3d(from);
  const double distance2 = glm::dot(way, way);
  const double radius2 = lamp.radius_m * lamp.radius_m;
  if (!(distance2 > radius2)) return std::nullopt;
  const double sine2 = radius2 / distance2;
  const double depth = sine2 / (1.0 + std::sqrt(1.0 - sine2));  // 1 − cos of the half angle.
  const double distance = std::sqrt(distance2);
  const Vec3d to_lamp = in_cone(way / distance, depth, u);
  // To the near side of the ball; in the cone's last rounding its rim.
  const double along = glm::dot(to_lamp, way);
  const double half2 = std::max(0.0, radius2 - (distance2 - along * along));
  const double length = along - std::sqrt(half2);
  LampSpot spot;
  const Vec3d at = Vec3d(from) + length * to_lamp;
  const Vec3d normal = glm::normalize(at - Vec3d(middle));
  spot.position = Vec3f(at);
  spot.normal = Vec3f(normal);
  spot.radiance = static_cast<float>(1.0 / (kPi * radius2));
  const double cosine = std::max(-glm::dot(normal, to_lamp), 1e-6);
  spot.per_m2 = static_cast<float>(cosine / (length * length * 2.0 * kPi * depth));
  return spot;
}

}  // namespace

std::optional<LampSpot> spot_on_lamp(const LampExtent& extent, const Vec3f& middle,
                                     const Vec3f& direction, const Vec3f& from, const Vec2f& u) {
  if (const auto* rectangle = std::get_if<RectangleLamp>(&extent.shape)) {
    return on_rectangle(*rectangle, extent, middle, direction, from, u);
  }
  if (const auto* disk = std::get_if<DiskLamp>(&extent.shape)) {
    return on_disk(*disk, extent, middle, direction, from, u);
  }
  if (const auto* ball = std::get_if<SphereLamp>(&extent.shape)) {
    return on_ball(*ball, middle, from, u);
  }
  return std::nullopt;
}

SkyDiscRay direction_to_disc(const LampExtent& extent, const Vec3f& to_middle, const Vec2f& u) {
  const double half_rad = kPi / 360.0 * std::get<SkyDisc>(extent.shape).angle_deg;
  const double sine = std::sin(0.5 * half_rad);
  return {Vec3f(in_cone(glm::normalize(Vec3d(to_middle)), 2.0 * sine * sine, u)),
          static_cast<float>(2.0 / (1.0 + std::cos(half_rad)))};
}

}  // namespace abbe
