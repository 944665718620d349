// What lies in a body of glass, and what only on it.

#include <gtest/gtest.h>

#include <cstdint>

#include "abbe/caustics/flat/bodies.h"
#include "support/scene_builder.h"

namespace abbe {
namespace {

struct Found {
  bool any = false, lit = false;
  bool operator==(const Found&) const = default;
};

// A box of glass with edges of 1 m about the origin, and what `add` puts next to it; all turned.
template <typename Add>
Found inclusions(const Add& add, bool is_turned) {
  Scene scene;
  scene.name = "test";
  test::add_box_mesh(scene, test::add(scene, test::glass(1.5)), {0.5, 0.5, 0.5}, Mat4d(1.0));
  scene.instances.back().name = "box";
  add(scene);
  const Mat4d turn = is_turned ? test::rotation({0.3, 0.5, 0.8}, 77.0) : Mat4d(1.0);
  for (Instance& instance : scene.instances) instance.to_world = turn * instance.to_world;
  Notes notes;
  const FlatBodies flat = find_flat_bodies(scene, notes);
  EXPECT_EQ(flat.bodies.at(0).name, "box");
  return {flat.bodies[0].has_inclusions, flat.bodies[0].has_lit_inclusions};
}

class Inclusions : public testing::TestWithParam<bool> {};

// A matte floor at a height.
auto floor_at(double y) {
  return [y](Scene& scene) {
    test::add_square(scene, test::add(scene, test::matte(Vec3f(1.0f))), 20.0,
                     test::translation({0, y, 0}) * test::rotation({1, 0, 0}, -90.0));
  };
}

TEST_P(Inclusions, floor_that_a_body_stands_on_is_not_in_it) {
  EXPECT_EQ(inclusions(floor_at(-0.5), GetParam()), (Found{false, false}));
}

TEST_P(Inclusions, floor_that_a_body_sinks_into_is_in_it) {
  EXPECT_EQ(inclusions(floor_at(-0.49997), GetParam()), (Found{true, true}));
}

TEST_P(Inclusions, room_of_one_mesh_is_not_in_a_body_that_stands_in_it) {
  const auto room = [](Scene& scene) {
    test::add_box_mesh(scene, test::add(scene, test::matte(Vec3f(1.0f))), {4, 2, 4},
                       test::translation({0.3, 1.5, 0.2}));
  };
  EXPECT_EQ(inclusions(room, GetParam()), (Found{false, false}));
}

TEST_P(Inclusions, ball_beside_a_body_is_not_in_it_and_one_that_reaches_in_is) {
  const auto ball_at = [](double x) {
    return [x](Scene& scene) {
      test::add_sphere(scene, test::add(scene, test::matte(Vec3f(1.0f))), {x, 0.1, 0}, 0.25);
    };
  };
  EXPECT_EQ(inclusions(ball_at(0.7500001), GetParam()), (Found{false, false}));
  EXPECT_EQ(inclusions(ball_at(0.7499), GetParam()), (Found{true, true}));
}

TEST_P(Inclusions, smooth_glass_in_glass_is_in_it_but_shows_no_light) {
  const auto inner = [](Scene& scene) {
    test::add_box(scene, test::add(scene, test::glass(1.2)), {0.125, 0.125, 0.125},
                  test::translation({0.1, 0.2, 0}));
  };
  EXPECT_EQ(inclusions(inner, GetParam()), (Found{true, false}));
}

TEST_P(Inclusions, bead_in_glass_in_glass_is_in_both) {
  const auto both = [](Scene& scene) {
    test::add_box(scene, test::add(scene, test::glass(1.2)), {0.125, 0.125, 0.125},
                  test::translation({0.1, 0.2, 0}));
    test::add_sphere(scene, test::add(scene, test::matte(Vec3f(1.0f))), {0.1, 0.2, 0}, 0.05);
  };
  EXPECT_EQ(inclusions(both, GetParam()), (Found{true, true}));
}

TEST_P(Inclusions, glass_in_contact_is_not_in_it) {
  const auto neighbour = [](Scene& scene) {
    test::add_box(scene, test::add(scene, test::glass(1.3)), {0.5, 0.5, 0.5},
                  test::translation({1, 0, 0}));
  };
  EXPECT_EQ(inclusions(neighbour, GetParam()), (Found{false, false}));
}

INSTANTIATE_TEST_SUITE_P(AsBuiltAndTurned, Inclusions, testing::Bool());

}  // namespace
}  // namespace abbe
