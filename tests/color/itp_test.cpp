#include "abbe/color/itp.h"

#include <gtest/gtest.h>

#include "abbe/color/color.h"

namespace abbe {
namespace {

TEST(PerceptualQuantiser, has_the_codes_of_st_2084) {
  // Published six-digit signals.
  EXPECT_NEAR(pq_encode(100.0), 0.508078, 5e-7);
  EXPECT_NEAR(pq_encode(1000.0), 0.751827, 5e-7);
  EXPECT_NEAR(pq_encode(10000.0), 1.0, 1e-15);
  for (const double luminance : {0.0, 0.01, 1.0, 203.0, 9999.0}) {
    EXPECT_NEAR(pq_decode(pq_encode(luminance)), luminance, 1e-9 * (luminance + 1.0));  // rounding
  }
}

TEST(Ictcp, of_white_is_its_signal_without_colour) {
  const Vec3d ictcp = ictcp_of_xyz(100.0 * xyz_of_xy(kD65_xy));
  EXPECT_NEAR(ictcp.x, 0.508078, 5e-7);  // printed digits
  EXPECT_NEAR(ictcp.y, 0.0, 1e-12);      // rounding: the rows of the matrix sum to 0
  EXPECT_NEAR(ictcp.z, 0.0, 1e-12);
}

TEST(DeltaEItp, of_two_greys_is_720_steps_of_signal) {
  const Vec3d white = xyz_of_xy(kD65_xy);
  EXPECT_NEAR(delta_e_itp(ictcp_of_xyz(100.0 * white), ictcp_of_xyz(1000.0 * white)),
              720.0 * (0.751827 - 0.508078), 1e-3);  // printed digits times 720
}

TEST(DeltaEItp, equals_the_published_pair) {
  // The worked pair of Recommendation BT.2124 as the library colour-science prints it.
  EXPECT_NEAR(delta_e_itp({0.4885468072, -0.04739350675, 0.07475401302},
                          {0.4899203231, -0.04567508203, 0.07361341775}),
              1.42657228, 1e-6);  // ten digits of the coordinates, times 720
}

TEST(Ictcp, of_impossible_light_is_finite) {
  const Vec3d ictcp = ictcp_of_xyz({-5.0, -1.0, 2.0});
  for (int i = 0; i < 3; ++i) EXPECT_TRUE(std::isfinite(ictcp[i]));
}

}  // namespace
}  // namespace abbe
