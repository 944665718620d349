// Which primitives may touch those of other bodies.
#include "abbe/accel/touching.h"

#include <gtest/gtest.h>

#include <random>

#include "judge.h"

namespace abbe {
namespace {

// Boxes of twelve triangles and squares of two, a surface each unless told otherwise.
struct Scene {
  std::vector<Vec3f> positions;
  std::vector<Triangle> triangles;
  std::vector<std::uint32_t> surface;
  std::vector<std::uint8_t> matters;

  std::size_t add_surface(bool does_matter) {
    matters.push_back(does_matter);
    return matters.size() - 1;
  }
  void add_box(std::size_t to, const Vec3f& low, const Vec3f& high) {
    const auto first = static_cast<std::uint32_t>(positions.size());
    for (std::uint32_t i = 0; i < 8; ++i) {
      positions.emplace_back((i & 1u) ? high.x : low.x, (i & 2u) ? high.y : low.y,
                             (i & 4u) ? high.z : low.z);
    }
    for (const auto& [a, b, c, d] : std::vector<std::array<std::uint32_t, 4>>{
             {0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}}) {
      triangles.push_back({first + a, first + b, first + c});
      triangles.push_back({first + a, first + c, first + d});
    }
    surface.resize(triangles.size(), static_cast<std::uint32_t>(to));
  }
  std::vector<Touching> found() const {
    return find_touching({.positions = positions, .triangles = triangles}, surface, matters, 1e-6f);
  }
  // The size of each primitive that may touch others.
  std::vector<float> touching() const {
    std::vector<float> sizes;
    for (const Touching& at : found()) sizes.push_back(at.size_m);
    return sizes;
  }
};

std::size_t count(const std::vector<float>& flags, std::size_t begin, std::size_t end) {
  std::size_t set = 0;
  for (std::size_t i = begin; i < end; ++i) set += flags[i] > 0.0f ? 1 : 0;
  return set;
}

TEST(Touching, bodies_apart_inside_each_other_and_in_a_room_touch_nothing) {
  Scene scene;
  scene.add_box(scene.add_surface(false), Vec3f(-10), Vec3f(10));
  scene.add_box(scene.add_surface(true), Vec3f(0), Vec3f(1));
  scene.add_box(scene.add_surface(true), Vec3f(0.25f), Vec3f(0.75f));
  scene.add_box(scene.add_surface(true), Vec3f(1.1f), Vec3f(2));
  EXPECT_TRUE(scene.touching().empty());
}

TEST(Touching, faces_and_edges_of_a_cube_on_a_floor_may_touch_and_its_top_may_not) {
  Scene scene;
  scene.add_box(scene.add_surface(false), Vec3f(-10), Vec3f(10, 10, 0));
  scene.add_box(scene.add_surface(true), Vec3f(0), Vec3f(1));
  const std::vector<float> flags = scene.touching();
  ASSERT_EQ(flags.size(), 24u);
  EXPECT_EQ(count(flags, 12, 24), 10u);  // All but the two triangles of its top.
  EXPECT_GT(count(flags, 0, 12), 0u);
  EXPECT_EQ(flags[12], 10.0f);  // Of the floor, whose rounding is the larger.
  // Of two surfaces that do not matter, nobody asks.
  scene.matters[1] = 0;
  EXPECT_TRUE(scene.touching().empty());
}

TEST(Touching, zone_is_where_they_do) {
  Scene scene;
  scene.add_box(scene.add_surface(false), Vec3f(-10), Vec3f(10, 10, 0));
  scene.add_box(scene.add_surface(true), Vec3f(0), Vec3f(1));
  const std::vector<Touching> found = scene.found();
  for (std::size_t i = 12; i < 24; ++i) {
    if (!found[i].is_any()) continue;
    EXPECT_TRUE(found[i].holds({0.5f, 0.5f, 0.0f}, 1.0f) || found[i].zone.size().x < 0.5f ||
                found[i].zone.size().y < 0.5f);
    EXPECT_FALSE(found[i].holds({0.5f, 0.5f, 0.02f}, 1.0f));
    EXPECT_TRUE(found[i].holds(found[i].zone.high, 0.0f));
  }
}

TEST(Touching, pieces_of_one_surface_may_touch) {
  Scene scene;
  const std::size_t glass = scene.add_surface(true);
  scene.add_box(glass, Vec3f(0), Vec3f(1));
  EXPECT_TRUE(scene.touching().empty());
  scene.add_box(glass, Vec3f(1.0000005f, 0.1f, 0.1f), Vec3f(2));
  EXPECT_GT(count(scene.touching(), 0, 24), 0u);
}

// Which of some primitives, a body each, may touch another.
std::vector<float> touching_in(const test::World& world) {
  const std::size_t count = world.spans().primitive_count();
  std::vector<std::uint32_t> surfaces(count);
  for (std::uint32_t i = 0; i < count; ++i) surfaces[i] = i;
  std::vector<float> flags(count, 0.0f);
  const std::vector<Touching> found =
      find_touching(world.spans(), surfaces, std::vector<std::uint8_t>(count, 1), 1e-6f);
  for (std::size_t i = 0; i < found.size(); ++i) flags[i] = found[i].size_m;
  return flags;
}

TEST(Touching, hollow_solids_touch_what_reaches_their_surface_and_not_what_they_hold) {
  test::World world;
  world.add_ellipsoid({0, 0, 0}, {4, 4, 4});            // A room.
  world.add_box_solid({-5, -5, -5}, {5, 5, 5});         // One about it, 1 away.
  world.add_ellipsoid({0, 0, 0}, {1, 1, 1});            // In it.
  world.add_ellipsoid({0, 0, 3}, {0.5, 0.5, 1.01});     // Through its wall.
  world.add_ellipsoid({3.4, 3.4, 0}, {0.5, 0.5, 0.5});  // Beside it, if not beside its box.
  std::vector<float> flags = touching_in(world);
  // Ellipsoids come first, then solids.
  EXPECT_GT(flags[0], 0.0f);
  EXPECT_EQ(flags[1], 0.0f);
  EXPECT_GT(flags[2], 0.0f);
  EXPECT_EQ(flags[3], 0.0f);
  EXPECT_EQ(flags[4], 0.0f);
}

TEST(Touching, slope_touches_what_comes_down_to_it) {
  for (const double height : {0.0, 1e-3}) {
    test::World world;
    world.add_triangle({-10, -10, -10}, {10, -10, 10}, {0, 20, 0});  // z = x.
    world.add_box_solid({-1, -1, 1 + height}, {1, 1, 2});
    EXPECT_EQ(touching_in(world)[0] > 0.0f, height == 0.0) << height;
  }
}

TEST(Touching, every_pair_of_boxes_that_overlap_is_found) {
  std::mt19937 random(5);
  std::uniform_real_distribution<float> unit(0.0f, 1.0f);
  Scene scene;
  for (int i = 0; i < 200; ++i) {
    const Vec3f low(unit(random), unit(random), unit(random));
    scene.add_box(scene.add_surface(i % 3 == 0), low,
                  low + 0.1f * Vec3f(unit(random), unit(random), unit(random)) + 0.001f);
  }
  const std::vector<float> flags = scene.touching();
  const auto bounds = [&](std::size_t t) {
    Box3f box;
    for (const std::uint32_t corner : scene.triangles[t]) box.extend(scene.positions[corner]);
    return Box3f{box.low - 0.5e-6f, box.high + 0.5e-6f};
  };
  for (std::size_t a = 0; a < scene.triangles.size(); ++a) {
    bool is_near = false;
    const Box3f of_a = bounds(a);
    for (std::size_t b = 0; b < scene.triangles.size() && !is_near; ++b) {
      if (scene.surface[a] == scene.surface[b]) continue;
      if ((scene.matters[scene.surface[a]] | scene.matters[scene.surface[b]]) == 0) continue;
      const Box3f of_b = bounds(b);
      is_near = glm::all(glm::lessThanEqual(of_a.low, of_b.high)) &&
                glm::all(glm::lessThanEqual(of_b.low, of_a.high));
    }
    EXPECT_EQ(flags[a] > 0.0f, is_near) << a;
  }
}

}  // namespace
}  // namespace abbe
