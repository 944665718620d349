/// Lists of all hits: what stops them, coincident faces, solids, masks.
#include <gtest/gtest.h>

#include "accel/judge.h"
#include "accel/worlds.h"

namespace abbe::test {
namespace {

class AllHits : public EveryAccelerator {
 protected:
  // The numbers of the primitives that a ray meets, in order.
  static std::vector<std::uint32_t> met(const World& world, const Ray& ray,
                                        VisibilityMask mask = kAllBits, VisibilityMask stops = 0) {
    HitLists lists;
    build(world)->all_hits({&ray, 1}, mask, stops, lists);
    std::vector<std::uint32_t> primitives;
    for (const Hit& hit : lists[0]) primitives.push_back(hit.primitive);
    return primitives;
  }
};
ABBE_FOR_EVERY_ACCELERATOR(AllHits);

using Numbers = std::vector<std::uint32_t>;

void add_pane(World& world, float z) {
  world.add_triangle({-1, -1, z}, {1, -1, z}, {0, 1, z});
}

constexpr Ray kAlongZ{{0.0f, 0.0f, -1.0f}, kInfinity, {0.0f, 0.0f, 1.0f}};

TEST_P(AllHits, panes_are_met_from_the_nearest_to_the_end_of_the_ray) {
  World world;
  for (const float z : {3.0f, 1.0f, 2.0f, 4.0f}) add_pane(world, z);
  EXPECT_EQ(met(world, kAlongZ), (Numbers{1, 2, 0, 3}));
  EXPECT_EQ(met(world, {kAlongZ.origin, 4.0f, kAlongZ.direction}), (Numbers{1, 2}));
  EXPECT_EQ(met(world, {kAlongZ.origin, kInfinity, {0, 0, -1}}), Numbers{});
}

TEST_P(AllHits, list_ends_with_the_first_primitive_that_stops) {
  World world;
  for (const float z : {3.0f, 1.0f, 2.0f, 4.0f}) add_pane(world, z);
  world.masks = {kOpaqueBit, kTransparentBit, kTransparentBit, kOpaqueBit};
  EXPECT_EQ(met(world, kAlongZ, kAllBits, kOpaqueBit), (Numbers{1, 2, 0}));
  EXPECT_EQ(met(world, kAlongZ, kAllBits, kTransparentBit), Numbers{1});
  // What the mask does not show does not stop either.
  EXPECT_EQ(met(world, kAlongZ, kTransparentBit, kOpaqueBit), (Numbers{1, 2}));
}

TEST_P(AllHits, masks_that_are_all_the_same_stop_alike) {
  World world;
  for (const float z : {2.0f, 1.0f}) add_pane(world, z);
  world.masks = {kTransparentBit, kTransparentBit};
  EXPECT_EQ(met(world, kAlongZ, kAllBits, kOpaqueBit), (Numbers{1, 0}));
  EXPECT_EQ(met(world, kAlongZ, kAllBits, kTransparentBit), Numbers{1});
}

TEST_P(AllHits, faces_in_contact_are_in_the_order_of_their_numbers) {
  World world;
  for (int i = 0; i < 40; ++i) add_pane(world, i < 20 ? 1.0f : 2.0f);
  Numbers all(40);
  for (std::uint32_t i = 0; i < 40; ++i) all[i] = i;
  EXPECT_EQ(met(world, kAlongZ), all);
  world.masks.assign(40, kTransparentBit);
  world.masks[7] = kOpaqueBit;
  EXPECT_EQ(met(world, kAlongZ, kAllBits, kOpaqueBit), (Numbers{0, 1, 2, 3, 4, 5, 6, 7}));
}

TEST_P(AllHits, solid_is_entered_and_left) {
  World world;
  world.add_ellipsoid({0, 0, 3}, {1, 1, 2});
  world.add_box_solid({-1, -1, 2}, {1, 1, 4});
  HitLists lists;
  build(world)->all_hits({&kAlongZ, 1}, kAllBits, 0, lists);
  ASSERT_EQ(lists[0].size(), 4u);
  const float t[4] = {2.0f, 3.0f, 5.0f, 6.0f};
  const std::uint32_t primitive[4] = {0, 1, 1, 0};
  for (std::size_t i = 0; i < 4; ++i) {
    EXPECT_EQ(lists[0][i].primitive, primitive[i]);
    EXPECT_NEAR(lists[0][i].t, t[i], 1e-6f);  // Rounded once to float.
  }
  // The faces of the box at its lower and its upper z.
  EXPECT_EQ(lists[0][1].u, 5.0f);
  EXPECT_EQ(lists[0][2].u, 4.0f);
  // From inside they are only left.
  const Ray inside{{0, 0, 3}, kInfinity, {0, 0, 1}};
  EXPECT_EQ(met(world, inside), (Numbers{1, 0}));
}

TEST_P(AllHits, solid_that_stops_is_met_once) {
  World world;
  world.add_box_solid({-1, -1, 2}, {1, 1, 4});
  world.add_box_solid({-1, -1, 4}, {1, 1, 5});
  world.masks = {kTransparentBit, kOpaqueBit};
  // In contact: the first is left where the second is entered.
  EXPECT_EQ(met(world, kAlongZ, kAllBits, kOpaqueBit), (Numbers{0, 0, 1}));
}

TEST_P(AllHits, random_worlds_with_stops_agree_with_the_judge) {
  Random random(21);
  World world = closed_sphere(3, Vec3f(0.1f), 0.8f, 0.05f);
  for (const float radius : {0.5f, 0.3f}) {
    const World mesh = closed_sphere(2, Vec3f(0.1f), radius, 0.05f);
    const auto first = static_cast<std::uint32_t>(world.positions.size());
    world.positions.insert(world.positions.end(), mesh.positions.begin(), mesh.positions.end());
    for (const Triangle& t : mesh.triangles) {
      world.triangles.push_back({t[0] + first, t[1] + first, t[2] + first});
    }
  }
  for (int i = 0; i < 30; ++i) world.add_ellipsoid(Vec3d(random.in_cube(0.8f)), Vec3d(0.15));
  for (int i = 0; i < 10; ++i) {
    const Vec3d low(random.in_cube(0.8f));
    world.add_box_solid(low, low + Vec3d(0.2));
  }
  for (std::size_t i = 0; i < world.spans().primitive_count(); ++i) {
    world.masks.push_back(random.below(10) == 0 ? kOpaqueBit : kTransparentBit);
  }
  const auto accelerator = build(world);
  std::vector<Ray> rays = random_rays(random, 2000);
  make_directions_awkward(random, rays);
  const std::vector<Ray> at_edges = rays_at_edges(random, world, Vec3f(0.1f), 0.2f, 1600);
  rays.insert(rays.end(), at_edges.begin(), at_edges.end());
  for (const VisibilityMask stops : {VisibilityMask{0}, kOpaqueBit, kTransparentBit}) {
    for (const VisibilityMask mask : {kTransparentBit, kAllBits}) {
      SCOPED_TRACE(testing::Message() << "stops " << int{stops} << " mask " << int{mask});
      expect_right_lists(world, *accelerator, rays, mask, stops, 400);
    }
  }
}

TEST_P(AllHits, lists_are_those_of_the_last_call) {
  World world;
  add_pane(world, 1.0f);
  const auto accelerator = build(world);
  HitLists lists;
  const std::vector<Ray> rays(3, kAlongZ);
  accelerator->all_hits(rays, kAllBits, 0, lists);
  accelerator->all_hits(std::span(rays).first(2), kAllBits, 0, lists);
  ASSERT_EQ(lists.size(), 2u);
  EXPECT_EQ(lists[1].size(), 1u);
}

}  // namespace
}  // namespace abbe::test
