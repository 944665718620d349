// Light of surfaces that shine, against form factors.

#include <gtest/gtest.h>

#include <cmath>

#include "abbe/base/constants.h"
#include "support/scene_builder.h"

namespace abbe {
namespace {

constexpr double kLuminance = 5.0;

// A white floor at the origin, seen from above through what shines or beside it.
Scene floor_seen_from(const Vec3d& eye) {
  Scene scene;
  scene.emissive_light = true;
  test::add_square(scene, test::add(scene, test::matte(Vec3f(1.0f))), 0.01,
                   test::rotation({1, 0, 0}, -90.0));
  scene.cameras.push_back(test::orthographic_camera(eye, {0, 0, 0}, 1e-4, 1e-4));
  return scene;
}

std::uint32_t add_emitter(Scene& scene, bool two_sided = false) {
  Material material = test::emitter(Vec3f(static_cast<float>(kLuminance)));
  material.double_sided = two_sided;
  return test::add(scene, material);
}

double seen(const Scene& scene, int samples = 64) {
  RenderSettings settings = test::small_settings();
  settings.samples_per_pixel = samples;
  const test::Rendered result = test::render(scene, settings);
  double sum = 0.0;
  for (int y = 0; y < 8; ++y) {
    for (int x = 0; x < 8; ++x) {
      sum += static_cast<double>(test::pixel(result.image, x, y, "G"));
    }
  }
  return sum / 64.0;
}

// From an element to a rectangle a × b at distance c parallel to it, with one corner above it.
// Source: Howell, A Catalog of Radiation Heat Transfer Configuration Factors, B-3.
double corner_above(double a, double b, double c) {
  const double x = a / c, y = b / c;
  const double rx = std::sqrt(1.0 + x * x), ry = std::sqrt(1.0 + y * y);
  return (x / rx * std::atan(y / rx) + y / ry * std::atan(x / ry)) / (2.0 * kPi);
}

// The same for a rectangle that stands upright on the element's plane, b wide and c high at a.
// Source: Howell, B-5.
double upright(double a, double b, double c) {
  const double r = std::sqrt(a * a + c * c);
  return (std::atan(b / a) - a / r * std::atan(b / r)) / (2.0 * kPi);
}

TEST(EmitterTest, square_above_lights_the_floor_by_its_form_factor) {
  Scene scene = floor_seen_from({3, 1, 0});
  test::add_square(scene, add_emitter(scene), 0.5,
                   test::translation({0, 0.8, 0}) * test::rotation({1, 0, 0}, 90.0));
  // 4096 samples of 4 spots, spread evenly by solid angle.
  EXPECT_NEAR(seen(scene) / (kLuminance * 4.0 * corner_above(0.5, 0.5, 0.8)), 1.0, 1e-3);
}

TEST(EmitterTest, upright_square_too_and_nothing_comes_from_its_back) {
  Scene scene = floor_seen_from({3, 1, 0});
  const std::uint32_t shining = add_emitter(scene);
  const Mat4d stands = test::translation({0, 0.5, -0.7});
  test::add_square(scene, shining, 0.5, stands);
  const double expected = kLuminance * 2.0 * upright(0.7, 0.5, 1.0);
  EXPECT_NEAR(seen(scene) / expected, 1.0, 1.5e-3);
  scene.instances.back().to_world = stands * test::rotation({0, 1, 0}, 180.0);
  EXPECT_EQ(seen(scene), 0.0);
  scene.materials[shining].double_sided = true;
  EXPECT_NEAR(seen(scene) / expected, 1.0, 1.5e-3);
}

// Shadow rays start off a large triangle by its bound, and must not overshoot what they ask.
// A room of 2 m with a lamp that hangs just below the middle of its ceiling.
TEST(EmitterTest, lamp_in_a_room_lights_floor_and_wall_by_its_form_factors) {
  const double gap_m = 1e-3, half_m = 0.4;
  Scene room = floor_seen_from({0.3, 0.5, 0});
  Material matte = test::matte(Vec3f(1.0f));
  matte.double_sided = true;
  test::add_box_mesh(room, test::add(room, matte), {1, 1, 1}, test::translation({0, 1, 0}));
  room.instances.erase(room.instances.begin());
  test::add_square(room, add_emitter(room), half_m,
                   test::translation({0, 2.0 - gap_m, 0}) * test::rotation({1, 0, 0}, 90.0));
  const double on_floor = 4.0 * corner_above(half_m, half_m, 2.0 - gap_m);
  EXPECT_NEAR(seen(room) / (kLuminance * on_floor), 1.0, 1e-3);
  // The middle of a wall: seen from there the lamp lies level, from near to far above.
  room.cameras[0] = test::orthographic_camera({0.4, 0.9, 0.1}, {-1, 1, 0}, 1e-4, 1e-4);
  const double up_m = 1.0 - gap_m;
  const auto level = [&](double far_m) { return upright(up_m, half_m, far_m); };
  const double on_wall = 2.0 * (level(1.0 + half_m) - level(1.0 - half_m));
  EXPECT_NEAR(seen(room) / (kLuminance * on_wall), 1.0, 1e-3);
}

TEST(EmitterTest, large_floors_and_near_emitters_keep_all_light) {
  for (const double half_m : {0.5, 5.0, 500.0}) {
    for (const double height_m : {0.1, 1.0}) {
      Scene scene = floor_seen_from({3, 0.05, 0});
      scene.instances.clear();
      test::add_square(scene, 0, half_m, test::rotation({1, 0, 0}, -90.0));
      test::add_square(scene, add_emitter(scene), 0.5,
                       test::translation({0, height_m, 0}) * test::rotation({1, 0, 0}, 90.0));
      const double expected = kLuminance * 4.0 * corner_above(0.5, 0.5, height_m);
      EXPECT_NEAR(seen(scene) / expected, 1.0, 2e-3) << half_m << " " << height_m;
    }
  }
}

TEST(EmitterTest, what_shines_below_the_horizon_leaves_no_grain) {
  Scene scene = floor_seen_from({3, 1, 0});
  test::add_square(scene, add_emitter(scene), 0.5,
                   test::translation({0, 0.8, 0}) * test::rotation({1, 0, 0}, 90.0));
  Material bright = test::emitter(Vec3f(1e6f));
  test::add_square(scene, test::add(scene, bright), 0.5,
                   test::translation({0, -1, 0}) * test::rotation({1, 0, 0}, -90.0));
  EXPECT_NEAR(seen(scene) / (kLuminance * 4.0 * corner_above(0.5, 0.5, 0.8)), 1.0, 1e-3);
}

TEST(EmitterTest, ball_is_its_projected_cone) {
  Scene scene = floor_seen_from({3, 1, 0});
  test::add_sphere(scene, add_emitter(scene), {0.6, 0.8, 0.0}, 0.3);
  EXPECT_NEAR(seen(scene) / (kLuminance * 0.09 * 0.8), 1.0, 1e-3);
}

TEST(EmitterTest, inside_of_an_exact_shape_shines_as_it_is_seen_to) {
  Scene ball = floor_seen_from({0.3, 0.1, 0}), box = ball;
  test::add_sphere(ball, add_emitter(ball), {0, 0.1, 0}, 1.0);
  test::add_box(box, add_emitter(box), {1.0, 0.8, 0.6}, Mat4d(1.0));
  // A furnace: the hemisphere of a white floor is as bright as what is around it. Up to the noise
  // of 64 camera samples of four spots each for the faces of a box.
  EXPECT_NEAR(seen(ball) / kLuminance, 1.0, 2e-3);
  EXPECT_NEAR(seen(box) / kLuminance, 1.0, 5e-3);
}

TEST(EmitterTest, half_hidden_it_gives_half) {
  Scene scene = floor_seen_from({3, 1, 0});
  test::add_square(scene, add_emitter(scene), 0.5,
                   test::translation({0, 0.8, 0}) * test::rotation({1, 0, 0}, 90.0));
  Material screen = test::matte(Vec3f(0.0f));
  screen.double_sided = true;
  test::add_square(scene, test::add(scene, screen), 0.5,
                   test::translation({-0.5, 0.7, 0}) * test::rotation({1, 0, 0}, 90.0));
  // A shadow's edge through the middle: seven eighths of the rectangle's x are as bright, as it is
  // nearer; by symmetry the half on the one side is what is left.
  EXPECT_NEAR(seen(scene, 256) / (kLuminance * 2.0 * corner_above(0.5, 0.5, 0.8)), 1.0, 2e-3);
}

TEST(EmitterTest, off_it_lights_nothing_but_is_seen) {
  Scene scene = floor_seen_from({3, 1, 0});
  test::add_square(scene, add_emitter(scene), 0.5,
                   test::translation({0, 0.8, 0}) * test::rotation({1, 0, 0}, 90.0));
  scene.materials.back().lights_others = LightsOthers::No;
  EXPECT_EQ(seen(scene), 0.0);
  scene.cameras[0] = test::orthographic_camera({0, 0.5, 0}, {0, 1, 0.001}, 1e-4, 1e-4);
  EXPECT_NEAR(seen(scene, 4), kLuminance, 2e-3 * kLuminance);
}

// Its lobes see what shines by rays of their own, the floor's diffuse share is lit by spots:
// together as in an even furnace of that radiance.
TEST(EmitterTest, nothing_is_counted_twice) {
  for (const double roughness : {0.0, 0.3, 1.0}) {
    Scene scene = floor_seen_from({0, 1, 0.3});
    scene.materials[0].roughness = static_cast<float>(roughness);
    test::add_sphere(scene, add_emitter(scene, true), {0, 0, 0}, 50.0);
    const double all_around = seen(scene, 64);
    Scene even = floor_seen_from({0, 1, 0.3});
    even.materials[0].roughness = static_cast<float>(roughness);
    auto environment = std::make_shared<Environment>();
    environment->image.width = 8;
    environment->image.height = 4;
    environment->image.rgb_rec709.assign(32, Vec3f(static_cast<float>(kLuminance)));
    even.environment = environment;
    // Both by chance.
    EXPECT_NEAR(all_around / seen(even, 64), 1.0, 5e-3) << roughness;
  }
}

}  // namespace
}  // namespace abbe
