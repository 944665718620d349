// A camera in a medium sees the radiance in that medium: n² L T of light from outside, L of what
// shines inside.

#include <gtest/gtest.h>

#include <cmath>

#include "abbe/image/exr/exr.h"
#include "abbe/integrate/start_media.h"
#include "abbe/optics/fresnel.h"
#include "support/scene_builder.h"

namespace abbe {
namespace {

constexpr double kWater = 1.333;
constexpr double kGlass = 1.5;

std::uint32_t lamp(Scene& scene) {
  return test::add(scene, test::emitter(Vec3f(1.0f)));
}

// A wall of 1 cd/m² across the view, which goes along −Z from the origin.
void add_wall(Scene& scene, double z) {
  test::add_square(scene, lamp(scene), 50.0, test::translation({0, 0, z}));
}

Scene view_of_wall(double z) {
  Scene scene;
  add_wall(scene, z);
  scene.cameras.push_back(test::orthographic_camera({0, 0, 0}, {0, 0, -1}, 1e-4, 1e-4));
  return scene;
}

Material water() {
  return test::glass(kWater);
}

// What the camera sees straight ahead over what it would see in air.
double seen(const Scene& scene, Mode mode = Mode::Spectral) {
  RenderSettings settings = test::small_settings();
  settings.mode = mode;
  const bool has_lines = mode == Mode::Spectral;
  if (has_lines) settings.wavelengths.exact_nm = {550.0};
  const std::string channel = has_lines ? spectral_channel_name(550.0) : "G";
  const auto value = [&](const Scene& shown) {
    return static_cast<double>(test::pixel(test::render(shown, settings).image, 4, 4, channel));
  };
  return value(scene) / value(view_of_wall(-3.0));
}

double transmittance(double n1, double n2) {
  return fresnel_dielectric(1.0, n2 / n1).transmittance();
}

// Single precision throughout, a few dozen roundings.
constexpr double kRounding = 1e-5;

TEST(CameraMedium, emitter_in_air_seen_from_water_has_the_radiance_in_water) {
  for (const Mode mode : {Mode::Spectral, Mode::Rgb, Mode::Rgb3}) {
    Scene scene = view_of_wall(-3.0);
    test::add_box_mesh(scene, test::add(scene, water()), Vec3d(1.0), Mat4d(1.0));
    // Straight through, and after every second reflection between the two sides.
    const double t = transmittance(kWater, 1.0);
    const double expected = kWater * kWater * t / (1.0 - (1.0 - t) * (1.0 - t));
    EXPECT_NEAR(seen(scene, mode), expected, kRounding * expected);
  }
}

TEST(CameraMedium, emitter_in_the_water_has_its_own_radiance) {
  Scene scene = view_of_wall(-0.5);
  test::add_box(scene, test::add(scene, water()), Vec3d(60.0, 60.0, 1.0), Mat4d(1.0));
  EXPECT_NEAR(seen(scene), 1.0, kRounding);
}

TEST(CameraMedium, water_absorbs_from_the_camera_on) {
  Scene scene = view_of_wall(-0.5);
  Material inky = water();
  inky.absorption_per_m = Spectrum::constant(2.0);
  test::add_box(scene, test::add(scene, inky), Vec3d(60.0, 60.0, 1.0), Mat4d(1.0));
  EXPECT_NEAR(seen(scene), std::exp(-1.0), kRounding);
}

TEST(CameraMedium, camera_in_nested_media_sees_from_the_innermost) {
  // In glass in water in air; the lamp in air, in the water, in the glass.
  const auto scene_with_lamp_at = [](double z) {
    Scene scene = view_of_wall(z);
    test::add_box(scene, test::add(scene, water()), {60, 60, 2.0}, Mat4d(1.0));
    test::add_box(scene, test::add(scene, test::glass(kGlass)), {55, 55, 1.0}, Mat4d(1.0));
    return scene;
  };
  // Both sides send back of what goes out: r1 at once, more from the water's far face.
  const double t1 = transmittance(kGlass, kWater), t2 = transmittance(kWater, 1.0);
  const double r1 = 1.0 - t1, r2 = 1.0 - t2;
  const double between = 1.0 / (1.0 - r1 * r2);
  const double side = r1 + t1 * t1 * r2 * between;
  EXPECT_NEAR(seen(scene_with_lamp_at(-0.5)), 1.0, kRounding);
  EXPECT_NEAR(seen(scene_with_lamp_at(-1.5)), std::pow(kGlass / kWater, 2) * t1 / (1.0 - r1 * side),
              2.0 * kRounding);
  EXPECT_NEAR(seen(scene_with_lamp_at(-3.0)),
              kGlass * kGlass * t1 * t2 * between / (1.0 - side * side), 3.0 * kRounding);
}

TEST(CameraMedium, camera_in_a_bubble_of_air_sees_as_in_air) {
  Scene scene = view_of_wall(-0.5);
  test::add_box(scene, test::add(scene, water()), {60, 60, 2.0}, Mat4d(1.0));
  test::add_box(scene, test::add(scene, test::glass(1.0)), {55, 55, 1.0}, Mat4d(1.0));
  EXPECT_NEAR(seen(scene), 1.0, kRounding);
}

TEST(CameraMedium, camera_below_an_open_surface_sees_from_the_water) {
  Scene scene = view_of_wall(-3.0);
  // Its front is away from the camera.
  test::add_square(scene, test::add(scene, water()), 50.0,
                   test::translation({0, 0, -1}) * test::rotation({0, 1, 0}, 180.0));
  EXPECT_NEAR(seen(scene), kWater * kWater * transmittance(kWater, 1.0), 2.0 * kRounding);
}

TEST(CameraMedium, middle_of_a_glass_ball_in_a_furnace_shines_n_squared) {
  // All rays from there meet the ball head on: what stays in comes back, R T + R² T + … = 1 − T.
  Scene scene;
  test::add_sphere(scene, lamp(scene), Vec3d(0.0), 10.0);
  test::add_sphere(scene, test::add(scene, test::glass(kGlass)), Vec3d(0.0), 1.0);
  scene.cameras.push_back(test::perspective_camera({0, 0, 0}, {0, 0, -1}, 60.0));
  EXPECT_NEAR(seen(scene), kGlass * kGlass, 1e-4);  // The cutoff leaves 1e-4 of the weight.
}

TEST(StartMedia, stack_is_that_of_the_bodies_around_outermost_first) {
  Scene scene;
  const std::uint32_t sea = test::add(scene, water());
  const std::uint32_t ball = test::add(scene, test::glass(kGlass));
  const std::uint32_t aside = test::add(scene, test::glass(1.7));
  test::add_box_mesh(scene, sea, Vec3d(2.0), Mat4d(1.0));
  test::add_sphere(scene, ball, Vec3d(0.0), 1.0);
  test::add_box_mesh(scene, aside, Vec3d(0.1), test::translation({1.5, 0, 0}));
  const LitWorld world = test::make_world(scene, test::small_settings());
  for (const Vec3f& direction : {Vec3f(1, 0, 0), Vec3f(-0.6f, 0.8f, 0), Vec3f(0, 0, 1)}) {
    MediumStack media = start_media(world, Vec3f(0.1f, 0.2f, 0.3f), direction);
    ASSERT_FALSE(media.empty());
    EXPECT_EQ(media.top(), ball);
    media.remove(ball);
    EXPECT_EQ(media.owner(), sea);
    media.remove(sea);
    EXPECT_TRUE(media.empty());
    EXPECT_EQ(start_media(world, Vec3f(-1.5f, 0, 0), direction).owner(), sea);
    EXPECT_TRUE(start_media(world, Vec3f(3.0f, 0, 0), direction).empty());
  }
}

}  // namespace
}  // namespace abbe
