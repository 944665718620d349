// Light of lamps with an extent through flat glass, against many point lamps.

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "abbe/base/constants.h"
#include "abbe/integrate/light/light_paths.h"
#include "abbe/world/light/lamp_places.h"
#include "support/scene_builder.h"

namespace abbe {
namespace {

enum class Glass { Pane, TiltedSlab, Prism };

// A matte floor at y = 0 under glass at y ≈ 0.5.
Scene under_glass(Glass glass, double index) {
  Scene scene;
  test::add_square(scene, test::add(scene, test::matte(Vec3f(1.0f))), 3.0,
                   test::rotation({1, 0, 0}, -90.0));
  const std::uint32_t material = test::add(scene, test::glass(index));
  if (glass == Glass::Prism) {
    test::add_prism(scene, material, 60.0, 0.5,
                    test::translation({0, 0.75, 0}) * test::rotation({0, 0, 1}, 20.0) *
                        test::rotation({1, 0, 0}, 90.0));
  } else {
    test::add_box(scene, material, {2.0, glass == Glass::Pane ? 0.02 : 0.1, 2.0},
                  test::translation({0, 0.5, 0}) *
                      test::rotation({0, 0, 1}, glass == Glass::Pane ? 0.0 : 15.0));
  }
  return scene;
}

Light lamp_of(const LampShape& shape) {
  const bool is_sun = std::holds_alternative<SkyDisc>(shape);
  Light lamp = is_sun ? test::directional_light({0, -1, 0}, 10.0) : test::point_light({}, 10.0);
  lamp.to_world = test::translation({0.1, 1.6, 0.05}) * test::rotation({0, 0, 1}, -12.0) *
                  test::rotation({1, 0, 0}, -90.0);
  lamp.shape = shape;
  return lamp;
}

const std::vector<LampShape> kShapes{RectangleLamp{0.5, 0.3}, DiskLamp{0.25}, SphereLamp{0.25},
                                     SkyDisc{12.0}};

// Sees a place of the floor from under the glass.
Camera camera_at(const Vec3d& place, double half_m) {
  return test::orthographic_camera(place + Vec3d(0, 0.2, 1.0), place, half_m, half_m);
}

RenderSettings settings_of(int samples) {
  RenderSettings settings = test::small_settings();
  settings.mode = Mode::Rgb;
  settings.samples_per_pixel = samples;
  // More of them bring little, and take most of the time.
  settings.inner_reflections = 1;
  return settings;
}

double mean_of(const Image& image) {
  double sum = 0.0;
  for (int y = 0; y < image.height; ++y) {
    for (int x = 0; x < image.width; ++x) {
      sum += static_cast<double>(test::pixel(image, x, y, "G"));
    }
  }
  return sum / (image.width * image.height);
}

// What lamps give a place of the floor, each by itself: in double precision, without the lanes of a
// render. `emits` is what a lamp sends in a direction, over its own intensity.
template <class Emits>
double lit_by(const LitWorld& world, const std::vector<Light>& lamps, const Vec3d& place,
              Emits&& emits) {
  double sum = 0.0;
  for (std::uint32_t number = 0; number < lamps.size(); ++number) {
    for (const LightChain& chain : chains_to_light(world, number, place, 0)) {
      for (const LightPath& path : chain.paths) {
        if (path.lane != 1) continue;
        const Vec3d leaves =
            path.crossings.empty() ? path.arrival : path.crossings.front().direction_before;
        sum += lamps[number].intensity * path.irradiance * emits(number, leaves) *
               std::max(-path.arrival.y, 0.0);
      }
    }
  }
  return sum / kPi;
}

// A grid of lamps for each shape: of a ball on its surface, where light leaves by Lambert's law.
struct Grid {
  std::vector<Light> lamps;
  std::vector<Vec3d> normals;  ///< Empty: they shine all around.
  double times = 1.0;          ///< Over the cosine with that.
};

Grid grid_of(const Light& lamp, int side) {
  Grid grid;
  const Vec3d x(lamp.to_world[0]), y(lamp.to_world[1]), z(lamp.to_world[2]);
  const int count = side * side;
  for (int i = 0; i < count; ++i) {
    const Vec2d u((i % side + 0.5) / side, (i / side + 0.5) / side);
    const double turn = 2.0 * kPi * u.y;
    Light one = lamp;
    one.shape.reset();
    one.intensity = lamp.intensity / count;
    Vec3d off(0.0);
    if (const auto* rectangle = std::get_if<RectangleLamp>(&*lamp.shape)) {
      off = (u.x - 0.5) * rectangle->width_m * x + (u.y - 0.5) * rectangle->height_m * y;
      grid.normals.push_back(-z);
    } else if (const auto* disk = std::get_if<DiskLamp>(&*lamp.shape)) {
      off = disk->radius_m * std::sqrt(u.x) * (std::cos(turn) * x + std::sin(turn) * y);
      grid.normals.push_back(-z);
    } else if (const auto* ball = std::get_if<SphereLamp>(&*lamp.shape)) {
      const double height = 2.0 * u.x - 1.0;
      const double across = std::sqrt(1.0 - height * height);
      const Vec3d normal = across * (std::cos(turn) * x + std::sin(turn) * y) + height * z;
      off = ball->radius_m * normal;
      grid.normals.push_back(normal);
      grid.times = 4.0;
    } else {
      const double half_rad = kPi / 360.0 * std::get<SkyDisc>(*lamp.shape).angle_deg;
      const double cosine = 1.0 - u.x * (1.0 - std::cos(half_rad));
      const double sine = std::sqrt(1.0 - cosine * cosine);
      const Vec3d back = sine * (std::cos(turn) * x + std::sin(turn) * y) + cosine * z;
      one.to_world = test::directional_light(-back, 1.0).to_world;
      // L·Ω over the illuminance of the disc on what faces it, L·π·sin².
      const double solid_angle = 2.0 * kPi * (1.0 - std::cos(half_rad));
      one.intensity *= solid_angle / (kPi * std::sin(half_rad) * std::sin(half_rad));
    }
    one.to_world[3] += Vec4d(off, 0.0);
    grid.lamps.push_back(one);
  }
  return grid;
}

// Along a row of places on the floor, over which the edges of the prism pass before the lamp.
TEST(LampThroughGlassTest, light_is_that_of_256_point_lamps) {
  for (const Glass glass : {Glass::Pane, Glass::TiltedSlab, Glass::Prism}) {
    for (const LampShape& shape : kShapes) {
      Scene scene = under_glass(glass, 1.5);
      const Light lamp = lamp_of(shape);
      const Grid grid = grid_of(lamp, 16);
      const auto emits = [&](std::uint32_t number, const Vec3d& leaves) {
        if (grid.normals.empty()) return 1.0;
        return grid.times * std::max(glm::dot(grid.normals[number], leaves), 0.0);
      };
      scene.cameras = {camera_at({}, 1.0)};
      scene.lights = grid.lamps;
      const LitWorld many = test::make_world(scene, settings_of(16));
      scene.lights = {lamp};
      const LitWorld one = test::make_world(scene, settings_of(16));
      double expected = 0.0, found = 0.0;
      for (int i = 0; i < 12; ++i) {
        const Vec3d place(-0.6 + 0.1 * i, 0.0, 0.02);
        expected += lit_by(many, grid.lamps, place, emits);
        found += mean_of(test::render(one, camera_at(place, 1e-4), settings_of(16)).image);
      }
      ASSERT_GT(expected, 0.0);
      // 16 places for what 256 tell. The edges of the prism pass each of them on the way, but a
      // step of the row is as wide as that of a place.
      EXPECT_NEAR(found / expected, 1.0, glass == Glass::Prism ? 0.02 : 0.01)
          << static_cast<int>(glass) << " shape " << shape.index();
    }
  }
}

// Over an area in which edges of light lie, sample by sample.
TEST(LampThroughGlassTest, light_is_the_mean_over_lamps_at_its_places) {
  for (const Glass glass : {Glass::Pane, Glass::Prism}) {
    for (const LampShape& shape : kShapes) {
      Scene scene = under_glass(glass, 1.5);
      test::add_box(scene, test::add(scene, test::matte(Vec3f(0.0f))), {0.1, 0.01, 0.1},
                    test::translation({0.0, 0.25, 0}));
      const Light lamp = lamp_of(shape);
      scene.lights = {lamp};
      scene.cameras = {camera_at({0.0, 0.0, 0.0}, 0.4)};
      const double found = mean_of(test::render(scene, settings_of(256)).image);
      scene.lights.clear();
      for (const LampPlace& place : lamp_places(lamp, 16)) {
        Light one = place.light;
        one.intensity *= place.times / 16.0;
        one.shape.reset();
        // So small that it is one place, and flat.
        if (shape.index() < 2) one.shape = DiskLamp{1e-7};
        scene.lights.push_back(one);
      }
      const double expected = mean_of(test::render(scene, settings_of(64)).image);
      // Edges of light in 64 pixels of 256 samples: a part of a sample for each pixel that they
      // cross. Beside the prism light comes straight, drawn from all of the lamp.
      EXPECT_NEAR(found / expected, 1.0, glass == Glass::Prism ? 0.01 : 0.005)
          << static_cast<int>(glass) << " shape " << shape.index();
    }
  }
}

// Glass that hardly bends light: the soft shadow is that of the lamp in the open, which is drawn by
// solid angle on all of it.
TEST(LampThroughGlassTest, soft_shadow_behind_glass_of_air_is_the_one_without_it) {
  for (const LampShape& shape : kShapes) {
    Scene scene = under_glass(Glass::Pane, 1.0001);
    test::add_box(scene, test::add(scene, test::matte(Vec3f(0.0f))), {0.15, 0.01, 0.15},
                  test::translation({0.0, 0.3, 0}));
    scene.lights = {lamp_of(shape)};
    scene.cameras = {camera_at({0.1, 0.0, 0.0}, 0.3)};
    const Image behind = test::render(scene, settings_of(64)).image;
    scene.instances.erase(scene.instances.begin() + 1);
    const Image open = test::render(scene, settings_of(256)).image;
    EXPECT_NEAR(mean_of(behind) / mean_of(open), 1.0, 0.01) << shape.index();
    double brightest = 0.0, difference = 0.0;
    for (int y = 0; y < 8; ++y) {
      for (int x = 0; x < 8; ++x) {
        const auto value = static_cast<double>(test::pixel(open, x, y, "G"));
        brightest = std::max(brightest, value);
        difference = std::max(
            difference, std::abs(value - static_cast<double>(test::pixel(behind, x, y, "G"))));
      }
    }
    // An edge crosses a pixel with the shadow of a place or two of 16 more or less.
    EXPECT_LT(difference, 2.0 / 16.0 * brightest) << shape.index();
  }
}

TEST(LampThroughGlassTest, picture_is_the_same_for_any_number_of_threads) {
  Scene scene = under_glass(Glass::Prism, 1.5);
  for (const LampShape& shape : kShapes) scene.lights.push_back(lamp_of(shape));
  scene.cameras = {camera_at({0.0, 0.0, 0.0}, 0.4)};
  RenderSettings settings = settings_of(4);
  settings.size = {33, 17};
  settings.threads = 1;
  const Image one = test::render(scene, settings).image;
  settings.threads = 3;
  const Image three = test::render(scene, settings).image;
  for (int y = 0; y < 17; ++y) {
    for (int x = 0; x < 33; ++x) {
      for (const char* channel : {"R", "G", "B"}) {
        ASSERT_EQ(test::pixel(one, x, y, channel), test::pixel(three, x, y, channel));
      }
    }
  }
}

}  // namespace
}  // namespace abbe
