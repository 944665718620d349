#include "abbe/color/lamp/lamp.h"

#include <cmath>

namespace abbe {

Vec2d uv_1960_of_xyz(const Vec3d& xyz) {
  const double sum = xyz.x + 15.0 * xyz.y + 3.0 * xyz.z;
  return {4.0 * xyz.x / sum, 6.0 * xyz.y / sum};
}

Vec2d xy_of_xyz(const Vec3d& xyz) {
  const double sum = xyz.x + xyz.y + xyz.z;
  return sum > 0.0 ? Vec2d{xyz.x / sum, xyz.y / sum} : Vec2d{0.0};
}

std::optional<CorrelatedTemperature> correlated_temperature(const Vec3d& xyz,
                                                            const Observer& observer) {
  if (!(xyz.y > 0.0)) return std::nullopt;
  constexpr double kLeast_K = 1000.0, kMost_K = 100'000.0, kFurthest = 0.05;
  const Vec2d uv = uv_1960_of_xyz(xyz);
  const auto distance = [&](double mired) {
    const Vec2d planckian = uv_1960_of_xyz(xyz_of(Spectrum::blackbody(1e6 / mired), observer));
    return std::hypot(planckian.x - uv.x, planckian.y - uv.y);
  };
  // The distance has one valley along the locus for colours near it, but only near it: a coarse
  // walk in mired, where steps look equal, finds the valley, and the golden section its bottom.
  constexpr double kStep_mired = 20.0;
  const double least = 1e6 / kMost_K, most = 1e6 / kLeast_K;
  double best = least, best_distance = distance(least);
  for (double mired = least + kStep_mired; mired <= most; mired += kStep_mired) {
    const double here = distance(mired);
    if (here < best_distance) {
      best = mired;
      best_distance = here;
    }
  }
  double low = std::max(best - kStep_mired, least), high = std::min(best + kStep_mired, most);
  const double ratio = (std::sqrt(5.0) - 1.0) / 2.0;
  constexpr double kEnough_mired = 1e-5;
  double inner_low = high - ratio * (high - low), inner_high = low + ratio * (high - low);
  double distance_low = distance(inner_low), distance_high = distance(inner_high);
  while (high - low > kEnough_mired) {
    if (distance_low < distance_high) {
      high = inner_high;
      inner_high = inner_low;
      distance_high = distance_low;
      inner_low = high - ratio * (high - low);
      distance_low = distance(inner_low);
    } else {
      low = inner_low;
      inner_low = inner_high;
      distance_low = distance_high;
      inner_high = low + ratio * (high - low);
      distance_high = distance(inner_high);
    }
  }
  const double mired = 0.5 * (low + high);
  const double nearest = distance(mired);
  const bool at_an_end = mired - least < 2.0 * kEnough_mired || most - mired < 2.0 * kEnough_mired;
  if (nearest > kFurthest || at_an_end) return std::nullopt;
  const Vec2d planckian = uv_1960_of_xyz(xyz_of(Spectrum::blackbody(1e6 / mired), observer));
  return CorrelatedTemperature{1e6 / mired, uv.y >= planckian.y ? nearest : -nearest};
}

}  // namespace abbe
