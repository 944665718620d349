#include "abbe/color/color.h"

#include <gtest/gtest.h>

#include <cmath>

#include "abbe/load/spectra/catalogue.h"

namespace abbe {
namespace {

void expect_near(const Vec3d& value, const Vec3d& expected, double tolerance) {
  for (int i = 0; i < 3; ++i) EXPECT_NEAR(value[i], expected[i], tolerance) << "component " << i;
}

struct Data {
  Observer observer;
  Spectrum d65, a;
  Development development;
};

const Data& data() {
  static const Data result = [] {
    const Catalogue catalogue = Catalogue::standard();
    Data made{catalogue.observer(),
              catalogue.illuminant("D65"),
              catalogue.illuminant("illuminant/A"),
              {}};
    made.development = development_for(made.observer, made.d65);
    return made;
  }();
  return result;
}

TEST(Rec709, matrix_is_the_published_one) {
  // IEC 61966-2-1, four decimals.
  const Mat3d matrix = rec709_to_xyz();
  expect_near(matrix * Vec3d(1, 0, 0), {0.4124, 0.2126, 0.0193}, 5e-5);
  expect_near(matrix * Vec3d(0, 1, 0), {0.3576, 0.7152, 0.1192}, 5e-5);
  expect_near(matrix * Vec3d(0, 0, 1), {0.1805, 0.0722, 0.9505}, 5e-5);
  expect_near(matrix * Vec3d(1, 1, 1), xyz_of_xy(kD65_xy), 1e-15);  // rounding
  expect_near(xyz_to_rec709() * (matrix * Vec3d(0.2, 0.5, 0.9)), {0.2, 0.5, 0.9}, 1e-14);
}

TEST(Adaptation, bradford_from_d65_to_d50_is_the_published_matrix) {
  // Lindbloom's table, seven decimals; whites as he has them.
  const Mat3d matrix = bradford_adaptation({0.95047, 1.0, 1.08883}, {0.96422, 1.0, 0.82521});
  expect_near(matrix * Vec3d(1, 0, 0), {1.0478112, 0.0295424, -0.0092345}, 1e-7);
  expect_near(matrix * Vec3d(0, 1, 0), {0.0228866, 0.9904844, 0.0150436}, 1e-7);
  expect_near(matrix * Vec3d(0, 0, 1), {-0.0501270, -0.0170491, 0.7521316}, 1e-7);
}

TEST(Adaptation, takes_one_white_to_the_other_and_back) {
  const Vec3d from(1.0985, 1.0, 0.35585), to(0.95047, 1.0, 1.08883);
  for (auto* adaptation : {&bradford_adaptation, &cat16_adaptation}) {
    expect_near((*adaptation)(from, to) * from, to, 1e-14);  // rounding
    const Mat3d there_and_back = (*adaptation)(to, from) * (*adaptation)(from, to);
    expect_near(there_and_back * Vec3d(0.3, 0.2, 0.1), {0.3, 0.2, 0.1}, 1e-14);
  }
}

TEST(Development, makes_d65_at_one_candela_white) {
  const double luminance = xyz_of(data().d65, data().observer).y;
  const Vec3d rgb_rec709 =
      rec709_of_emission(data().d65.scaled(1.0 / luminance), data().observer, data().development);
  expect_near(rgb_rec709, Vec3d(1.0), 1e-12);  // rounding
}

TEST(Development, adapts_by_no_more_than_the_rounding_of_the_white_point) {
  // Without adaptation the integral of D65 is 1.00017, 0.99998, 0.99974.
  const Vec3d xyz = xyz_of(data().d65, data().observer);
  expect_near(xyz_to_rec709() * (xyz / xyz.y), {1.00017, 0.99998, 0.99974}, 2e-5);
  expect_near(data().development.rec709_to_xyz * Vec3d(1.0), xyz / xyz.y, 1e-12);
}

TEST(Development, keeps_lamps_other_than_d65_coloured) {
  const double luminance = xyz_of(data().a, data().observer).y;
  const Vec3d rgb_rec709 =
      rec709_of_emission(data().a.scaled(1.0 / luminance), data().observer, data().development);
  // Illuminant A in linear Rec.709, from its XYZ of 1.0985, 1, 0.35585; the adaptation moves 1e-3.
  expect_near(rgb_rec709, xyz_to_rec709() * Vec3d(1.0985, 1.0, 0.35585), 2e-3);
  EXPECT_GT(rgb_rec709.r, 2.0 * rgb_rec709.b);
}

TEST(Development, flat_reflectance_is_a_neutral_of_its_value) {
  const Vec3d rgb_rec709 = rec709_of_reflectance(Spectrum::constant(0.18), data().observer,
                                                 data().d65, data().development);
  expect_near(rgb_rec709, Vec3d(0.18), 1e-12);  // rounding
}

TEST(TransferCurve, is_that_of_srgb) {
  EXPECT_EQ(srgb_encode(0.0), 0.0);
  EXPECT_DOUBLE_EQ(srgb_encode(1.0), 1.0);
  EXPECT_NEAR(srgb_encode(0.18), 0.46136, 5e-6);  // last printed digit
  EXPECT_NEAR(srgb_decode(0.5), 0.214041, 5e-7);
  for (double encoded = 0.0; encoded <= 1.0; encoded += 1.0 / 255.0) {
    // The two pieces of the standard meet with a gap of 3e-8.
    EXPECT_NEAR(srgb_encode(srgb_decode(encoded)), encoded, 1e-7);
  }
}

}  // namespace
}  // namespace abbe
