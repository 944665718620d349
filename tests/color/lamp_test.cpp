#include "abbe/color/lamp/lamp.h"

#include <gtest/gtest.h>

#include "abbe/load/spectra/catalogue.h"

namespace abbe {
namespace {

const Observer& observer() {
  static const Observer result = Catalogue::standard().observer();
  return result;
}

TEST(Lamp, correlated_temperature_of_a_black_body_is_its_own) {
  for (const double temperature_K : {1500.0, 2856.0, 5000.0, 6504.0, 12000.0, 40000.0}) {
    const auto found =
        correlated_temperature(xyz_of(Spectrum::blackbody(temperature_K), observer()), observer());
    ASSERT_TRUE(found);
    // The search ends 1e-5 mired wide; the valley is flat to half the digits of a double there.
    EXPECT_NEAR(1e6 / found->temperature_K, 1e6 / temperature_K, 1e-4);
    EXPECT_NEAR(found->duv, 0.0, 1e-7);  // The slope of the locus times the error in mired.
  }
}

TEST(Lamp, correlated_temperature_far_from_the_locus_is_none) {
  EXPECT_FALSE(correlated_temperature({0.2, 1.0, 0.1}, observer()));  // Green.
  EXPECT_FALSE(correlated_temperature({0.0, 0.0, 0.0}, observer()));
}

TEST(Lamp, chromaticity_of_black_is_zero) {
  EXPECT_EQ(xy_of_xyz({0.0, 0.0, 0.0}), Vec2d(0.0));
  EXPECT_EQ(xy_of_xyz({1.0, 1.0, 2.0}), Vec2d(0.25, 0.25));
}

}  // namespace
}  // namespace abbe
