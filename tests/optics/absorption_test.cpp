#include "abbe/optics/absorption.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace abbe {
namespace {

constexpr double kInfiniteDistance = std::numeric_limits<double>::infinity();

TEST(Absorption, attenuation_color_is_reached_after_the_attenuation_distance) {
  const double absorption_per_m = absorption_of_attenuation_per_m(0.25, 0.3);
  EXPECT_DOUBLE_EQ(transmittance_after(absorption_per_m, 0.3), 0.25);
  EXPECT_DOUBLE_EQ(transmittance_after(absorption_per_m, 0.6), 0.0625);
  EXPECT_EQ(transmittance_after(absorption_per_m, 0.0), 1.0);
}

TEST(Absorption, white_or_an_infinite_distance_absorbs_nothing) {
  EXPECT_EQ(absorption_of_attenuation_per_m(1.0, 0.1), 0.0);
  EXPECT_EQ(absorption_of_attenuation_per_m(0.2, kInfiniteDistance), 0.0);
  EXPECT_EQ(transmittance_after(0.0, kInfiniteDistance), 1.0);
}

TEST(Absorption, black_lets_no_light_through_but_stays_finite) {
  const double absorption_per_m = absorption_of_attenuation_per_m(0.0, 1.0);
  EXPECT_TRUE(std::isfinite(absorption_per_m));
  EXPECT_LT(transmittance_after(absorption_per_m, 1e-6), 1e-300);
}

TEST(Absorption, channels_are_independent) {
  const Vec3d absorption_per_m = absorption_of_attenuation_per_m(Vec3d(0.5, 1.0, 0.1), 2.0);
  EXPECT_DOUBLE_EQ(absorption_per_m.r, std::log(2.0) / 2.0);
  EXPECT_EQ(absorption_per_m.g, 0.0);
  EXPECT_DOUBLE_EQ(absorption_per_m.b, std::log(10.0) / 2.0);
}

}  // namespace
}  // namespace abbe
