#include "abbe/color/color.h"

#include <cmath>

#include "abbe/color/rgb_space.h"

namespace abbe {
namespace {

// GLM takes matrices column by column; these read as they are printed.
Mat3d from_rows(const Vec3d& first, const Vec3d& second, const Vec3d& third) {
  return glm::transpose(Mat3d(first, second, third));
}

Mat3d diagonal(const Vec3d& values) {
  Mat3d result(0.0);
  for (int i = 0; i < 3; ++i) result[i][i] = values[i];
  return result;
}

// Adaptation after von Kries in the cone responses that `to_cones` makes of XYZ.
Mat3d adaptation(const Mat3d& to_cones, const Vec3d& xyz_white_from, const Vec3d& xyz_white_to) {
  const Vec3d gain = (to_cones * xyz_white_to) / (to_cones * xyz_white_from);
  return glm::inverse(to_cones) * diagonal(gain) * to_cones;
}

}  // namespace

Vec3d xyz_of_xy(const Vec2d& xy, double Y) {
  return Y * Vec3d(xy.x / xy.y, 1.0, (1.0 - xy.x - xy.y) / xy.y);
}

Mat3d rec709_to_xyz() {
  return rgb_to_xyz(RgbSpace::Rec709);
}

Mat3d xyz_to_rec709() {
  return glm::inverse(rec709_to_xyz());
}

Mat3d bradford_adaptation(const Vec3d& xyz_white_from, const Vec3d& xyz_white_to) {
  // Lam 1985, as used by ICC.1:2022, annex E.
  static const Mat3d to_cones =
      from_rows({0.8951, 0.2664, -0.1614}, {-0.7502, 1.7135, 0.0367}, {0.0389, -0.0685, 1.0296});
  return adaptation(to_cones, xyz_white_from, xyz_white_to);
}

Mat3d cat16_adaptation(const Vec3d& xyz_white_from, const Vec3d& xyz_white_to) {
  // Li et al., Color Research & Application 42(6), 2017.
  static const Mat3d to_cones =
      from_rows({0.401288, 0.650173, -0.051461}, {-0.250268, 1.204414, 0.045854},
                {-0.002079, 0.048952, 0.953127});
  return adaptation(to_cones, xyz_white_from, xyz_white_to);
}

Development development_for(const Observer& observer, const Spectrum& d65) {
  const Vec3d white = xyz_of(d65, observer);
  Development development;
  development.xyz_to_rec709 =
      xyz_to_rec709() * cat16_adaptation(white / white.y, xyz_of_xy(kD65_xy));
  development.rec709_to_xyz = glm::inverse(development.xyz_to_rec709);
  return development;
}

Vec3d rec709_of_emission(const Spectrum& emission, const Observer& observer,
                         const Development& development) {
  return development.xyz_to_rec709 * xyz_of(emission, observer);
}

Vec3d rec709_of_reflectance(const Spectrum& reflectance, const Observer& observer,
                            const Spectrum& d65, const Development& development) {
  const double white_luminance = xyz_of(d65, observer).y;
  return development.xyz_to_rec709 *
         (xyz_of(product(reflectance, d65), observer) / white_luminance);
}

double srgb_encode(double linear) {
  if (linear <= 0.0031308) return 12.92 * linear;
  return 1.055 * std::pow(linear, 1.0 / 2.4) - 0.055;
}

double srgb_decode(double encoded) {
  if (encoded <= 0.04045) return encoded / 12.92;
  return std::pow((encoded + 0.055) / 1.055, 2.4);
}

}  // namespace abbe
