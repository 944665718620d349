// What is seen through bodies that touch, stand on something or overlap, against stacks of
// interfaces by Fresnel and Snell in double precision.

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <random>
#include <vector>

#include "support/scene_builder.h"

namespace abbe {
namespace {

RenderSettings settings_of() {
  RenderSettings settings = test::small_settings();
  settings.mode = Mode::Rgb;
  settings.max_depth = 256;
  settings.cutoff = 1e-7;
  settings.caustics = false;
  return settings;
}

Scene enclosure() {
  Scene scene;
  test::add_sphere(scene, test::add(scene, test::emitter(Vec3f(1.0f))), Vec3d(0.0), 50.0);
  scene.cameras.push_back(test::orthographic_camera({0.3, 0.4, 5}, {0, 0, 0}, 0.95, 0.95));
  return scene;
}

Material glass(double index, int priority) {
  Material material = test::glass(index);
  material.priority = static_cast<std::int16_t>(priority);
  return material;
}

Mat4d tilt() {
  return test::rotation(glm::normalize(Vec3d(1, 2, 3)), 35.0);
}

// Every pixel over what it is with nothing there.
std::vector<double> ratios(const Scene& scene, const RenderSettings& settings) {
  Scene empty = scene;
  empty.instances.resize(1);
  const test::Rendered seen = test::render(scene, settings);
  const test::Rendered background = test::render(empty, settings);
  std::vector<double> result;
  for (std::size_t i = 0; i < seen.image.pixels.size(); ++i) {
    result.push_back(static_cast<double>(seen.image.pixels[i]) /
                     static_cast<double>(background.image.pixels[i]));
  }
  return result;
}

void expect_invisible(const Scene& scene) {
  for (const double ratio : ratios(scene, settings_of())) {
    // What depth 256 and a cutoff of 1e-7 leave over, and roundings.
    EXPECT_NEAR(ratio, 1.0, 1e-3);
  }
}

using AddBox = void (*)(Scene&, std::uint32_t, const Vec3d&, const Mat4d&);
class ContactFurnace : public testing::TestWithParam<AddBox> {};

TEST_P(ContactFurnace, touching_panes_of_equal_and_of_different_glass) {
  for (const double other : {1.5, 1.8}) {
    Scene scene = enclosure();
    const std::uint32_t first = test::add(scene, test::glass(1.5));
    const std::uint32_t second = test::add(scene, test::glass(other));
    GetParam()(scene, first, {0.5, 0.4, 0.1}, tilt() * test::translation({0, 0, 0.1}));
    GetParam()(scene, second, {0.5, 0.4, 0.2}, tilt() * test::translation({0, 0, -0.2}));
    GetParam()(scene, first, {0.3, 0.4, 0.15}, tilt() * test::translation({0.8, 0, 0.05}));
    expect_invisible(scene);
  }
}

TEST_P(ContactFurnace, water_that_fills_a_vessel_with_a_cube_on_its_ground) {
  Scene scene = enclosure();
  const std::uint32_t glass = test::add(scene, test::glass(1.52));
  const std::uint32_t water = test::add(scene, test::glass(1.333));
  const std::uint32_t flint = test::add(scene, test::glass(1.7));
  const AddBox add_box = GetParam();
  const Mat4d at = tilt();
  add_box(scene, glass, {0.5, 0.05, 0.5}, at * test::translation({0, -0.45, 0}));
  for (const double side : {-1.0, 1.0}) {
    add_box(scene, glass, {0.05, 0.35, 0.5}, at * test::translation({0.45 * side, -0.05, 0}));
    add_box(scene, glass, {0.4, 0.35, 0.05}, at * test::translation({0, -0.05, 0.45 * side}));
  }
  add_box(scene, water, {0.4, 0.3, 0.4}, at * test::translation({0, -0.1, 0}));
  add_box(scene, flint, {0.1, 0.1, 0.1}, at * test::translation({0.05, -0.3, 0.02}));
  expect_invisible(scene);
}

TEST_P(ContactFurnace, bodies_that_overlap_go_by_priority) {
  for (const int priority : {-1, 0, 1}) {
    Scene scene = enclosure();
    GetParam()(scene, test::add(scene, test::glass(1.5)), {0.5, 0.4, 0.3}, tilt());
    test::add_sphere(scene, test::add(scene, glass(1.333, priority)), Vec3d(0.2, 0.3, 0.1), 0.5);
    test::add_sphere(scene, test::add(scene, glass(1.7, 2 * priority)), Vec3d(-0.3, 0.1, 0.2), 0.4);
    expect_invisible(scene);
  }
}

INSTANTIATE_TEST_SUITE_P(shapes, ContactFurnace, testing::Values(test::add_box, test::add_box_mesh),
                         [](const auto& test) { return test.index == 0 ? "exact" : "mesh"; });

// A body of revolution as a closed mesh, its profile from the axis round to the axis.
void add_turned(Scene& scene, std::uint32_t material, const std::vector<Vec2d>& profile) {
  constexpr std::uint32_t kSides = 24;
  Mesh mesh;
  mesh.material = material;
  const auto rings = static_cast<std::uint32_t>(profile.size());
  for (const Vec2d& p : profile) {
    for (std::uint32_t s = 0; s < kSides; ++s) {
      const double angle = 2.0 * kPi * s / kSides;
      mesh.positions.emplace_back(Vec3d(p.x * std::cos(angle), p.x * std::sin(angle), p.y));
    }
  }
  for (std::uint32_t r = 0; r + 1 < rings; ++r) {
    for (std::uint32_t s = 0; s < kSides; ++s) {
      const std::uint32_t a = r * kSides + s;
      const std::uint32_t b = r * kSides + (s + 1) % kSides;
      if (profile[r].x > 0.0) mesh.triangles.push_back({a, b, a + kSides});
      if (profile[r + 1].x > 0.0) mesh.triangles.push_back({b, b + kSides, a + kSides});
    }
  }
  scene.meshes.push_back(mesh);
  Instance instance;
  instance.what = static_cast<std::uint32_t>(scene.meshes.size() - 1);
  instance.to_world = tilt();
  scene.instances.push_back(instance);
}

TEST(Contact, cemented_doublet_in_uniform_enclosure_is_invisible) {
  // Crown and flint share a curved face, whose height at radius r is sag(r).
  const auto sag = [](double r) { return 0.35 * r * r; };
  std::vector<Vec2d> crown, flint;
  for (int i = 0; i <= 8; ++i) crown.emplace_back(0.1 * i, sag(0.1 * i) - 0.3);
  for (int i = 8; i >= 0; --i) crown.emplace_back(0.1 * i, 0.25 - sag(0.1 * i) * 0.5);
  for (int i = 0; i <= 8; ++i) flint.emplace_back(0.1 * i, -0.6);
  for (int i = 8; i >= 0; --i) flint.emplace_back(0.1 * i, sag(0.1 * i) - 0.3);
  Scene scene = enclosure();
  add_turned(scene, test::add(scene, test::glass(1.52)), crown);
  add_turned(scene, test::add(scene, test::glass(1.7)), flint);
  expect_invisible(scene);
}

// Light straight through parallel layers between air and air, by Fresnel at each interface, without
// inner reflections.
double through(const std::vector<double>& indices, double cos_air) {
  double share = 1.0;
  const double sin_air = std::sqrt(1.0 - cos_air * cos_air);
  double n = 1.0;
  double cosine = cos_air;
  for (std::size_t i = 0; i <= indices.size(); ++i) {
    const double next = i < indices.size() ? indices[i] : 1.0;
    const double cos_next = std::sqrt(1.0 - sin_air * sin_air / (next * next));
    const double s = (n * cosine - next * cos_next) / (n * cosine + next * cos_next);
    const double p = (next * cosine - n * cos_next) / (next * cosine + n * cos_next);
    share *= 1.0 - 0.5 * (s * s + p * p);
    n = next;
    cosine = cos_next;
  }
  return share;
}

// Piles of boxes that touch, at any rotation and offset, before a wall that shines: behind the
// camera it is dark, so that reflections bring nothing.
TEST(Contact, pile_of_touching_boxes_is_a_stack_of_interfaces) {
  std::mt19937 random(17);
  std::uniform_real_distribution<double> unit(0.0, 1.0);
  for (int trial = 0; trial < 24; ++trial) {
    const bool meshes = trial % 2 == 0;
    const Mat4d place =
        test::translation(10.0 *
                          Vec3d(unit(random) - 0.5, unit(random) - 0.5, unit(random) - 0.5)) *
        test::rotation(glm::normalize(Vec3d(unit(random), unit(random), unit(random) - 0.5)),
                       360.0 * unit(random));
    const double incidence = 1.2 * unit(random);
    Scene scene;
    Material wall = test::emitter(Vec3f(1.0f));
    test::add_square(scene, test::add(scene, wall), 40.0, place * test::translation({0, 0, -2}));
    std::vector<double> indices;
    double z = 0.0;
    for (int layer = 0; layer < 4; ++layer) {
      const double n = 1.3 + 0.6 * unit(random);
      const double half = 0.002 + 0.02 * unit(random);
      indices.push_back(n);
      z += half;
      (meshes ? test::add_box_mesh : test::add_box)(scene, test::add(scene, test::glass(n)),
                                                    {1.0 + unit(random), 1.0 + unit(random), half},
                                                    place * test::translation({0, 0, -z}));
      z += half;
    }
    const Vec3d towards(std::sin(incidence), 0.0, std::cos(incidence));
    scene.cameras.push_back(test::orthographic_camera(Vec3d(place * Vec4d(3.0 * towards, 1.0)),
                                                      Vec3d(place * Vec4d(0.0, 0.0, 0.0, 1.0)),
                                                      0.05, 0.05));
    RenderSettings settings = settings_of();
    settings.max_depth = 5;  // Four layers, five interfaces, the wall: no inner reflection.
    const double expected = through(indices, std::cos(incidence));
    for (const double ratio : ratios(scene, settings)) {
      // A sum of floats in each of three channels.
      EXPECT_NEAR(ratio, expected, 2e-5) << "trial " << trial;
    }
  }
}

// A cube that stands on a floor, lit and seen from above: one value for all pixels, that of a thin
// gap of air.
TEST(Contact, floor_under_a_cube_is_lit_evenly_through_a_thin_gap) {
  for (const bool meshes : {false, true}) {
    for (const double turn_deg : {0.0, 31.0}) {
      Scene scene;
      const Mat4d place = test::translation({0.7, -0.4, 0.3}) *
                          test::rotation(glm::normalize(Vec3d(3, 1, 2)), turn_deg);
      test::add_square(scene, test::add(scene, test::matte(Vec3f(0.8f))), 1.0, place);
      (meshes ? test::add_box_mesh : test::add_box)(scene, test::add(scene, test::glass(1.5)),
                                                    {0.05, 0.05, 0.05},
                                                    place * test::translation({0, 0, 0.05}));
      scene.lights.push_back(
          test::directional_light(Vec3d(place * Vec4d(0.0, 0.0, -1.0, 0.0)), 100.0));
      const Vec3d eye(place * Vec4d(0.0, 0.0, 0.5, 1.0));
      scene.cameras.push_back(
          test::orthographic_camera(eye, Vec3d(place * Vec4d(0, 0, 0, 1)), 0.04, 0.04));
      RenderSettings settings = settings_of();
      settings.max_depth = 2;  // Without what the glass and the floor throw to and fro.
      const double expected = std::pow(0.96, 4.0);
      for (const double ratio : ratios(scene, settings)) EXPECT_NEAR(ratio, expected, 1e-4);
    }
  }
}

// A mirror that a pane lies on is seen through both faces of the pane, twice.
TEST(Contact, mirror_behind_a_pane_is_seen_through_a_thin_gap) {
  Scene scene;
  const Mat4d place = tilt();
  test::add_square(scene, test::add(scene, test::emitter(Vec3f(1.0f))), 40.0,
                   place * test::translation({0, 0, 20}) * test::rotation({1, 0, 0}, 180.0));
  Material mirror;
  mirror.metallic = 1.0f;
  mirror.roughness = 0.0f;
  const std::uint32_t metal = test::add(scene, mirror);
  test::add_box(scene, metal, {1, 1, 0.1}, place * test::translation({0, 0, -0.1}));
  test::add_box_mesh(scene, test::add(scene, test::glass(1.5)), {1, 1, 0.1},
                     place * test::translation({0, 0, 0.1}));
  const Vec3d towards(std::sin(0.4), 0.0, std::cos(0.4));
  scene.cameras.push_back(
      test::orthographic_camera(Vec3d(place * Vec4d(5.0 * towards, 1.0)), Vec3d(0.0), 0.05, 0.05));
  RenderSettings settings = settings_of();
  settings.max_depth = 5;  // In, gap, mirror, gap, out, and the wall, and no more.
  const test::Rendered seen = test::render(scene, settings);
  // The wall is of 1 cd/m². The front face reflects it, too.
  const double pane = through({1.5}, std::cos(0.4));
  const double front = 1.0 - std::sqrt(pane);
  // The back face of the pane sends light back out of the front, after one reflection.
  const double expected = front + front * pane + pane * pane;
  for (int y = 0; y < 8; ++y) {
    for (int x = 0; x < 8; ++x) {
      EXPECT_NEAR(static_cast<double>(test::pixel(seen.image, x, y, "G")), expected, 2e-4);
    }
  }
}

// A sheet that lies on a floor, and a cube on that, look as they do a little above each other.
TEST(Contact, sheet_on_a_floor_and_under_a_cube_is_there) {
  for (const bool has_cube : {false, true}) {
    std::array<test::Rendered, 2> seen;
    for (const bool lifted : {false, true}) {
      Scene scene;
      const Mat4d place = tilt();
      const double gap_m = lifted ? 1e-4 : 0.0;
      test::add_square(scene, test::add(scene, test::matte(Vec3f(0.8f))), 1.0, place);
      Material sheet = test::glass(1.5);
      sheet.has_volume = false;
      sheet.base_color_rec709 = Vec4f(0.5f, 0.7f, 0.9f, 1.0f);
      test::add_square(scene, test::add(scene, sheet), 0.5,
                       place * test::translation({0, 0, gap_m}));
      if (has_cube) {
        test::add_box_mesh(scene, test::add(scene, test::glass(1.5)), {0.05, 0.05, 0.05},
                           place * test::translation({0, 0, 0.05 + 2 * gap_m}));
      }
      scene.lights.push_back(
          test::directional_light(Vec3d(place * Vec4d(0.0, 0.0, -1.0, 0.0)), 100.0));
      scene.cameras.push_back(test::orthographic_camera(Vec3d(place * Vec4d(0.0, 0.0, 0.5, 1.0)),
                                                        Vec3d(0.0), 0.04, 0.04));
      RenderSettings settings = settings_of();
      settings.max_depth = 6;
      seen[lifted ? 1 : 0] = test::render(scene, settings);
    }
    const auto& pixels = seen[0].image.pixels;
    for (std::size_t i = 0; i < pixels.size(); ++i) {
      // Nothing depends on a gap of a tenth of a millimetre but roundings.
      EXPECT_NEAR(pixels[i] / seen[1].image.pixels[i], 1.0f, 1e-5f) << (has_cube ? "cube" : "");
    }
  }
}

// Gaps wider than contact are two interfaces, however narrow.
TEST(Contact, gap_of_a_micrometre_is_air) {
  for (const bool meshes : {false, true}) {
    for (const double gap_m : {1e-6, 2e-6, 1e-5, 1e-3}) {
      Scene scene;
      test::add_square(scene, test::add(scene, test::emitter(Vec3f(1.0f))), 40.0,
                       test::translation({0, 0, -2}));
      const std::uint32_t glass = test::add(scene, test::glass(1.5));
      const auto add_box = meshes ? test::add_box_mesh : test::add_box;
      add_box(scene, glass, {1, 1, 0.002}, test::translation({0, 0, -0.002}));
      add_box(scene, glass, {1, 1, 0.002}, test::translation({0, 0, -0.006 - gap_m}));
      scene.cameras.push_back(test::orthographic_camera({0.5, 0, 0.5}, {0, 0, 0}, 0.01, 0.01));
      RenderSettings settings = settings_of();
      settings.max_depth = 4;
      const double pane = through({1.5}, std::cos(kPi / 4.0));
      for (const double ratio : ratios(scene, settings)) {
        EXPECT_NEAR(ratio, pane * pane, 1e-4) << gap_m << (meshes ? " mesh" : " exact");
      }
    }
  }
}

}  // namespace
}  // namespace abbe
