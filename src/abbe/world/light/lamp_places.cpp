#include "abbe/world/light/lamp_places.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <numeric>
#include <variant>

#include "abbe/base/constants.h"

namespace abbe {
namespace {

// The bits of a number in reverse, as a share of 1: van der Corput's sequence.
double reversed(std::size_t number) {
  double share = 0.0;
  for (double bit = 0.5; number > 0; number >>= 1, bit *= 0.5) {
    if ((number & 1) != 0) share += bit;
  }
  return share;
}

// Place i of a square. Hammersley's set: as seen from any of its sides no two are behind each
// other, so that the edge of a shadow has as many steps as there are places.
Vec2d in_square(std::size_t i, std::size_t count) {
  const double half = 0.5 / static_cast<double>(count);
  return {static_cast<double>(i) / static_cast<double>(count) + half, reversed(i) + half};
}

Vec3d from_polar(double radius, double turn, double height) {
  const double angle_rad = 2.0 * kPi * turn;
  return {radius * std::cos(angle_rad), radius * std::sin(angle_rad), height};
}

// How far from the middle of a ball of radius 1 a share of it lies that fills the ball's disc
// evenly, seen from any side: a density that falls off as 1/√(1 − r²), which has Abel's transform
// 1, is in shells r²/√(1 − r²), and their sum up to r is (2/π)(asin r − r√(1 − r²)).
double ball_radius(double share) {
  double low = 0.0, high = 1.0;
  for (int i = 0; i < 40; ++i) {
    const double r = 0.5 * (low + high);
    const double within = 2.0 / kPi * (std::asin(r) - r * std::sqrt(1.0 - r * r));
    (within < share ? low : high) = r;
  }
  return 0.5 * (low + high);
}

// Pairs on opposite sides of the middle. Heights, turns and distances of the pairs are sets that do
// not follow each other.
std::vector<Vec3d> in_ball(std::size_t count) {
  constexpr double kGolden = 0.6180339887498949, kPlastic = 0.7548776662466927;
  const std::size_t pairs = count / 2;
  std::vector<std::size_t> by_distance(pairs);
  std::iota(by_distance.begin(), by_distance.end(), std::size_t{0});
  const auto key = [&](std::size_t pair) {
    const double times = (static_cast<double>(pair) + 0.5) * kPlastic;
    return times - std::floor(times);
  };
  std::sort(by_distance.begin(), by_distance.end(),
            [&](std::size_t a, std::size_t b) { return key(a) < key(b); });
  std::vector<Vec3d> places(count);
  for (std::size_t rank = 0; rank < pairs; ++rank) {
    const std::size_t pair = by_distance[rank];
    const double height = (static_cast<double>(pair) + 0.5) / static_cast<double>(pairs);
    const double radius =
        ball_radius((static_cast<double>(rank) + 0.5) / static_cast<double>(pairs));
    const Vec3d at = radius * from_polar(std::sqrt(1.0 - height * height),
                                         kGolden * static_cast<double>(pair), height);
    places[pair] = at;
    places[count - 1 - pair] = -at;
  }
  return places;
}

// Directions to a disc on the sky about (0, 0, 1), evenly by solid angle.
Vec3d in_disc(const Vec2d& u, double half_rad) {
  const double sine_of_half = std::sin(0.5 * half_rad);
  const double off = u.x * 2.0 * sine_of_half * sine_of_half;
  return from_polar(std::sqrt(off * (2.0 - off)), u.y, 1.0 - off);
}

// Across the direction of a light, which is its node's −Z.
std::array<Vec3d, 3> axes_of(const Light& light) {
  std::array<Vec3d, 3> axes;
  for (int i = 0; i < 3; ++i) {
    axes[static_cast<std::size_t>(i)] = glm::normalize(Vec3d(light.to_world[i]));
  }
  return axes;
}

void turn_to(const Vec3d& back, Light& light) {
  const Vec3d off = std::abs(back.x) < 0.5 ? Vec3d(1.0, 0.0, 0.0) : Vec3d(0.0, 1.0, 0.0);
  const Vec3d x = glm::normalize(glm::cross(off, back));
  light.to_world[0] = Vec4d(x, 0.0);
  light.to_world[1] = Vec4d(glm::cross(back, x), 0.0);
  light.to_world[2] = Vec4d(back, 0.0);
}

}  // namespace

std::vector<LampPlace> lamp_places(const Light& light, std::size_t count) {
  if (!light.shape || count < 2) return {{light}};
  const auto [x, y, z] = axes_of(light);
  const auto* ball = std::get_if<SphereLamp>(&*light.shape);
  const std::vector<Vec3d> offsets = ball != nullptr ? in_ball(count) : std::vector<Vec3d>{};
  std::vector<LampPlace> places;
  for (std::size_t i = 0; i < count; ++i) {
    LampPlace place{light};
    const Vec2d u = in_square(i, count);
    Vec3d off(0.0);
    if (ball != nullptr) {
      off = ball->radius_m * offsets[i];
    } else if (const auto* rectangle = std::get_if<RectangleLamp>(&*light.shape)) {
      off = Vec3d((u.x - 0.5) * rectangle->width_m, (u.y - 0.5) * rectangle->height_m, 0.0);
    } else if (const auto* disk = std::get_if<DiskLamp>(&*light.shape)) {
      off = disk->radius_m * from_polar(std::sqrt(u.x), u.y, 0.0);
    } else {
      const double half_rad = kPi / 360.0 * std::get<SkyDisc>(*light.shape).angle_deg;
      const Vec3d back = in_disc(u, half_rad);
      turn_to(back.x * x + back.y * y + back.z * z, place.light);
      place.times = 2.0 / (1.0 + std::cos(half_rad));
    }
    place.light.to_world[3] += Vec4d(off.x * x + off.y * y + off.z * z, 0.0);
    places.push_back(std::move(place));
  }
  return places;
}

WorldLight at_place(const WorldLight& lamp, const LampPlace& place) {
  WorldLight light = lamp;
  light.position = Vec3f(Vec3d(place.light.to_world[3]));
  light.direction = Vec3f(direction_of(place.light));
  return light;
}

}  // namespace abbe
