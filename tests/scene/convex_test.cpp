#include "abbe/scene/convex.h"

#include <gtest/gtest.h>

#include <cmath>

namespace abbe {
namespace {

ConvexShape cube() {
  return {{{1, 0, 0, 1}, {-1, 0, 0, 1}, {0, 1, 0, 1}, {0, -1, 0, 1}, {0, 0, 1, 1}, {0, 0, -1, 1}}};
}

TEST(corners_of, cube_has_eight) {
  const std::vector<Vec3d> corners = corners_of(cube());
  ASSERT_EQ(corners.size(), 8u);
  for (const Vec3d& corner : corners) {
    EXPECT_NEAR(glm::length(corner), std::sqrt(3.0), 1e-12);  // A few roundings.
  }
}

TEST(corners_of, cut_off_corner_is_replaced_by_three) {
  ConvexShape cut = cube();
  cut.planes.push_back({1, 1, 1, 2.5});
  EXPECT_EQ(corners_of(cut).size(), 10u);
}

TEST(corners_of, size_of_the_body_does_not_matter) {
  for (const double scale : {1e-6, 1e6}) {
    ConvexShape scaled = cube();
    for (Vec4d& plane : scaled.planes) plane.w *= scale;
    EXPECT_EQ(corners_of(scaled).size(), 8u) << scale;
  }
}

TEST(corners_of, contradicting_planes_have_none) {
  ConvexShape empty = cube();
  empty.planes.push_back({1, 0, 0, -2});
  EXPECT_TRUE(corners_of(empty).empty());
}

TEST(is_bounded, closed_bodies_are) {
  EXPECT_TRUE(is_bounded(cube()));
  EXPECT_TRUE(is_bounded({{{1, 1, 1, 1}, {-1, 0, 0, 0}, {0, -1, 0, 0}, {0, 0, -1, 0}}}));
}

TEST(is_bounded, slabs_wedges_and_tubes_are_not) {
  EXPECT_FALSE(is_bounded({{{1, 0, 0, 1}, {-1, 0, 0, 1}}}));
  EXPECT_FALSE(is_bounded({{{1, 0, 0, 1}, {0, 1, 0, 1}, {0, 0, 1, 1}}}));
  ConvexShape tube = cube();
  tube.planes.resize(4);
  EXPECT_FALSE(is_bounded(tube));
  ConvexShape open_box = cube();
  open_box.planes.pop_back();
  EXPECT_FALSE(is_bounded(open_box));
}

}  // namespace
}  // namespace abbe
