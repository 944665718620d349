#include "abbe/load/gltf/motion/curve.h"

#include <algorithm>
#include <cmath>
#include <span>

namespace abbe::gltf {
namespace {

using Values = std::vector<double>;

double length_of(const Values& v) {
  double sum = 0.0;
  for (const double x : v) sum += x * x;
  return std::sqrt(sum);
}

void normalize(Values& q) {
  const double length = length_of(q);
  if (!(length > 0.0)) return;  // Said where it becomes a transform.
  for (double& x : q) x /= length;
}

Values mix(const Values& a, double share_a, const Values& b, double share_b) {
  Values result(a.size());
  for (std::size_t i = 0; i < a.size(); ++i) result[i] = share_a * a[i] + share_b * b[i];
  return result;
}

Values slerp(Values a, Values b, double share) {
  normalize(a);
  normalize(b);
  double cosine = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) cosine += a[i] * b[i];
  // q and −q are one rotation: the nearer one is meant.
  if (cosine < 0.0) {
    for (double& x : b) x = -x;
  }
  // The angle by its half, which is well conditioned everywhere.
  const double angle =
      2.0 * std::atan2(length_of(mix(a, 1.0, b, -1.0)), length_of(mix(a, 1.0, b, 1.0)));
  const double sine = std::sin(angle);
  constexpr double kStraight = 1e-8;  // Below it arc and chord are one to the rounding.
  Values result = sine < kStraight ? mix(a, 1.0 - share, b, share)
                                   : mix(a, std::sin((1.0 - share) * angle) / sine, b,
                                         std::sin(share * angle) / sine);
  normalize(result);
  return result;
}

}  // namespace

std::vector<double> value_at(const Curve& curve, double time_s) {
  const bool is_spline = curve.interpolation == Interpolation::CubicSpline;
  const std::size_t width = curve.width;
  const auto part = [&](std::size_t key, std::size_t place) {
    const std::size_t begin = (is_spline ? 3 * key + place : key) * width;
    const auto values = std::span(curve.values).subspan(begin, width);
    return Values(values.begin(), values.end());
  };
  constexpr std::size_t kIn = 0, kValue = 1, kOut = 2;

  const auto& times = curve.times_s;
  const auto after =
      std::upper_bound(times.begin(), times.end(), time_s,
                       [](double time, float key) { return time < static_cast<double>(key); });
  if (after == times.begin()) return part(0, kValue);
  const auto key = static_cast<std::size_t>(after - times.begin()) - 1;
  const auto key_s = static_cast<double>(times[key]);
  if (after == times.end() || key_s == time_s || curve.interpolation == Interpolation::Step) {
    return part(key, kValue);
  }
  const double step_s = static_cast<double>(*after) - key_s;
  const double s = (time_s - key_s) / step_s;
  const Values from = part(key, kValue), to = part(key + 1, kValue);
  if (!is_spline) return curve.is_rotation ? slerp(from, to, s) : mix(from, 1.0 - s, to, s);

  const double s2 = s * s, s3 = s2 * s;
  const Values places = mix(from, 2.0 * s3 - 3.0 * s2 + 1.0, to, 3.0 * s2 - 2.0 * s3);
  const Values slopes =
      mix(part(key, kOut), step_s * (s3 - 2.0 * s2 + s), part(key + 1, kIn), step_s * (s3 - s2));
  Values result = mix(places, 1.0, slopes, 1.0);
  if (curve.is_rotation) normalize(result);
  return result;
}

}  // namespace abbe::gltf
