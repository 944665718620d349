/// The tree against brute force: random worlds, every form of query, masks, the empty world.
#include "accel/kd_tree.h"

#include <gtest/gtest.h>

#include <random>

#include "accel/brute_force.h"

namespace abbe::test {
namespace {

class Random {
 public:
  explicit Random(unsigned seed) : engine_(seed) {}
  float uniform(float low, float high) {
    return std::uniform_real_distribution<float>(low, high)(engine_);
  }
  Vec3f in_cube(float half) {
    const float x = uniform(-half, half), y = uniform(-half, half), z = uniform(-half, half);
    return {x, y, z};
  }
  Vec3f direction() {
    while (true) {
      const Vec3f v = in_cube(1.0f);
      const float length = glm::length(v);
      if (length > 0.05f && length < 1.0f) return v / length;
    }
  }

 private:
  std::mt19937 engine_;
};

World random_triangles(Random& random, int count, float size) {
  World world;
  for (int i = 0; i < count; ++i) {
    const Vec3f center = random.in_cube(1.0f);
    world.add_triangle(center + random.in_cube(size), center + random.in_cube(size),
                       center + random.in_cube(size));
  }
  return world;
}

// Four kinds of neighbours: unrelated, one origin, one origin and nearly one direction, and nearly
// one origin and direction.
std::vector<Ray> random_rays(Random& random, int count) {
  std::vector<Ray> rays;
  for (int i = 0; i < count; i += 16) {
    const Vec3f origin = random.in_cube(1.5f);
    const Vec3f direction = random.direction();
    const int kind = i / 16 % 4;
    const float t_max = i / 64 % 2 == 0 ? kInfinity : random.uniform(0.1f, 2.0f);
    for (int lane = 0; lane < 16 && i + lane < count; ++lane) {
      Ray ray{origin, t_max, direction};
      if (kind == 0) ray.origin = random.in_cube(1.5f);
      if (kind == 3) ray.origin += random.in_cube(0.01f);
      if (kind < 2) ray.direction = random.direction();
      if (kind >= 2) ray.direction = glm::normalize(direction + random.in_cube(0.01f));
      rays.push_back(ray);
    }
  }
  return rays;
}

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

}  // namespace
}  // namespace abbe::test
