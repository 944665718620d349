// Light on what touches flat glass, through thin layers, and from far away, against sums over all
// inner reflections.

#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "support/scene_builder.h"

namespace abbe {
namespace {

constexpr double kIndex = 1.5;

// Of a row of panes at normal incidence, all reflections between them counted.
double passed(int panes) {
  const double r = std::pow((kIndex - 1.0) / (kIndex + 1.0), 2.0);
  return (1.0 - r) / (1.0 + (2 * panes - 1) * r);
}

/// Lamps straight above: how far, or a parallel one.
struct Lamp {
  double height_m = 0.0;
  bool is_parallel() const { return height_m == 0.0; }
};

// A matte floor around a point, a lamp above it, and a camera that looks down on it.
Scene floor_scene(const Lamp& lamp, double camera_height_m) {
  Scene scene;
  test::add_square(scene, test::add(scene, test::matte(Vec3f(1.0f))), 1.0,
                   test::rotation({1, 0, 0}, -90.0));
  if (lamp.is_parallel()) {
    scene.lights.push_back(test::directional_light({0, -1, 0}, 1000.0));
  } else {
    scene.lights.push_back(
        test::point_light({0, lamp.height_m, 0}, 1000.0 * lamp.height_m * lamp.height_m));
  }
  scene.cameras.push_back(
      test::orthographic_camera({0.013, camera_height_m, -0.007}, {0.013, 0, -0.007}, 0.02, 0.02));
  return scene;
}

void add_pane(Scene& scene, double low_m, double high_m, double half_m = 0.5) {
  test::add_box_mesh(scene, test::add(scene, test::glass(kIndex)),
                     {half_m, 0.5 * (high_m - low_m), half_m},
                     test::translation({0, 0.5 * (high_m + low_m), 0}));
}

RenderSettings settings_of() {
  RenderSettings settings = test::small_settings();
  settings.mode = Mode::Rgb;
  return settings;
}

// Every pixel over what it is without glass and what is added to it.
void expect_share(const Scene& scene, double share, double tolerance, const std::string& what) {
  Scene bare = scene;
  bare.instances.resize(1);
  const Image seen = test::render(scene, settings_of()).image;
  const Image open = test::render(bare, settings_of()).image;
  for (std::size_t i = 0; i < seen.pixels.size(); ++i) {
    const double ratio = static_cast<double>(seen.pixels[i]) / static_cast<double>(open.pixels[i]);
    ASSERT_NEAR(ratio, share, tolerance) << what << ", pixel value " << i;
  }
}

// A scene as it is, turned as one, and made small.
void move(Scene& scene, const Mat4d& by) {
  for (Instance& instance : scene.instances) instance.to_world = by * instance.to_world;
  for (Light& light : scene.lights) light.to_world = by * light.to_world;
  for (Camera& camera : scene.cameras) camera.to_world = by * camera.to_world;
}

TEST(Touching, glass_on_a_floor_lights_it_from_lamps_of_all_kinds_however_it_is_turned) {
  for (const double height_m : {0.0, 1000.0}) {
    for (const double turn_deg : {0.0, 37.0, 111.0}) {
      Scene scene = floor_scene({height_m}, 2.0);
      add_pane(scene, 0.0, 0.1, 0.1);
      move(scene, test::rotation(glm::normalize(Vec3d(1, 2, 3)), turn_deg));
      // Light goes down through the glass, and up to the camera. Rays of the lamp are up to 2e-5
      // from parallel, and the last inner reflections go unfollowed.
      expect_share(scene, passed(1) * passed(1), 1e-3,
                   "lamp " + std::to_string(height_m) + ", turned " + std::to_string(turn_deg));
    }
  }
}

TEST(Touching, far_lamps_light_what_glass_stands_on_as_the_sun_does) {
  RenderSettings settings = settings_of();
  settings.drop = true;  // Also of faint paths none is left to chance.
  const auto shares = [&](const Vec3d& up, double distance_m) {
    Scene scene = floor_scene({}, 2.0);
    if (distance_m > 0.0) {
      scene.lights = {test::point_light(distance_m * up, 1000.0 * distance_m * distance_m)};
    } else {
      scene.lights = {test::directional_light(-up, 1000.0)};
    }
    Scene bare = scene;
    add_pane(scene, 0.0, 0.02, 0.1);
    const Image seen = test::render(scene, settings).image;
    const Image open = test::render(bare, settings).image;
    std::vector<double> ratios;
    for (std::size_t i = 0; i < seen.pixels.size(); ++i) {
      ratios.push_back(static_cast<double>(seen.pixels[i]) / static_cast<double>(open.pixels[i]));
    }
    return ratios;
  };
  for (const Vec3d& towards : {Vec3d(0.4, 1.0, 0.2), Vec3d(3.0, 1.0, 1.0)}) {
    const Vec3d up = glm::normalize(towards);
    const std::vector<double> sun = shares(up, 0.0);
    // At 72° from the normal single precision of lanes ends before a kilometre.
    const bool is_steep = towards.y > towards.x;
    for (const double distance_m : {60.0, 240.0, 1000.0, 20000.0}) {
      if (distance_m > 300.0 && !is_steep) continue;
      const std::vector<double> lamp = shares(up, distance_m);
      // Through the pane the lamp seems some millimetres nearer.
      for (std::size_t i = 0; i < sun.size(); ++i) {
        EXPECT_NEAR(lamp[i], sun[i], 1e-3) << distance_m << " m, towards " << towards.x;
      }
    }
  }
}

TEST(Touching, what_lies_on_glass_shades_what_is_behind_it) {
  for (const double height_m : {0.0, 5.0, 300.0}) {
    for (const double on_m : {0.2, 0.21, 0.2101}) {
      Scene scene = floor_scene({height_m}, 0.1);
      add_pane(scene, 0.2, 0.21);
      test::add_square(scene, test::add(scene, test::matte(Vec3f(0.5f))), 0.5,
                       test::translation({0, on_m, 0}) * test::rotation({1, 0, 0}, -90.0));
      expect_share(scene, 0.0, 0.0,
                   "lamp " + std::to_string(height_m) + ", at " + std::to_string(on_m));
    }
  }
}

TEST(Touching, rows_of_panes_pass_the_light_of_lamps_near_and_far) {
  for (const double height_m : {0.0, 11.0, 4000.0}) {
    for (const double gap_m : {1e-6, 1e-5, 1e-3, 1e-2}) {
      Scene scene = floor_scene({height_m}, 0.1);
      add_pane(scene, 0.2, 0.21);
      add_pane(scene, 0.21 + gap_m, 0.22 + gap_m);
      // Near lamps: the glass brings them nearer by a part of its thickness, once more on each way
      // back and forth.
      const double nearer = height_m > 0.0 ? 2.0 * 0.02 / (3.0 * height_m) : 0.0;
      expect_share(scene, passed(2) * (1.0 + nearer), 1e-3,
                   "lamp " + std::to_string(height_m) + ", gap " + std::to_string(gap_m));
    }
  }
}

}  // namespace
}  // namespace abbe
