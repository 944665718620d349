// Lamps with an extent, against closed forms and many small lamps.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "abbe/base/constants.h"
#include "support/image_difference.h"
#include "support/scene_builder.h"

namespace abbe {
namespace {

Scene floor_with(const Light& lamp, double side_m = 0.01) {
  Scene scene;
  test::add_square(scene, test::add(scene, test::matte(Vec3f(1.0f))), side_m,
                   test::rotation({1, 0, 0}, -90.0));
  scene.cameras.push_back(test::orthographic_camera({3, 1, 0}, {0, 0, 0}, 1e-4, 1e-4));
  scene.lights.push_back(lamp);
  return scene;
}

Light shining_down(const LampShape& shape, double height_m, double candela) {
  Light lamp = test::point_light({0, 0, 0}, candela);
  lamp.to_world = test::translation({0, height_m, 0}) * test::rotation({1, 0, 0}, -90.0);
  lamp.shape = shape;
  return lamp;
}

Image picture(const Scene& scene, int samples, std::uint32_t seed = 0, Vec2i size = {8, 8}) {
  RenderSettings settings = test::small_settings();
  settings.samples_per_pixel = samples;
  settings.size = size;
  settings.seed = seed;
  return test::render(scene, settings).image;
}

double seen(const Scene& scene, int samples = 64) {
  const Image image = picture(scene, samples);
  double sum = 0.0;
  for (int y = 0; y < 8; ++y) {
    for (int x = 0; x < 8; ++x) sum += static_cast<double>(test::pixel(image, x, y, "G"));
  }
  return sum / 64.0;
}

// Howell B-3, four times: a rectangle about the axis above the element.
double above(double half_a, double half_b, double c) {
  const double x = half_a / c, y = half_b / c;
  const double rx = std::sqrt(1.0 + x * x), ry = std::sqrt(1.0 + y * y);
  return 2.0 / kPi * (x / rx * std::atan(y / rx) + y / ry * std::atan(x / ry));
}

TEST(LampShapeTest, rectangle_disk_and_ball_have_their_form_factors) {
  const double candela = 10.0;
  const Scene rectangle = floor_with(shining_down(RectangleLamp{1.0, 0.6}, 0.8, candela));
  EXPECT_NEAR(seen(rectangle) / (candela / 0.6 * above(0.5, 0.3, 0.8)), 1.0, 1e-3);
  // Seen from above its middle: sin² of the half angle.
  const Scene disk = floor_with(shining_down(DiskLamp{0.5}, 0.8, candela));
  EXPECT_NEAR(seen(disk) / (candela / (kPi * 0.25) * 0.25 / (0.25 + 0.64)), 1.0, 2e-3);
  const Scene ball = floor_with(shining_down(SphereLamp{0.3}, 0.8, candela));
  EXPECT_NEAR(seen(ball) / (candela / (kPi * 0.09) * 0.09 / 0.64), 1.0, 1e-3);
}

TEST(LampShapeTest, disc_on_the_sky_has_the_illuminance_of_its_lamp) {
  Light sun = test::directional_light({0, -1, 0}, 100.0);
  sun.shape = SkyDisc{40.0};
  EXPECT_NEAR(seen(floor_with(sun)) / (100.0 / kPi), 1.0, 1e-3);
}

TEST(LampShapeTest, far_away_each_is_its_point) {
  for (const LampShape& shape :
       {LampShape(RectangleLamp{0.1, 0.2}), LampShape(DiskLamp{0.1}), LampShape(SphereLamp{0.1})}) {
    const Scene far = floor_with(shining_down(shape, 50.0, 1e5));
    EXPECT_NEAR(seen(far, 4) / (1e5 / 2500.0 / kPi), 1.0, 1e-4) << shape.index();
  }
}

TEST(LampShapeTest, cone_and_range_hold_for_it_and_nothing_comes_behind_a_flat_one) {
  Light lamp = shining_down(RectangleLamp{0.1, 0.1}, 0.8, 10.0);
  Scene scene = floor_with(lamp);
  scene.lights[0].range_m = 0.5;
  EXPECT_EQ(seen(scene, 4), 0.0);
  scene.lights[0] = lamp;
  scene.lights[0].type = LightType::Spot;
  scene.lights[0].inner_cone_rad = 0.1;
  scene.lights[0].outer_cone_rad = 0.2;
  EXPECT_NEAR(seen(scene, 4) / seen(floor_with(lamp), 4), 1.0, 1e-3);
  scene.lights[0].to_world = test::translation({0, 0.8, 0}) * test::rotation({1, 0, 0}, 90.0);
  EXPECT_EQ(seen(scene, 4), 0.0);
}

// Behind flat glass a small one shines as it does in the open, but for what the glass keeps.
TEST(LampShapeTest, flat_one_behind_glass_shines_to_its_side_by_lamberts_law) {
  for (const LampShape& shape : {LampShape(RectangleLamp{1e-3, 1e-3}), LampShape(DiskLamp{1e-3})}) {
    const auto through_pane = [&](double turn_deg, bool has_shape) {
      Light lamp = shining_down(shape, 0.8, 10.0);
      lamp.to_world = test::translation({0, 0.8, 0}) * test::rotation({0, 0, 1}, turn_deg) *
                      test::rotation({1, 0, 0}, -90.0);
      if (!has_shape) lamp.shape.reset();
      Scene scene = floor_with(lamp);
      // Seen from below the pane, whose sides send no light there.
      scene.cameras.front() = test::orthographic_camera({3, 0.3, 0}, {0, 0, 0}, 1e-4, 1e-4);
      test::add_box(scene, test::add(scene, test::glass(1.5)), {0.5, 0.02, 0.5},
                    test::translation({0, 0.55, 0}));
      return seen(scene, 4);
    };
    for (const double turn_deg : {0.0, 30.0, 60.0, 85.0, 120.0, 180.0}) {
      const double expected = std::max(std::cos(glm::radians(turn_deg)), 0.0);
      // Light that the pane throws back and forth leaves at other angles: none here, straight
      // below.
      EXPECT_NEAR(through_pane(turn_deg, true) / through_pane(turn_deg, false), expected, 1e-3)
          << shape.index() << " " << turn_deg;
    }
  }
}

// A square lamp over a ball that hides part of it, and a surface of the same place and light.
TEST(LampShapeTest, soft_shadow_is_that_of_a_surface_that_shines_and_has_little_grain) {
  const auto shadowed = [](Scene scene) {
    test::add_sphere(scene, test::add(scene, test::matte(Vec3f(0.0f))), {0, 0.35, 0}, 0.2);
    scene.cameras[0] = test::orthographic_camera({0.9, 0.9, 0}, {0.25, 0, 0}, 0.5, 0.5);
    return scene;
  };
  const Scene soft = shadowed(floor_with(shining_down(RectangleLamp{0.5, 0.5}, 0.9, 10.0), 2.0));
  Scene shining = floor_with(shining_down(RectangleLamp{0.5, 0.5}, 0.9, 10.0), 2.0);
  shining.lights.clear();
  Material material = test::emitter(Vec3f(40.0f));
  material.lights_others = LightsOthers::Yes;
  test::add_square(shining, test::add(shining, material), 0.25,
                   test::translation({0, 0.9, 0}) * test::rotation({1, 0, 0}, 90.0));
  shining = shadowed(shining);
  const Image lamp = picture(soft, 64, 0, {16, 16});
  const Image again = picture(soft, 64, 5, {16, 16});
  const Image fine = picture(soft, 1024, 0, {16, 16});
  const Image emitter = picture(shining, 1024, 0, {16, 16});
  double sum = 0.0, difference = 0.0;
  for (int y = 0; y < 16; ++y) {
    for (int x = 0; x < 16; ++x) {
      sum += static_cast<double>(test::pixel(fine, x, y, "G"));
      difference += std::abs(static_cast<double>(test::pixel(fine, x, y, "G")) -
                             static_cast<double>(test::pixel(emitter, x, y, "G")));
    }
  }
  EXPECT_LT(difference / sum, 0.01);
  EXPECT_LT(test::mean_delta_e2000(lamp, again), 1.0);
}

// At five places from full shadow to full light, against the sum over a grid in double precision.
TEST(LampShapeTest, soft_shadow_is_that_of_4096_point_lamps) {
  constexpr int kGrid = 64;
  const Vec3d ball(0.0, 0.35, 0.0);
  const double radius_m = 0.2, candela = 10.0, height_m = 0.9;
  for (const double x : {0.05, 0.2, 0.3, 0.4, 0.7}) {
    const Vec3d place(x, 0.0, 0.02);
    double expected = 0.0;
    for (int i = 0; i < kGrid * kGrid; ++i) {
      const Vec3d lamp(0.5 * ((i % kGrid + 0.5) / kGrid - 0.5), height_m,
                       0.5 * ((i / kGrid + 0.5) / kGrid - 0.5));
      const Vec3d offset = lamp - place;
      const double distance_m = glm::length(offset);
      const double along = glm::dot(ball - place, offset) / distance_m;
      if (glm::distance(ball, place + along / distance_m * offset) < radius_m) continue;
      // Both planes are level: the same cosine twice.
      const double cosine = height_m / distance_m;
      expected += candela * cosine * cosine / (distance_m * distance_m) / (kGrid * kGrid);
    }
    Scene scene = floor_with(shining_down(RectangleLamp{0.5, 0.5}, height_m, candela), 2.0);
    test::add_sphere(scene, test::add(scene, test::matte(Vec3f(0.0f))), ball, radius_m);
    scene.cameras[0] = test::orthographic_camera(place + Vec3d(0.9, 0.4, 0.0), place, 1e-4, 1e-4);
    // 1 % of the light without the ball.
    EXPECT_NEAR(kPi * seen(scene), expected, 0.01 * candela / (height_m * height_m)) << x;
  }
}

}  // namespace
}  // namespace abbe
