/// Solids that stand alone, and packets that say which one they start in.
#include "abbe/accel/leaf/isolated_solids.h"

#include <gtest/gtest.h>

#include <vector>

#include "accel/worlds.h"

namespace abbe::test {
namespace {

World floor_at(float height) {
  World world;
  world.add_triangle({-5, height, -5}, {5, height, -5}, {0, height, 9});
  return world;
}

TEST(IsolatedSolids, sphere_above_a_floor_is_alone_and_one_that_rests_on_it_is_not) {
  World apart = floor_at(-0.01f);
  apart.add_ellipsoid({0, 1, 0}, Vec3d(1.0));
  EXPECT_EQ(find_isolated_solids(apart.spans()), std::vector<std::uint8_t>{1});
  World touching = floor_at(0.0f);
  touching.add_ellipsoid({0, 1, 0}, Vec3d(1.0));
  EXPECT_EQ(find_isolated_solids(touching.spans()), std::vector<std::uint8_t>{0});
}

TEST(IsolatedSolids, floor_that_only_meets_the_box_of_a_sphere_leaves_it_alone) {
  World world;
  // A slanted triangle across a corner of the sphere's bounds.
  world.add_triangle({1.5f, 1.5f, -1}, {1.5f, 0.5f, 2}, {0.5f, 1.5f, 2});
  world.add_ellipsoid({0, 0, 0}, Vec3d(1.0));
  EXPECT_EQ(find_isolated_solids(world.spans()), std::vector<std::uint8_t>{1});
}

TEST(IsolatedSolids, box_with_a_bubble_is_not_alone_but_boxes_a_gap_apart_are) {
  World world;
  world.add_ellipsoid({0.5, 0.5, 0.5}, Vec3d(0.1));
  world.add_box_solid({0, 0, 0}, {1, 1, 1});
  world.add_box_solid({1.001, 0, 0}, {2, 1, 1});
  // The bubble lies in the box's space, too.
  EXPECT_EQ(find_isolated_solids(world.spans()), (std::vector<std::uint8_t>{0, 0, 1}));
}

class PacketsInSolids : public EveryAccelerator {};
ABBE_FOR_EVERY_ACCELERATOR(PacketsInSolids);

TEST_P(PacketsInSolids, packets_that_name_their_solid_get_the_same_answers) {
  Random random(5);
  World world = floor_at(-1.5f);
  world.add_ellipsoid({-2, 0, 0}, {1.0, 0.7, 0.8});
  world.add_ellipsoid({0.5, 0.1, 0}, Vec3d(0.2));  // Inside the box that follows: not alone.
  world.add_box_solid({0, -1, -1}, {1, 1, 1});
  world.add_box_solid({2, -1, -1}, {3, 1, 1});
  ASSERT_EQ(find_isolated_solids(world.spans()), (std::vector<std::uint8_t>{1, 0, 0, 1}));
  const auto accelerator = build(world);
  const std::vector<Vec3f> centers{{-2, 0, 0}, {0.5f, 0.1f, 0}, {0.5f, -0.5f, 0}, {2.5f, 0, 0}};
  for (int i = 0; i < 400; ++i) {
    const auto solid = static_cast<std::uint32_t>(i % 4);
    std::vector<Ray> rays;
    for (int lane = 0; lane < 1 + i % 16; ++lane) {
      const Vec3f origin = centers[solid] + random.in_cube(0.1f);
      const float end = i % 5 == 0 ? random.uniform(0.1f, 1.5f) : kInfinity;
      rays.push_back({origin, end, random.direction()});
    }
    std::vector<RayPacket> packets(2, make_packet(rays));
    packets[1].inside = 1 + solid;
    std::vector<HitPacket> hits(2);
    accelerator->closest_hits(packets, kAllBits, hits);
    for (int lane = 0; lane < kPacketLanes; ++lane) {
      EXPECT_TRUE(is_same(lane_of(hits[0], lane), lane_of(hits[1], lane)))
          << i << ' ' << lane << ' ' << text_of(lane_of(hits[0], lane)) << ' '
          << text_of(lane_of(hits[1], lane));
    }
  }
}

}  // namespace
}  // namespace abbe::test
