// CIE L*a*b* and the difference of two colours in it.
#include <algorithm>
#include <cmath>

#include "abbe/base/constants.h"
#include "abbe/color/color.h"

namespace abbe {
namespace {

constexpr double kRadians_per_degree = kPi / 180.0;

double lab_root(double ratio) {
  constexpr double kLinearBelow = 216.0 / 24389.0;  // (6/29)³
  constexpr double kSlope = 24389.0 / 27.0;         // (29/3)³
  return ratio > kLinearBelow ? std::cbrt(ratio) : (kSlope * ratio + 16.0) / 116.0;
}

// In degrees, [0, 360); 0 for a colour without hue.
double hue_degrees(double a, double b) {
  if (a == 0.0 && b == 0.0) return 0.0;
  const double degrees = std::atan2(b, a) / kRadians_per_degree;
  return degrees < 0.0 ? degrees + 360.0 : degrees;
}

double cos_degrees(double degrees) {
  return std::cos(degrees * kRadians_per_degree);
}
double sin_degrees(double degrees) {
  return std::sin(degrees * kRadians_per_degree);
}

double seventh_power_ratio(double chroma) {
  const double seventh = std::pow(chroma, 7);
  return std::sqrt(seventh / (seventh + std::pow(25.0, 7)));
}

}  // namespace

Vec3d lab_of_xyz(const Vec3d& xyz, const Vec3d& xyz_white) {
  const double x = lab_root(xyz.x / xyz_white.x);
  const double y = lab_root(xyz.y / xyz_white.y);
  const double z = lab_root(xyz.z / xyz_white.z);
  return {116.0 * y - 16.0, 500.0 * (x - y), 200.0 * (y - z)};
}

double delta_e2000(const Vec3d& lab_a, const Vec3d& lab_b) {
  // Names follow Sharma, Wu & Dalal, with the stroke left out.
  const double mean_chroma_ab = 0.5 * (std::hypot(lab_a.y, lab_a.z) + std::hypot(lab_b.y, lab_b.z));
  const double G = 0.5 * (1.0 - seventh_power_ratio(mean_chroma_ab));
  const double a1 = (1.0 + G) * lab_a.y, a2 = (1.0 + G) * lab_b.y;
  const double C1 = std::hypot(a1, lab_a.z), C2 = std::hypot(a2, lab_b.z);
  const double h1 = hue_degrees(a1, lab_a.z), h2 = hue_degrees(a2, lab_b.z);
  const bool both_have_hue = C1 * C2 != 0.0;

  double hue_step = 0.0;
  double mean_hue = h1 + h2;
  if (both_have_hue) {
    hue_step = h2 - h1;
    mean_hue *= 0.5;
    // The short way round the circle, and the mean on that side.
    if (hue_step > 180.0) {
      hue_step -= 360.0;
      mean_hue += h1 + h2 < 360.0 ? 180.0 : -180.0;
    } else if (hue_step < -180.0) {
      hue_step += 360.0;
      mean_hue += h1 + h2 < 360.0 ? 180.0 : -180.0;
    }
  }
  const double dL = lab_b.x - lab_a.x;
  const double dC = C2 - C1;
  const double dH = 2.0 * std::sqrt(C1 * C2) * sin_degrees(0.5 * hue_step);

  const double mean_L = 0.5 * (lab_a.x + lab_b.x);
  const double mean_C = 0.5 * (C1 + C2);
  const double T = 1.0 - 0.17 * cos_degrees(mean_hue - 30.0) + 0.24 * cos_degrees(2.0 * mean_hue) +
                   0.32 * cos_degrees(3.0 * mean_hue + 6.0) -
                   0.20 * cos_degrees(4.0 * mean_hue - 63.0);
  const double rotation_angle = 30.0 * std::exp(-std::pow((mean_hue - 275.0) / 25.0, 2));
  const double R_T = -sin_degrees(2.0 * rotation_angle) * 2.0 * seventh_power_ratio(mean_C);
  const double from_middle = (mean_L - 50.0) * (mean_L - 50.0);
  const double S_L = 1.0 + 0.015 * from_middle / std::sqrt(20.0 + from_middle);
  const double S_C = 1.0 + 0.045 * mean_C;
  const double S_H = 1.0 + 0.015 * mean_C * T;
  const double l = dL / S_L, c = dC / S_C, h = dH / S_H;
  return std::sqrt(std::max(l * l + c * c + h * h + R_T * c * h, 0.0));
}

}  // namespace abbe
