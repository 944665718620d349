#include "abbe/optics/fresnel.h"

#include <gtest/gtest.h>

#include <cmath>

#include "abbe/base/constants.h"

namespace abbe {
namespace {

constexpr double kDegree = kPi / 180.0;

TEST(FresnelDielectric, normal_incidence_reflects_the_square_of_the_index_contrast) {
  EXPECT_DOUBLE_EQ(fresnel_dielectric(1.0, 1.5).reflectance(), 0.04);
  EXPECT_DOUBLE_EQ(normal_reflectance(1.5), 0.04);
  EXPECT_NEAR(normal_reflectance(1.5168), 0.042165, 5e-7);  // last printed digit
  EXPECT_NEAR(normal_reflectance(2.4175), 0.172040, 5e-7);
  EXPECT_DOUBLE_EQ(normal_reflectance(1.5), normal_reflectance(1.0 / 1.5));
}

TEST(FresnelDielectric, at_45_degrees_equals_the_textbook_values) {
  const DielectricFresnel fresnel = fresnel_dielectric(std::cos(45.0 * kDegree), 1.5);
  EXPECT_NEAR(fresnel.reflectance_s, 0.092013, 5e-7);  // last printed digit
  EXPECT_NEAR(fresnel.reflectance_p, 0.008466, 5e-7);
}

TEST(FresnelDielectric, brewster_and_critical_angles_are_the_published_ones) {
  EXPECT_NEAR(brewster_angle_rad(1.5) / kDegree, 56.3099, 5e-5);  // last printed digits
  EXPECT_NEAR(brewster_angle_rad(1.5168) / kDegree, 56.604, 5e-4);
  EXPECT_NEAR(critical_angle_rad(1.0 / 1.5168) / kDegree, 41.245, 5e-4);
  EXPECT_NEAR(brewster_angle_rad(2.4175) / kDegree, 67.528, 5e-4);
  EXPECT_NEAR(critical_angle_rad(1.0 / 2.4175) / kDegree, 24.434, 5e-4);
  EXPECT_DOUBLE_EQ(critical_angle_rad(1.5), kPi / 2.0);
}

TEST(FresnelDielectric, brewsters_angle_reflects_no_p_polarised_light) {
  EXPECT_NEAR(fresnel_dielectric(std::cos(brewster_angle_rad(1.5)), 1.5).reflectance_p, 0.0, 1e-30);
}

TEST(FresnelDielectric, beyond_the_critical_angle_reflects_exactly_all) {
  const double eta_ti = 1.0 / 1.5168;
  const double critical = critical_angle_rad(eta_ti);
  const DielectricFresnel beyond = fresnel_dielectric(std::cos(critical + 1e-6), eta_ti);
  EXPECT_EQ(beyond.reflectance(), 1.0);
  EXPECT_EQ(beyond.transmittance(), 0.0);
  EXPECT_EQ(beyond.cos_transmitted, 0.0);
  EXPECT_LT(fresnel_dielectric(std::cos(critical - 1e-6), eta_ti).reflectance(), 1.0);
}

TEST(FresnelDielectric, both_directions_through_a_boundary_reflect_alike) {
  for (double degrees = 0.0; degrees < 90.0; degrees += 7.5) {
    const double cos_outside = std::cos(degrees * kDegree);
    const DielectricFresnel in = fresnel_dielectric(cos_outside, 1.7);
    const DielectricFresnel out = fresnel_dielectric(in.cos_transmitted, 1.0 / 1.7);
    EXPECT_NEAR(in.reflectance(), out.reflectance(), 1e-12);  // rounding
    EXPECT_NEAR(out.cos_transmitted, cos_outside, 1e-12);
  }
}

TEST(FresnelConductor, without_absorption_is_a_dielectric) {
  for (double degrees = 0.0; degrees <= 90.0; degrees += 10.0) {
    const double cosine = std::max(std::cos(degrees * kDegree), 0.0);
    EXPECT_NEAR(fresnel_conductor(cosine, 1.5, 0.0), fresnel_dielectric(cosine, 1.5).reflectance(),
                1e-12);  // rounding
  }
}

TEST(FresnelConductor, normal_incidence_equals_its_closed_form) {
  // Gold at 549 nm, Johnson & Christy: ((n − 1)² + k²)/((n + 1)² + k²).
  const double n = 0.43, k = 2.455;
  EXPECT_NEAR(fresnel_conductor(1.0, n, k),
              ((n - 1) * (n - 1) + k * k) / ((n + 1) * (n + 1) + k * k), 1e-14);  // rounding
  // In water the contrast is that of n/1.333 and k/1.333.
  EXPECT_NEAR(fresnel_conductor(0.5, n, k, 1.333), fresnel_conductor(0.5, n / 1.333, k / 1.333),
              1e-14);
}

TEST(FresnelConductor, grazing_light_is_all_reflected) {
  EXPECT_NEAR(fresnel_conductor(0.0, 1.04, 2.583), 1.0, 1e-12);  // rounding
}

TEST(FresnelSchlick, runs_from_f0_to_f90) {
  EXPECT_EQ(fresnel_schlick(1.0, 0.04), 0.04);
  EXPECT_EQ(fresnel_schlick(0.0, 0.04), 1.0);
  EXPECT_DOUBLE_EQ(fresnel_schlick(0.5, 0.04, 0.8), 0.04 + 0.76 / 32.0);
}

}  // namespace
}  // namespace abbe
