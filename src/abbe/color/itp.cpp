#include "abbe/color/itp.h"

#include <algorithm>
#include <cmath>

#include "abbe/color/rgb_space.h"

namespace abbe {
namespace {

// SMPTE ST 2084, as the fractions of the standard.
constexpr double kM1 = 2610.0 / 16384.0;
constexpr double kM2 = 2523.0 / 4096.0 * 128.0;
constexpr double kC1 = 3424.0 / 4096.0;
constexpr double kC2 = 2413.0 / 4096.0 * 32.0;
constexpr double kC3 = 2392.0 / 4096.0 * 32.0;
constexpr double kPeak_cd_per_m2 = 10000.0;

Mat3d rows_over_4096(const Vec3d& first, const Vec3d& second, const Vec3d& third) {
  return glm::transpose(Mat3d(first / 4096.0, second / 4096.0, third / 4096.0));
}

Mat3d xyz_to_lms() {
  return rows_over_4096({1688, 2146, 262}, {683, 2951, 462}, {99, 309, 3688}) *
         glm::inverse(rgb_to_xyz(RgbSpace::Rec2020));
}

}  // namespace

double pq_encode(double luminance_cd_per_m2) {
  const double y = std::pow(std::max(luminance_cd_per_m2, 0.0) / kPeak_cd_per_m2, kM1);
  return std::pow((kC1 + kC2 * y) / (1.0 + kC3 * y), kM2);
}

double pq_decode(double signal) {
  const double root = std::pow(std::max(signal, 0.0), 1.0 / kM2);
  return kPeak_cd_per_m2 * std::pow(std::max(root - kC1, 0.0) / (kC2 - kC3 * root), 1.0 / kM1);
}

Vec3d ictcp_of_xyz(const Vec3d& xyz_cd_per_m2) {
  static const Mat3d to_lms = xyz_to_lms();
  static const Mat3d to_ictcp =
      rows_over_4096({2048, 2048, 0}, {6610, -13613, 7003}, {17933, -17390, -543});
  const Vec3d lms = to_lms * xyz_cd_per_m2;
  return to_ictcp * Vec3d(pq_encode(lms.x), pq_encode(lms.y), pq_encode(lms.z));
}

double delta_e_itp(const Vec3d& ictcp_a, const Vec3d& ictcp_b) {
  const Vec3d step = ictcp_a - ictcp_b;
  return 720.0 * std::sqrt(step.x * step.x + 0.25 * step.y * step.y + step.z * step.z);
}

}  // namespace abbe
