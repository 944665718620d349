#include "abbe/world/light/lights.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "abbe/base/constants.h"
#include "abbe/world/light/lights-inl.h"

namespace abbe {
namespace {

Vec3d position_of(const Light& light) {
  return Vec3d(light.to_world[3]);
}

void shape_spot(const Light& source, WorldLight& light) {
  const double cos_outer = std::cos(source.outer_cone_rad);
  const double scale = 1.0 / std::max(0.001, std::cos(source.inner_cone_rad) - cos_outer);
  light.is_spot = true;
  light.spot_scale = static_cast<float>(scale);
  light.spot_offset = static_cast<float>(-cos_outer * scale);
}

}  // namespace

LightKind kind_of(const Light& light) {
  switch (light.type) {
    case LightType::Point:
      return {.name = "point", .intensity = "intensity_cd", .has_position = true};
    case LightType::Spot:
      return {.name = "spot",
              .intensity = "intensity_cd",
              .has_position = true,
              .has_direction = true,
              .has_cone = true};
    case LightType::Directional:
      break;
  }
  return {.name = "directional", .intensity = "illuminance_lx", .has_direction = true};
}

std::vector<WorldLight> tabulate_lights(const Scene& scene, const LaneModel& lanes, Rows& rows) {
  std::vector<WorldLight> lights;
  for (const Light& source : scene.lights) {
    WorldLight light;
    light.name = source.name;
    light.position = Vec3f(position_of(source));
    light.direction = Vec3f(direction_of(source));
    light.is_parallel = is_parallel(source);
    if (source.beam) {
      light.beam = BeamWindow{Vec3f(glm::normalize(Vec3d(source.to_world[0]))),
                              Vec3f(glm::normalize(Vec3d(source.to_world[1]))),
                              static_cast<float>(0.5 * source.beam->width_m),
                              static_cast<float>(0.5 * source.beam->height_m)};
    }
    if (source.shape) {
      light.extent = LampExtent{*source.shape, Vec3f(glm::normalize(Vec3d(source.to_world[0]))),
                                Vec3f(glm::normalize(Vec3d(source.to_world[1])))};
    }
    if (std::isfinite(source.range_m) && source.range_m > 0.0) {
      light.range_m = static_cast<float>(source.range_m);
    }
    if (source.type == LightType::Spot) shape_spot(source, light);
    light.row = rows.add(source.spectrum
                             ? lanes.emission(source.spectrum->spectrum, source.intensity)
                             : lanes.emission(RgbRec709{source.color_rec709 * source.intensity}));
    lights.push_back(std::move(light));
  }
  return lights;
}

RaySegment segment_in_cone(const WorldLight& light, const Vec3f& origin, const Vec3f& direction,
                           float end_m) {
  // cos θ · spot_scale + spot_offset is positive inside.
  const float cosine = std::clamp(-light.spot_offset / light.spot_scale, 0.0f, 1.0f);
  const Vec3f from_tip = origin - light.position;
  const float slope = glm::dot(direction, light.direction);
  const float height = glm::dot(from_tip, light.direction);
  const float c2 = cosine * cosine;
  // Inside both cones of the tip where a t² + 2 b t + c ≥ 0; of these the lit one lies ahead.
  const float a = slope * slope - c2;
  const float b = slope * height - c2 * glm::dot(direction, from_tip);
  const float c = height * height - c2 * glm::dot(from_tip, from_tip);
  const float discriminant = b * b - a * c;
  const RaySegment all{0.0f, end_m};
  if (discriminant < 0.0f) return a > 0.0f && height > 0.0f ? all : RaySegment{};
  if (a == 0.0f) {
    // Along the surface of the cone: one crossing.
    if (b == 0.0f) return height > 0.0f && c >= 0.0f ? all : RaySegment{};
    const float t = -0.5f * c / b;
    return slope > 0.0f ? RaySegment{std::max(0.0f, t), end_m}
                        : RaySegment{0.0f, std::min(t, end_m)};
  }
  const float root = std::sqrt(discriminant);
  const float q = b > 0.0f ? -(b + root) : root - b;
  float near = q / a;
  float far = q != 0.0f ? c / q : near;
  if (near > far) std::swap(near, far);
  if (a > 0.0f) {
    return slope > 0.0f ? RaySegment{std::max(0.0f, far), end_m}
                        : RaySegment{0.0f, std::min(near, end_m)};
  }
  const bool ahead = height + 0.5f * (near + far) * slope > 0.0f;
  return ahead ? RaySegment{std::max(0.0f, near), std::min(far, end_m)} : RaySegment{};
}

double lamp_window(const WorldLight& light, double distance_m, double cosine) {
  namespace lanes = HWY_NAMESPACE;
  const hwy::HWY_NAMESPACE::CappedTag<double, 1> d;
  using hwy::HWY_NAMESPACE::Set;
  return hwy::HWY_NAMESPACE::GetLane(
      lanes::WindowFromMiddle(d, light, Set(d, distance_m), Set(d, cosine)));
}

std::optional<StraightPath> straight_path(const WorldLight& light, const Vec3d& place) {
  StraightPath path;
  const Vec3d off = place - Vec3d(light.position);
  if (light.is_parallel) {
    path = {place, Vec3d(light.direction), std::numeric_limits<double>::infinity(), 1.0};
    if (!light.beam) return path;
    const auto is_within = [&](const Vec3f& axis, float half_m) {
      return std::abs(glm::dot(off, Vec3d(axis))) <= static_cast<double>(half_m);
    };
    path.length_m = glm::dot(off, path.direction);
    path.start = place - path.length_m * path.direction;
    const bool is_lit = path.length_m >= 0.0 && is_within(light.beam->x, light.beam->half_x_m) &&
                        is_within(light.beam->y, light.beam->half_y_m);
    return is_lit ? std::optional(path) : std::nullopt;
  }
  path.start = Vec3d(light.position);
  path.length_m = glm::length(off);
  if (!(path.length_m > 0.0)) return std::nullopt;
  path.direction = off / path.length_m;
  const double cosine = glm::dot(path.direction, Vec3d(light.direction));
  path.irradiance = lamp_window(light, path.length_m, cosine) / (path.length_m * path.length_m);
  return path.irradiance > 0.0 ? std::optional(path) : std::nullopt;
}

Vec3d direction_of(const Light& light) {
  return glm::normalize(Vec3d(light.to_world * Vec4d(0.0, 0.0, -1.0, 0.0)));
}

bool is_parallel(const Light& light) {
  return light.type == LightType::Directional;
}

std::vector<HalfSpace> beam_bounds(const Light& light) {
  if (!light.beam) return {};
  const Vec3d origin = position_of(light);
  const Vec3d direction = direction_of(light);
  std::vector<HalfSpace> bounds{{-direction, -glm::dot(direction, origin)}};
  for (const int axis : {0, 1}) {
    const Vec3d across = glm::normalize(Vec3d(light.to_world[axis]));
    const double half_m = 0.5 * (axis == 0 ? light.beam->width_m : light.beam->height_m);
    bounds.push_back({across, glm::dot(across, origin) + half_m});
    bounds.push_back({-across, -glm::dot(across, origin) + half_m});
  }
  return bounds;
}

std::vector<HalfSpace> spot_bounds(const Light& light) {
  constexpr double kWidest_rad = 1.2;
  if (light.type != LightType::Spot || light.outer_cone_rad > kWidest_rad) return {};
  const Vec3d apex = position_of(light);
  const Vec3d axis = direction_of(light);
  const Vec3d u = glm::normalize(
      glm::cross(axis, std::abs(axis.x) < 0.6 ? Vec3d(1.0, 0.0, 0.0) : Vec3d(0.0, 1.0, 0.0)));
  const Vec3d v = glm::cross(axis, u);
  const double wide_rad = light.outer_cone_rad * (1.0 + 1e-6) + 1e-9;
  std::vector<HalfSpace> bounds;
  for (int side = 0; side < 8; ++side) {
    const double turn = 0.25 * kPi * side;
    const Vec3d across = std::cos(turn) * u + std::sin(turn) * v;
    const Vec3d normal = std::cos(wide_rad) * across - std::sin(wide_rad) * axis;
    bounds.push_back({normal, glm::dot(normal, apex)});
  }
  return bounds;
}

bool may_shine_on(const Light& light, const Vec3d& center, double radius_m, const Vec3d& axis,
                  double angle_rad) {
  if (std::isfinite(light.range_m) && light.range_m > 0.0 &&
      glm::distance(center, position_of(light)) - radius_m > light.range_m) {
    return false;
  }
  if (light.type != LightType::Spot) return true;
  const double off = std::acos(std::clamp(glm::dot(axis, direction_of(light)), -1.0, 1.0));
  return off <= light.outer_cone_rad + angle_rad + 1e-6;
}

}  // namespace abbe
