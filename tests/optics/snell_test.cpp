#include "abbe/optics/snell.h"

#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "abbe/base/constants.h"
#include "abbe/math/vec.h"
#include "abbe/optics/dispersion.h"

namespace abbe {
namespace {

constexpr double kDegree = kPi / 180.0;

TEST(Snell, reflection_keeps_the_angle_on_either_side_of_the_normal) {
  const Vec3d incoming = glm::normalize(Vec3d(1.0, -2.0, 0.0));
  const Vec3d expected = glm::normalize(Vec3d(1.0, 2.0, 0.0));
  for (const double sign : {1.0, -1.0}) {
    const Vec3d reflected = reflected_direction(incoming, Vec3d(0.0, sign, 0.0));
    EXPECT_NEAR(glm::length(reflected - expected), 0.0, 1e-15);  // rounding
  }
}

TEST(Snell, refraction_obeys_the_law_of_sines) {
  for (const double eta_ti : {1.5, 1.0 / 1.5, 2.4175, 1.0}) {
    for (double degrees = 0.0; degrees < 90.0; degrees += 5.0) {
      const double sine = std::sin(degrees * kDegree);
      const Vec3d incoming(sine, -std::cos(degrees * kDegree), 0.0);
      const auto refracted = refracted_direction(incoming, Vec3d(0.0, 1.0, 0.0), eta_ti);
      if (sine >= eta_ti) {
        EXPECT_FALSE(refracted.has_value());
        continue;
      }
      ASSERT_TRUE(refracted.has_value());
      EXPECT_NEAR(refracted->x, sine / eta_ti, 1e-14);  // rounding
      EXPECT_LT(refracted->y, 0.0);
      EXPECT_NEAR(glm::length(*refracted), 1.0, 1e-15);
    }
  }
}

TEST(Snell, refraction_does_not_depend_on_the_side_of_the_normal) {
  const Vec3d incoming = glm::normalize(Vec3d(0.3, -0.8, 0.2));
  const auto up = refracted_direction(incoming, Vec3d(0.0, 1.0, 0.0), 1.5);
  const auto down = refracted_direction(incoming, Vec3d(0.0, -1.0, 0.0), 1.5);
  EXPECT_EQ(*up, *down);
}

TEST(Snell, equal_indices_leave_the_direction_as_it_is) {
  const Vec3f incoming = glm::normalize(Vec3f(0.3f, -0.8f, 0.2f));
  const auto refracted = refracted_direction(incoming, Vec3f(0.0f, 1.0f, 0.0f), 1.0f);
  EXPECT_NEAR(glm::length(*refracted - incoming), 0.0f, 1e-7f);  // renormalisation
}

TEST(Snell, refract_beyond_critical_angle_has_no_transmitted_ray) {
  const double critical = std::asin(1.0 / 1.5168);
  const auto at = [](double angle) { return Vec3d(std::sin(angle), -std::cos(angle), 0.0); };
  const Vec3d normal(0.0, 1.0, 0.0);
  EXPECT_FALSE(refracted_direction(at(critical + 1e-9), normal, 1.0 / 1.5168).has_value());
  EXPECT_TRUE(refracted_direction(at(critical - 1e-9), normal, 1.0 / 1.5168).has_value());
}

// Deviation, in degrees, of a ray in the principal section of a 60° prism.
double prism_deviation_degrees(double incidence_degrees, double n) {
  // The apex points up; the faces lean by 30° to either side.
  const Vec3d first_normal(-std::cos(30.0 * kDegree), std::sin(30.0 * kDegree), 0.0);
  const Vec3d second_normal(std::cos(30.0 * kDegree), std::sin(30.0 * kDegree), 0.0);
  // The ray comes from below the normal, as at minimum deviation.
  const double angle = incidence_degrees * kDegree;
  const Vec3d along_face(std::sin(30.0 * kDegree), std::cos(30.0 * kDegree), 0.0);
  const Vec3d incoming = -std::cos(angle) * first_normal + std::sin(angle) * along_face;
  const auto inside = refracted_direction(incoming, first_normal, n);
  const auto outgoing = refracted_direction(*inside, second_normal, 1.0 / n);
  return std::acos(glm::dot(incoming, *outgoing)) / kDegree;
}

struct Prism {
  const char* name;
  SellmeierFormula glass;
  double incidence_degrees;
  double deviation_F, deviation_d, deviation_C;
  double two_term_error, two_term_tolerance;  ///< At 400 nm.
};

class MinimumDeviation : public testing::TestWithParam<Prism> {};

TEST_P(MinimumDeviation, deviates_the_fraunhofer_lines_by_the_computed_angles) {
  const Prism& prism = GetParam();
  const Dispersion glass = prism.glass;
  const auto deviation = [&](double nm) {
    return prism_deviation_degrees(prism.incidence_degrees, refractive_index(glass, nm));
  };
  // The figures have five decimals, their incidence four: 2e-4 leaves that room.
  EXPECT_NEAR(deviation(kLineF_nm), prism.deviation_F, 2e-4);
  EXPECT_NEAR(deviation(kLine_d_nm), prism.deviation_d, 2e-4);
  EXPECT_NEAR(deviation(kLineC_nm), prism.deviation_C, 2e-4);
  // The d line deviates least at this incidence: 2 asin(n sin 30°) − 60°.
  const double n_d = refractive_index(glass, kLine_d_nm);
  EXPECT_NEAR(deviation(kLine_d_nm), 2.0 * std::asin(0.5 * n_d) / kDegree - 60.0, 1e-6);
}

TEST_P(MinimumDeviation, two_term_dispersion_of_gltf_errs_in_the_violet_as_computed) {
  const Prism& prism = GetParam();
  const Dispersion measured = prism.glass;
  const Dispersion two_terms =
      AbbeNumber{refractive_index(measured, kLine_d_nm), abbe_number(measured)};
  const auto deviation = [&](const Dispersion& glass) {
    return prism_deviation_degrees(prism.incidence_degrees, refractive_index(glass, 400.0));
  };
  // Last printed digits; why measured glass has to bypass that formula.
  EXPECT_NEAR(deviation(two_terms) - deviation(measured), prism.two_term_error,
              prism.two_term_tolerance);
}

// Coefficients of the makers' data sheets.
INSTANTIATE_TEST_SUITE_P(
    Snell, MinimumDeviation,
    testing::Values(
        Prism{
            "N-BK7",
            {0.0, {1.03961212, 0.231792344, 1.01046945}, {0.00600069867, 0.0200179144, 103.560653}},
            49.3233,
            39.13905,
            38.64670,
            38.42932,
            0.009,
            1e-3},
        Prism{"F2",
              {0.0,
               {1.34533359, 0.209073176, 0.937357162},
               {0.00997743871, 0.0470450767, 111.886764}},
              54.0979,
              49.38809,
              48.19578,
              47.70902,
              -0.23,
              0.01},
        Prism{"N-SF11",
              {0.0, {1.73759695, 0.313747346, 1.89878101}, {0.013188707, 0.0623068142, 155.23629}},
              63.1713,
              69.25084,
              66.34263,
              65.24956,
              -1.27,
              0.01}),
    [](const auto& instance) {
      std::string name = instance.param.name;
      std::erase(name, '-');
      return name;
    });

}  // namespace
}  // namespace abbe
