/// The tree against brute force: random worlds, every form of query, masks, the empty world.
#include "abbe/accel/kd/tree.h"

#include <gtest/gtest.h>

#include "abbe/base/parallel.h"
#include "accel/brute_force.h"
#include "accel/worlds.h"

namespace abbe::test {
namespace {

TEST(KdTree, empty_world_is_never_hit) {
  Random random(1);
  const World world;
  const KdTree built = KdTree::build(world.spans());
  expect_right_answers(world, built, random_rays(random, 64));
  const KdTree unbuilt;
  expect_right_answers(world, unbuilt, random_rays(random, 64));
  EXPECT_TRUE(built.bounds().is_empty());
}

TEST(KdTree, random_triangles_agree_with_brute_force) {
  for (const int count : {1, 2, 16, 17, 100, 1000, 4000}) {
    for (const float size : {0.02f, 0.5f}) {
      SCOPED_TRACE(testing::Message() << count << " triangles of size " << size);
      Random random(static_cast<unsigned>(count));
      const World world = random_triangles(random, count, size);
      expect_right_answers(world, KdTree::build(world.spans()), random_rays(random, 2000));
    }
  }
}

TEST(KdTree, solids_among_triangles_agree_with_brute_force) {
  Random random(7);
  World world = random_triangles(random, 300, 0.2f);
  for (int i = 0; i < 40; ++i) {
    world.add_ellipsoid(Vec3d(random.in_cube(1.0f)),
                        Vec3d(0.2) + 0.15 * Vec3d(random.in_cube(1.0f)));
  }
  for (int i = 0; i < 20; ++i) {
    const Vec3d low(random.in_cube(1.0f));
    world.add_box_solid(low, low + Vec3d(0.15) + 0.1 * Vec3d(random.in_cube(1.0f)));
  }
  expect_right_answers(world, KdTree::build(world.spans()), random_rays(random, 4000));
}

TEST(KdTree, meshes_among_loose_triangles_and_solids_agree_with_brute_force) {
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
  expect_right_answers(world, KdTree::build(world.spans()), random_rays(random, 4000));
}

// Faces with normals of their own have vertices of their own, at the same positions.
TEST(KdTree, vertices_are_shared_by_position) {
  const World smooth = closed_sphere(5, Vec3f(0.0f), 1.0f, 0.01f);
  World flat, loose;
  for (const Triangle& t : smooth.triangles) {
    const Vec3f a = smooth.positions[t[0]], b = smooth.positions[t[1]], c = smooth.positions[t[2]];
    flat.add_triangle(a, b, c);
    const Vec3f middle = (a + b + c) / 3.0f;
    loose.add_triangle(middle + 0.95f * (a - middle), middle + 0.95f * (b - middle),
                       middle + 0.95f * (c - middle));
  }
  const std::size_t smooth_bytes = KdTree::build(smooth.spans()).bytes();
  const std::size_t loose_bytes = KdTree::build(loose.spans()).bytes();
  EXPECT_EQ(KdTree::build(flat.spans()).bytes(), smooth_bytes);
  // Separate corners are 36 bytes of a triangle; of shared ones there is one for two triangles.
  EXPECT_LT(smooth_bytes, loose_bytes);
  EXPECT_LT(loose_bytes, loose.triangles.size() * 100);
}

TEST(KdTree, cost_of_a_query_counts_the_triangles_that_are_there) {
  World world;
  for (int i = 0; i < 3; ++i) {
    const float z = static_cast<float>(i);
    world.add_triangle({-1, -1, z}, {1, -1, z}, {0, 1, z});
  }
  KdTreeConfig one_leaf;
  one_leaf.leaf_size = 3;
  const KdTree tree = KdTree::build(world.spans(), one_leaf);
  QueryCost met, missed;
  EXPECT_TRUE(
      tree.closest_hit_with_cost({{0, 0, -5}, kInfinity, {0, 0, 1}}, kAllBits, met).is_hit());
  EXPECT_EQ(met.primitives, 3u);
  EXPECT_FALSE(
      tree.closest_hit_with_cost({{9, 0, -5}, kInfinity, {0, 0, 1}}, kAllBits, missed).is_hit());
  EXPECT_EQ(missed.primitives, 0u);
}

TEST(KdTree, masked_primitives_are_passed_through) {
  Random random(11);
  World world = random_triangles(random, 500, 0.4f);
  for (int i = 0; i < 20; ++i) world.add_ellipsoid(Vec3d(random.in_cube(1.0f)), Vec3d(0.2));
  for (std::size_t i = 0; i < world.spans().primitive_count(); ++i) {
    world.masks.push_back(i % 3 == 0   ? kOpaqueBit
                          : i % 3 == 1 ? kTransparentBit
                                       : VisibilityMask{0});
  }
  const KdTree tree = KdTree::build(world.spans());
  const std::vector<Ray> rays = random_rays(random, 2000);
  for (const VisibilityMask mask : {kOpaqueBit, kTransparentBit, kAllBits, VisibilityMask{4}}) {
    SCOPED_TRACE(testing::Message() << "mask " << int{mask});
    expect_right_answers(world, tree, rays, mask);
  }
}

TEST(KdTree, mask_that_shares_a_bit_with_all_primitives_sees_all) {
  Random random(12);
  World world = random_triangles(random, 500, 0.4f);
  for (int i = 0; i < 20; ++i) world.add_ellipsoid(Vec3d(random.in_cube(1.0f)), Vec3d(0.2));
  for (std::size_t i = 0; i < world.spans().primitive_count(); ++i) {
    world.masks.push_back(i % 2 == 0 ? kOpaqueBit : kTransparentBit);
  }
  const KdTree tree = KdTree::build(world.spans());
  const std::vector<Ray> rays = random_rays(random, 2000);
  constexpr auto kBoth = static_cast<VisibilityMask>(kOpaqueBit | kTransparentBit);
  for (const VisibilityMask mask : {kOpaqueBit, kBoth, kAllBits}) {
    SCOPED_TRACE(testing::Message() << "mask " << int{mask});
    expect_right_answers(world, tree, rays, mask);
  }
}

TEST(KdTree, every_configuration_gives_right_answers) {
  Random random(9);
  const World world = random_triangles(random, 3000, 0.1f);
  const std::vector<Ray> rays = random_rays(random, 1000);
  KdTreeConfig eager, lazy, coarse, shallow, capped;
  eager.traversal_cost = 0.1f;
  eager.empty_bonus = 0.5f;
  eager.block_size = 1;
  eager.exact_limit = 100000;
  lazy.leaf_size = 200;
  coarse.bins = 2;
  coarse.exact_limit = 0;
  shallow.max_depth = 3;
  capped.max_build_primitives = 1.0f;
  for (const KdTreeConfig& config : {eager, lazy, coarse, shallow, capped}) {
    expect_right_answers(world, KdTree::build(world.spans(), config), rays, kAllBits, 100);
  }
  EXPECT_LT(KdTree::build(world.spans(), lazy).bytes(), KdTree::build(world.spans()).bytes());
}

TEST(KdTree, tree_does_not_depend_on_the_number_of_threads) {
  const World world = closed_sphere(5, Vec3f(0.3f), 1.0f, 0.01f);
  Random random(5);
  const std::vector<Ray> rays = random_rays(random, 4000);
  std::vector<Hit> one(rays.size()), many(rays.size());
  std::size_t bytes = 0;
  {
    const ThreadLimit limit(1);
    const KdTree tree = KdTree::build(world.spans());
    bytes = tree.bytes();
    tree.closest_hits(rays, kAllBits, one);
  }
  const KdTree tree = KdTree::build(world.spans());
  EXPECT_EQ(tree.bytes(), bytes);
  tree.closest_hits(rays, kAllBits, many);
  for (std::size_t i = 0; i < rays.size(); ++i) EXPECT_TRUE(is_same(one[i], many[i]));
}

TEST(KdTree, inactive_lanes_answer_nothing_and_change_nothing) {
  Random random(13);
  const World world = random_triangles(random, 1000, 0.3f);
  const KdTree tree = KdTree::build(world.spans());
  const std::vector<Ray> rays = random_rays(random, 1600);
  for (std::size_t p = 0; p < rays.size() / 16; ++p) {
    RayPacket packet = make_packet(std::span(rays).subspan(p * 16, 16));
    HitPacket all, some;
    tree.closest_hits({&packet, 1}, kAllBits, {&all, 1});
    packet.active =
        p % 4 == 0 ? 0u : 1u << (p % 16) | static_cast<std::uint32_t>(random.below(65536));
    for (int lane = 0; lane < kPacketLanes; ++lane) {
      // What an inactive lane holds must not matter.
      if ((packet.active >> lane & 1u) == 0) packet.direction_x[lane] = std::nanf("");
    }
    std::uint32_t occluded = 0;
    tree.closest_hits({&packet, 1}, kAllBits, {&some, 1});
    tree.any_hits({&packet, 1}, kAllBits, {&occluded, 1});
    for (int lane = 0; lane < kPacketLanes; ++lane) {
      const bool is_active = (packet.active >> lane & 1u) != 0;
      EXPECT_TRUE(is_same(lane_of(some, lane), is_active ? lane_of(all, lane) : Hit{}));
      EXPECT_EQ((occluded >> lane & 1u) != 0, is_active && lane_of(all, lane).is_hit());
    }
  }
}

}  // namespace
}  // namespace abbe::test
