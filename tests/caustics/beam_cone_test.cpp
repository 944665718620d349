/// Bounds of cones of rays hold for the rays in them.
#include "abbe/caustics/flat/search/beam_cone.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "abbe/base/constants.h"

namespace abbe {
namespace {

class BeamCones : public testing::Test {
 protected:
  double uniform(double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(random_);
  }
  Vec3d direction() {
    const double z = uniform(-1.0, 1.0);
    const double phi = uniform(0.0, 2.0 * kPi);
    const double r = std::sqrt(1.0 - z * z);
    return {r * std::cos(phi), r * std::sin(phi), z};
  }
  // On the outline of the cone or inside it.
  Vec3d direction_in(const BeamCone& cone) {
    const Vec3d helper = std::abs(cone.axis.x) < 0.6 ? Vec3d(1, 0, 0) : Vec3d(0, 1, 0);
    const Vec3d u = glm::normalize(glm::cross(helper, cone.axis));
    const Vec3d v = glm::cross(cone.axis, u);
    const double off = cone.angle_rad * std::min(1.0, uniform(0.0, 2.0));
    const double phi = uniform(0.0, 2.0 * kPi);
    return std::cos(off) * cone.axis + std::sin(off) * (std::cos(phi) * u + std::sin(phi) * v);
  }

 private:
  std::mt19937 random_{7};
};

TEST_F(BeamCones, a_cone_that_crosses_a_plane_holds_all_directions_that_do) {
  const Vec3d n(0, 0, 1);
  int across = 0;
  for (int i = 0; i < 3000; ++i) {
    BeamCone cone;
    cone.axis = direction();
    cone.angle_rad = uniform(0.0, kPi);
    const BeamCone half = crossing(cone, n);
    EXPECT_GT(half.axis.z, 0.0);
    for (int k = 0; k < 100; ++k) {
      const Vec3d d = direction_in(cone);
      if (d.z <= 0.0) continue;
      across += cone.axis.z < 0.0 ? 1 : 0;
      ASSERT_GE(glm::dot(d, half.axis), std::cos(half.angle_rad) - 1e-9);
    }
  }
  EXPECT_GT(across, 10000);
}

TEST_F(BeamCones, the_section_of_a_plane_holds_what_a_cone_meets_of_it) {
  int met = 0;
  for (int i = 0; i < 3000; ++i) {
    BeamCone cone;
    cone.axis = direction();
    cone.angle_rad = uniform(0.0, kPi);
    cone.radius_m = uniform(0.0, 0.5);
    const double distance = uniform(-0.5, 2.0);
    const auto section = plane_section(cone, {0, 0, 1}, distance);
    for (int k = 0; k < 100; ++k) {
      const Vec3d d = direction_in(cone);
      const Vec3d from = cone.radius_m * direction();
      const double t = (distance - from.z) / d.z;
      if (d.z <= 0.0 || t < 0.0) continue;
      ++met;
      ASSERT_TRUE(section.has_value());
      ASSERT_LE(glm::distance(from + t * d, section->center), section->radius_m + 1e-9);
    }
  }
  EXPECT_GT(met, 10000);
}

TEST_F(BeamCones, no_direction_that_leaves_the_plane_is_steeper_than_the_largest_slope) {
  const Vec3d n(0, 0, 1);
  int finite_across_plane = 0;
  for (int i = 0; i < 3000; ++i) {
    BeamCone cone;
    cone.axis = direction();
    cone.angle_rad = uniform(0.0, 1.5);
    const double turn = uniform(0.0, 2.0 * kPi);
    const Vec3d u(std::cos(turn), std::sin(turn), 0.0);
    const double slope = largest_slope(cone, u, n);
    const bool crosses = std::abs(cone.axis.z) < std::sin(cone.angle_rad);
    finite_across_plane += crosses && std::isfinite(slope) ? 1 : 0;
    for (int k = 0; k < 200; ++k) {
      const Vec3d d = direction_in(cone);
      if (d.z <= 0.0) continue;
      ASSERT_LE(glm::dot(u, d), slope * d.z + 1e-9 * (1.0 + std::abs(slope)));
    }
  }
  EXPECT_GT(finite_across_plane, 300);
}

TEST_F(BeamCones, the_largest_slope_of_a_cone_that_crosses_the_plane_is_that_of_its_outline) {
  // Towards −x, 0.1 rad over the plane and 0.3 rad wide: along +x the steepest ray is that of the
  // upper edge, 0.4 rad over the plane.
  BeamCone cone;
  cone.axis = {-std::cos(0.1), 0.0, std::sin(0.1)};
  cone.angle_rad = 0.3;
  EXPECT_NEAR(largest_slope(cone, {1, 0, 0}, {0, 0, 1}), -1.0 / std::tan(0.4), 1e-12);
  EXPECT_TRUE(std::isinf(largest_slope(cone, {-1, 0, 0}, {0, 0, 1})));
}

TEST_F(BeamCones, a_cone_of_one_direction_has_its_slope) {
  BeamCone cone;
  cone.axis = glm::normalize(Vec3d(2.0, 0.0, 1.0));
  EXPECT_NEAR(largest_slope(cone, {1, 0, 0}, {0, 0, 1}), 2.0, 1e-12);
}

}  // namespace
}  // namespace abbe
