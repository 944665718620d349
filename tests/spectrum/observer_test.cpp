// Published numbers of colorimetry, from the files of spectra/.
#include "abbe/spectrum/observer.h"

#include <gtest/gtest.h>

#include <string>

#include "abbe/base/constants.h"
#include "abbe/load/spectra/catalogue.h"

namespace abbe {
namespace {

const Catalogue& catalogue() {
  static const Catalogue result = Catalogue::standard();
  return result;
}

double sum_over_nanometres(const Spectrum& spectrum, double from_nm = 360.0, double to_nm = 830.0) {
  double sum = 0.0;
  for (double nm = from_nm; nm <= to_nm; nm += 1.0) sum += spectrum.value(nm);
  return sum;
}

TEST(Observer, sums_of_the_1931_table_are_the_published_ones) {
  const Observer observer = catalogue().observer();
  // A single transposed digit moves these by 1e-5 and more.
  EXPECT_NEAR(sum_over_nanometres(observer.x_bar), 106.8655, 5e-5);
  EXPECT_NEAR(sum_over_nanometres(observer.y_bar), 106.856917, 5e-7);
  EXPECT_NEAR(sum_over_nanometres(observer.z_bar), 106.8923, 5e-5);
}

struct WhitePoint {
  const char* illuminant;
  double x, y;
  double tolerance;
};

class WhitePoints : public testing::TestWithParam<WhitePoint> {};

TEST_P(WhitePoints, are_the_published_ones) {
  const WhitePoint& expected = GetParam();
  const Vec3d xyz = xyz_of(catalogue().illuminant(expected.illuminant), catalogue().observer());
  const double sum = xyz.x + xyz.y + xyz.z;
  EXPECT_NEAR(xyz.x / sum, expected.x, expected.tolerance);
  EXPECT_NEAR(xyz.y / sum, expected.y, expected.tolerance);
}

// CIE 15:2018. Published ranges stop at 780 nm and steps differ: 2e-4. Lamps with peaks depend on
// how 5 nm are interpolated: 4e-4.
INSTANTIATE_TEST_SUITE_P(Observer, WhitePoints,
                         testing::Values(WhitePoint{"illuminant/A", 0.44758, 0.40745, 2e-4},
                                         WhitePoint{"D50", 0.34567, 0.35851, 2e-4},
                                         WhitePoint{"D55", 0.33243, 0.34744, 2e-4},
                                         WhitePoint{"D65", 0.31272, 0.32903, 2e-4},
                                         WhitePoint{"D75", 0.29903, 0.31488, 2e-4},
                                         WhitePoint{"illuminant/E", 1.0 / 3, 1.0 / 3, 2e-4},
                                         WhitePoint{"FL2", 0.37208, 0.37529, 4e-4},
                                         WhitePoint{"FL7", 0.31292, 0.32933, 4e-4},
                                         WhitePoint{"FL11", 0.38052, 0.37713, 4e-4}));

TEST(Observer, d65_has_the_published_tristimulus_ratios) {
  const Vec3d xyz = xyz_of(catalogue().illuminant("D65"), catalogue().observer());
  EXPECT_NEAR(100.0 * xyz.x / xyz.y, 95.047, 0.01);   // measured: 95.04700
  EXPECT_NEAR(100.0 * xyz.z / xyz.y, 108.883, 0.01);  // measured: 108.88282
}

TEST(Observer, luminous_efficacy_of_d65_depends_on_the_range_as_stated) {
  const Spectrum d65 = catalogue().illuminant("D65");
  const Observer observer = catalogue().observer();
  const auto efficacy = [&](double from_nm, double to_nm) {
    double seen = 0.0;
    for (double nm = from_nm; nm <= to_nm; nm += 1.0) {
      seen += d65.value(nm) * observer.y_bar.value(nm);
    }
    return kLuminousEfficacy_lm_per_W * seen / sum_over_nanometres(d65, from_nm, to_nm);
  };
  // Sums of 1 nm, which count half a nanometre beyond either end; last digit of the figures.
  EXPECT_NEAR(efficacy(360.0, 830.0), 184.17, 0.01);
  EXPECT_NEAR(efficacy(380.0, 780.0), 204.82, 0.01);
  EXPECT_NEAR(efficacy(400.0, 700.0), 250.55, 0.01);
  // The integral from 360 to 830 nm proper leaves those halves out.
  EXPECT_NEAR(xyz_of(d65, observer).y / integral(d65), 184.42, 0.01);
}

TEST(Observer, a_line_counts_its_strength_times_the_observer) {
  const Observer observer = catalogue().observer();
  const Vec3d xyz = xyz_of(Spectrum::lines({{555.0, 2.0}}), observer);
  EXPECT_DOUBLE_EQ(xyz.y, kLuminousEfficacy_lm_per_W * 2.0 * observer.y_bar.value(555.0));
}

TEST(Observer, blackbody_of_2856_kelvin_has_the_chromaticity_of_illuminant_a) {
  const Vec3d xyz = xyz_of(Spectrum::blackbody(2855.542), catalogue().observer());
  const double sum = xyz.x + xyz.y + xyz.z;
  // A is Planck's law with c2 = 1.435e-2 at 2848 K, which today's c2 makes 2855.54 K.
  EXPECT_NEAR(xyz.x / sum, 0.44758, 5e-5);
  EXPECT_NEAR(xyz.y / sum, 0.40745, 5e-5);
}

}  // namespace
}  // namespace abbe
