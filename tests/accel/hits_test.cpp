/// Every accelerator against the judge: random worlds, every form of query, masks, the empty world.
#include <gtest/gtest.h>

#include "abbe/base/error.h"
#include "accel/judge.h"
#include "accel/worlds.h"

namespace abbe::test {
namespace {

class Hits : public EveryAccelerator {};
ABBE_FOR_EVERY_ACCELERATOR(Hits);

World triangles_and_solids(Random& random) {
  World world = random_triangles(random, 300, 0.2f);
  for (int i = 0; i < 40; ++i) {
    world.add_ellipsoid(Vec3d(random.in_cube(1.0f)),
                        Vec3d(0.2) + 0.15 * Vec3d(random.in_cube(1.0f)));
  }
  for (int i = 0; i < 20; ++i) {
    const Vec3d low(random.in_cube(1.0f));
    world.add_box_solid(low, low + Vec3d(0.15) + 0.1 * Vec3d(random.in_cube(1.0f)));
  }
  return world;
}

TEST(Accelerators, unknown_name_lists_the_valid_ones) {
  try {
    build_accelerator("octree", {});
    FAIL() << "no error";
  } catch (const Error& error) {
    EXPECT_EQ(error.detail().kind, ErrorKind::Usage);
    EXPECT_EQ(error.detail().choices, accelerator_names());
    EXPECT_NE(std::string(error.what()).find("octree"), std::string::npos);
  }
}

TEST(Accelerators, all_answer_alike_to_the_bit) {
  Random random(3);
  World world = triangles_and_solids(random);
  for (std::size_t i = 0; i < world.spans().primitive_count(); ++i) {
    world.masks.push_back(i % 3 == 0 ? kOpaqueBit : kTransparentBit);
  }
  for (std::size_t i = 0; i < world.triangles.size(); ++i)
    world.front_only.push_back(i % 2 == 0 ? 1 : 0);
  std::vector<Ray> rays = random_rays(random, 4000);
  make_directions_awkward(random, rays);
  const auto first = build_accelerator(accelerator_names().front(), world.spans());
  std::vector<Hit> expected(rays.size()), hits(rays.size());
  HitLists expected_lists, lists;
  first->closest_hits(rays, kAllBits, expected);
  first->all_hits(rays, kAllBits, kOpaqueBit, expected_lists);
  for (const std::string& name : accelerator_names()) {
    SCOPED_TRACE(name);
    const auto accelerator = build_accelerator(name, world.spans());
    accelerator->closest_hits(rays, kAllBits, hits);
    accelerator->all_hits(rays, kAllBits, kOpaqueBit, lists);
    EXPECT_EQ(accelerator->bounds().low, first->bounds().low);
    EXPECT_EQ(accelerator->bounds().high, first->bounds().high);
    EXPECT_EQ(accelerator->name(), name);
    EXPECT_GE(accelerator->rays_worth_a_call(), 1u);
    for (std::size_t i = 0; i < rays.size(); ++i) {
      EXPECT_TRUE(is_same(hits[i], expected[i]));
      EXPECT_TRUE(std::equal(lists[i].begin(), lists[i].end(), expected_lists[i].begin(),
                             expected_lists[i].end(), is_same));
    }
  }
}

TEST_P(Hits, empty_world_is_never_hit) {
  Random random(1);
  const World world;
  const auto accelerator = build(world);
  expect_right_answers(world, *accelerator, random_rays(random, 64));
  EXPECT_TRUE(accelerator->bounds().is_empty());
}

TEST_P(Hits, random_triangles_agree_with_the_judge) {
  for (const int count : {1, 2, 16, 17, 100, 1000, 4000}) {
    for (const float size : {0.02f, 0.5f}) {
      SCOPED_TRACE(testing::Message() << count << " triangles of size " << size);
      Random random(static_cast<unsigned>(count));
      const World world = random_triangles(random, count, size);
      expect_right_answers(world, *build(world), random_rays(random, 2000));
    }
  }
}

TEST_P(Hits, solids_among_triangles_agree_with_the_judge) {
  Random random(7);
  const World world = triangles_and_solids(random);
  expect_right_answers(world, *build(world), random_rays(random, 4000));
}

TEST_P(Hits, meshes_among_loose_triangles_and_solids_agree_with_the_judge) {
  Random random(17);
  World world = random_triangles(random, 700, 0.1f);
  for (const float x : {-0.6f, 0.5f}) {
    const World mesh = closed_sphere(3, Vec3f(x, 0.1f, 0.2f), 0.4f, 0.02f);
    const auto first = static_cast<std::uint32_t>(world.positions.size());
    world.positions.insert(world.positions.end(), mesh.positions.begin(), mesh.positions.end());
    for (const Triangle& t : mesh.triangles) {
      world.triangles.push_back({t[0] + first, t[1] + first, t[2] + first});
    }
  }
  for (int i = 0; i < 10; ++i) world.add_ellipsoid(Vec3d(random.in_cube(0.8f)), Vec3d(0.15));
  expect_right_answers(world, *build(world), random_rays(random, 4000));
}

TEST_P(Hits, masked_primitives_are_passed_through) {
  Random random(11);
  World world = random_triangles(random, 500, 0.4f);
  for (int i = 0; i < 20; ++i) world.add_ellipsoid(Vec3d(random.in_cube(1.0f)), Vec3d(0.2));
  for (std::size_t i = 0; i < world.spans().primitive_count(); ++i) {
    world.masks.push_back(i % 3 == 0   ? kOpaqueBit
                          : i % 3 == 1 ? kTransparentBit
                                       : VisibilityMask{0});
  }
  const auto accelerator = build(world);
  const std::vector<Ray> rays = random_rays(random, 2000);
  for (const VisibilityMask mask : {kOpaqueBit, kTransparentBit, kAllBits, VisibilityMask{4}}) {
    SCOPED_TRACE(testing::Message() << "mask " << int{mask});
    expect_right_answers(world, *accelerator, rays, mask);
  }
}

TEST_P(Hits, triangles_of_one_side_are_not_there_from_behind) {
  Random random(21);
  World world = random_triangles(random, 500, 0.4f);
  for (int i = 0; i < 20; ++i) world.add_ellipsoid(Vec3d(random.in_cube(1.0f)), Vec3d(0.2));
  for (std::size_t i = 0; i < world.triangles.size(); ++i) {
    world.front_only.push_back(i % 3 == 0 ? 0 : 1);
  }
  for (std::size_t i = 0; i < world.spans().primitive_count(); ++i) {
    world.masks.push_back(i % 2 == 0 ? kOpaqueBit : kTransparentBit);
  }
  std::vector<Ray> rays = random_rays(random, 2000);
  make_directions_awkward(random, rays);
  const auto accelerator = build(world);
  for (const QueryMask sides : {QueryMask{0}, kCullBack, kCullFront}) {
    for (const VisibilityMask bits : {kOpaqueBit, kAllBits}) {
      const auto mask = static_cast<QueryMask>(bits | sides);
      SCOPED_TRACE(testing::Message() << "mask " << int{mask});
      expect_right_answers(world, *accelerator, rays, mask);
      expect_right_lists(world, *accelerator, rays, mask, kOpaqueBit);
    }
  }
}

TEST_P(Hits, closed_mesh_of_one_side_is_seen_from_outside_and_not_from_inside) {
  World world = closed_sphere(3, Vec3f(0.0f), 1.0f, 0.0f);
  world.front_only.assign(world.triangles.size(), 1);
  Random random(5);
  std::vector<Ray> from_outside, from_inside;
  for (int i = 0; i < 512; ++i) {
    const Vec3f direction = random.direction();
    from_outside.push_back({-3.0f * direction, kInfinity, direction});
    from_inside.push_back({0.2f * random.in_cube(1.0f), kInfinity, direction});
  }
  const auto accelerator = build(world);
  std::vector<Hit> hits(from_outside.size());
  const auto ask = [&](const std::vector<Ray>& rays, QueryMask sides) {
    accelerator->closest_hits(rays, static_cast<QueryMask>(kAllBits | sides), hits);
  };
  ask(from_outside, kCullBack);
  for (const Hit& hit : hits) EXPECT_NEAR(hit.t, 2.0f, 0.01f);  // Facets are within 1 % of it.
  ask(from_inside, kCullBack);
  for (const Hit& hit : hits) EXPECT_FALSE(hit.is_hit()) << text_of(hit);
  // Light that comes the other way meets what it meets from the front.
  ask(from_outside, kCullFront);
  for (const Hit& hit : hits) EXPECT_NEAR(hit.t, 4.0f, 0.01f);
  ask(from_inside, kCullFront);
  for (const Hit& hit : hits) EXPECT_TRUE(hit.is_hit());
}

TEST_P(Hits, mask_that_shares_a_bit_with_all_primitives_sees_all) {
  Random random(12);
  World world = random_triangles(random, 500, 0.4f);
  for (int i = 0; i < 20; ++i) world.add_ellipsoid(Vec3d(random.in_cube(1.0f)), Vec3d(0.2));
  for (std::size_t i = 0; i < world.spans().primitive_count(); ++i) {
    world.masks.push_back(i % 2 == 0 ? kOpaqueBit : kTransparentBit);
  }
  const auto accelerator = build(world);
  const std::vector<Ray> rays = random_rays(random, 2000);
  constexpr auto kBoth = static_cast<VisibilityMask>(kOpaqueBit | kTransparentBit);
  for (const VisibilityMask mask : {kOpaqueBit, kBoth, kAllBits}) {
    SCOPED_TRACE(testing::Message() << "mask " << int{mask});
    expect_right_answers(world, *accelerator, rays, mask);
  }
}

TEST_P(Hits, inactive_lanes_answer_nothing_and_change_nothing) {
  Random random(13);
  const World world = random_triangles(random, 1000, 0.3f);
  const auto accelerator = build(world);
  const std::vector<Ray> rays = random_rays(random, 1600);
  for (std::size_t p = 0; p < rays.size() / 16; ++p) {
    RayPacket packet = make_packet(std::span(rays).subspan(p * 16, 16));
    HitPacket all, some;
    accelerator->closest_hits({&packet, 1}, kAllBits, {&all, 1});
    packet.active =
        p % 4 == 0 ? 0u : 1u << (p % 16) | static_cast<std::uint32_t>(random.below(65536));
    for (int lane = 0; lane < kPacketLanes; ++lane) {
      // What an inactive lane holds must not matter.
      if ((packet.active >> lane & 1u) == 0) packet.direction_x[lane] = std::nanf("");
    }
    std::uint32_t occluded = 0;
    accelerator->closest_hits({&packet, 1}, kAllBits, {&some, 1});
    accelerator->any_hits({&packet, 1}, kAllBits, {&occluded, 1});
    for (int lane = 0; lane < kPacketLanes; ++lane) {
      const bool is_active = (packet.active >> lane & 1u) != 0;
      EXPECT_TRUE(is_same(lane_of(some, lane), is_active ? lane_of(all, lane) : Hit{}));
      EXPECT_EQ((occluded >> lane & 1u) != 0, is_active && lane_of(all, lane).is_hit());
    }
  }
}

}  // namespace
}  // namespace abbe::test
