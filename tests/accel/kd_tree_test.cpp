/// What only the k-d tree promises: its memory, its configurations, its cost.
#include "abbe/accel/kd/tree.h"

#include <gtest/gtest.h>

#include "abbe/base/parallel.h"
#include "accel/judge.h"
#include "accel/worlds.h"

namespace abbe::test {
namespace {

TEST(KdTree, tree_that_was_not_built_is_never_hit) {
  Random random(1);
  expect_right_answers(World{}, KdTree(), random_rays(random, 64));
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

}  // namespace
}  // namespace abbe::test
