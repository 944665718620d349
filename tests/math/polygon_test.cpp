// Convex polygons in space.

#include "abbe/math/polygon.h"

#include <gtest/gtest.h>

namespace abbe {
namespace {

TEST(Polygon, corner_that_rounding_has_made_two_of_clips_nothing_off) {
  const std::vector<Vec3d> square{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};
  for (const Vec3d& off :
       {Vec3d(1e-12, 1e-13, 0), Vec3d(-1e-12, 1e-12, 0), Vec3d(1e-13, -1e-11, 0)}) {
    std::vector<Vec3d> window{{-1, -1, 1}, {2, -1, 1}, {2, 2, 1}, {-1, 2, 1}};
    window.insert(window.begin() + 1, window.front() + off);
    const std::vector<Vec3d> left =
        clipped_by_shadow(square, without_short_edges(window, 1e-9), {0.0, 0.0, -1.0});
    EXPECT_NEAR(area_of(left), 1.0, 1e-9);
  }
}

TEST(Polygon, short_edges_go_wherever_a_polygon_begins) {
  std::vector<Vec3d> polygon{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};
  for (std::size_t k = 0; k < polygon.size(); ++k) {
    std::vector<Vec3d> doubled = polygon;
    doubled.insert(doubled.begin() + static_cast<long>(k), doubled[k] + Vec3d(0, 1e-12, 0));
    EXPECT_EQ(without_short_edges(doubled, 1e-9).size(), 4u) << k;
  }
  EXPECT_TRUE(without_short_edges({{0, 0, 0}, {1, 0, 0}, {1, 1e-12, 0}}, 1e-9).empty());
  EXPECT_EQ(without_short_edges(polygon, 1e-9), polygon);
}

}  // namespace
}  // namespace abbe
