#include "abbe/math/spherical_triangle.h"

#include <gtest/gtest.h>

#include <cmath>

#include "abbe/base/constants.h"

namespace abbe {
namespace {

TEST(SphericalTriangle, octant_and_small_triangle_have_their_angles) {
  EXPECT_NEAR(solid_angle({1, 0, 0}, {0, 3, 0}, {0, 0, 0.5}), kPi / 2.0, 1e-14);
  // Half a square millimetre seen square-on from a metre: its area, but for its own 1e-6 of it.
  EXPECT_NEAR(solid_angle({0, 0, 1}, {1e-3, 0, 1}, {0, 1e-3, 1}) / 0.5e-6, 1.0, 2e-6);
  EXPECT_EQ(solid_angle({0, 0, 1}, {0, 0, 2}, {0, 1, 1}), 0.0);
}

// By its moment: the mean direction of a spherical triangle is half the sum over its sides of the
// side's length times the normal of its plane, over the area (Stokes).
TEST(SphericalTriangle, directions_fill_it_evenly) {
  const Vec3d corners[][3] = {{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}},
                              {{0.1, 0.2, 1}, {0.4, -0.3, 0.7}, {-1, 0.1, 0.2}},
                              {{3, 0.01, 1}, {3, 0.02, 1.01}, {3, -0.01, 1.1}}};
  for (const auto& c : corners) {
    const double area = solid_angle(c[0], c[1], c[2]);
    Vec3d stokes(0.0);
    for (int k = 0; k < 3; ++k) {
      const Vec3d a = glm::normalize(c[k]), b = glm::normalize(c[(k + 1) % 3]);
      const Vec3d across = glm::cross(a, b);
      const double sine = glm::length(across);
      stokes += 0.5 * std::atan2(sine, glm::dot(a, b)) / sine * across;
    }
    if (glm::dot(stokes, c[0]) < 0.0) stokes = -stokes;
    Vec3d mean(0.0);
    constexpr int kSide = 400;
    for (int i = 0; i < kSide; ++i) {
      for (int j = 0; j < kSide; ++j) {
        const Vec3d way =
            direction_to_triangle(c[0], c[1], c[2], {(i + 0.5) / kSide, (j + 0.5) / kSide});
        // Inside: on the inner side of all planes.
        for (int k = 0; k < 3; ++k) {
          const Vec3d side = glm::cross(c[k], c[(k + 1) % 3]);
          EXPECT_GE(glm::dot(side, way) * glm::dot(side, c[(k + 2) % 3]), -1e-12);
        }
        mean += way / (1.0 * kSide * kSide);
      }
    }
    // The midpoint rule's (1/400)².
    EXPECT_LT(glm::length(mean - stokes / area), 2e-5);
  }
}

}  // namespace
}  // namespace abbe
