// Light from lamps, straight, through glass and through water, against closed forms.

#include <gtest/gtest.h>

#include <cmath>

#include "abbe/base/constants.h"
#include "abbe/optics/fresnel.h"
#include "support/scene_builder.h"

namespace abbe {
namespace {

RenderSettings white_settings() {
  RenderSettings settings = test::small_settings();
  settings.samples_per_pixel = 16;
  return settings;
}

// Straight shadow rays also where glass would bend them.
RenderSettings straight_settings() {
  RenderSettings settings = white_settings();
  settings.caustics = false;
  return settings;
}

// A matte floor of reflectance 1 in the plane y = 0, seen from above.
Scene floor_seen_from_above(const Vec3f& reflectance = Vec3f(1.0f)) {
  Scene scene;
  test::add_square(scene, test::add(scene, test::matte(reflectance)), 20.0,
                   test::rotation({1, 0, 0}, -90.0));
  scene.cameras.push_back(test::orthographic_camera({0, 30, 0}, {0, 0, 0}, 1e-4, 1e-4));
  return scene;
}

float luminance(const test::Rendered& result) {
  return 0.2126f * test::pixel(result.image, 4, 4, "R") +
         0.7152f * test::pixel(result.image, 4, 4, "G") +
         0.0722f * test::pixel(result.image, 4, 4, "B");
}

TEST(LightTest, point_light_at_height_gives_intensity_over_pi_r2) {
  Scene scene = floor_seen_from_above();
  scene.lights.push_back(test::point_light({0, 3, 0}, 100.0));
  // E = I/r², L = E/π; within the quadrature's 1e-4.
  EXPECT_NEAR(luminance(test::render(scene, white_settings())), 100.0 / 9.0 / kPi, 1e-3);
}

TEST(LightTest, point_light_to_the_side_follows_the_cosine_to_the_fourth) {
  Scene scene = floor_seen_from_above();
  scene.lights.push_back(test::point_light({4, 3, 0}, 100.0));
  const double cosine = 3.0 / 5.0;
  EXPECT_NEAR(luminance(test::render(scene, white_settings())), 100.0 / 25.0 * cosine / kPi, 1e-3);
}

TEST(LightTest, lamp_with_a_spectrum_keeps_its_luminous_intensity) {
  for (const char* id : {"illuminant/A", "illuminant/FL11", "illuminant/E"}) {
    Scene scene = floor_seen_from_above();
    scene.lights.push_back(test::point_light({0, 3, 0}, 100.0));
    scene.lights.front().spectrum = NamedSpectrum{id, test::catalogue().illuminant(id)};
    RenderSettings settings = white_settings();
    // 64 samples: FL11 is made of lines, and the quadrature has to find them.
    settings.samples_per_pixel = 64;
    // A share of 2e-3 of the value 3.5.
    EXPECT_NEAR(luminance(test::render(scene, settings)), 100.0 / 9.0 / kPi, 7e-3) << id;
  }
}

TEST(LightTest, lamp_made_of_lines_keeps_its_luminous_intensity_in_every_sample) {
  Scene scene = floor_seen_from_above();
  scene.lights.push_back(test::point_light({0, 3, 0}, 100.0));
  scene.lights.front().spectrum =
      NamedSpectrum{"", Spectrum::lines({{588.995, 2.0}, {589.592, 1.0}})};
  RenderSettings settings = test::small_settings();
  const test::Rendered result = test::render(scene, settings);
  // A line has a lane of its own: exact in a single sample. Sodium light lies outside Rec.709.
  EXPECT_NEAR(luminance(result), 100.0 / 9.0 / kPi, 1e-3);
  EXPECT_GT(test::pixel(result.image, 4, 4, "R"), test::pixel(result.image, 4, 4, "G"));
  EXPECT_LT(test::pixel(result.image, 4, 4, "B"), 0.0f);
}

TEST(LightTest, spot_light_follows_the_smooth_cone_of_gltf) {
  Scene scene = floor_seen_from_above();
  Light light = test::point_light({0, 3, 0}, 100.0);
  light.type = LightType::Spot;
  light.inner_cone_rad = 0.2;
  light.outer_cone_rad = 0.6;
  light.to_world = light.to_world * test::rotation({1, 0, 0}, -90.0) *
                   test::rotation({0, 1, 0}, glm::degrees(0.4));
  scene.lights.push_back(light);
  const double scale = 1.0 / (std::cos(0.2) - std::cos(0.6));
  const double cone = (std::cos(0.4) - std::cos(0.6)) * scale;
  EXPECT_NEAR(luminance(test::render(scene, white_settings())), 100.0 / 9.0 / kPi * cone * cone,
              1e-3);
}

TEST(LightTest, light_beyond_its_range_does_not_shine) {
  Scene scene = floor_seen_from_above();
  scene.lights.push_back(test::point_light({0, 3, 0}, 100.0));
  scene.lights.front().range_m = 6.0;
  // Window of KHR_lights_punctual: 1 − (3/6)⁴.
  EXPECT_NEAR(luminance(test::render(scene, white_settings())),
              100.0 / 9.0 / kPi * (1.0 - 1.0 / 16.0), 1e-3);
  scene.lights.front().range_m = 2.9;
  EXPECT_EQ(luminance(test::render(scene, white_settings())), 0.0f);
}

TEST(LightTest, opaque_ball_casts_a_black_shadow) {
  Scene scene = floor_seen_from_above();
  scene.lights.push_back(test::point_light({2, 3, 0}, 100.0));
  test::add_sphere(scene, test::add(scene, test::matte(Vec3f(0.5f))), {1, 1.5, 0}, 0.2);
  EXPECT_EQ(luminance(test::render(scene, white_settings())), 0.0f);
}

TEST(LightTest, glass_pane_in_the_way_dims_by_two_boundaries_and_absorption) {
  Scene scene = floor_seen_from_above();
  scene.lights.push_back(test::point_light({4, 3, 0}, 100.0));
  Material pane = test::glass(1.5);
  pane.absorption_per_m = Spectrum::constant(2.0);
  test::add_box(scene, test::add(scene, pane), {1.0, 0.05, 1.0}, test::translation({2, 1.5, 0}));
  const double cosine = 3.0 / 5.0;
  const double transmitted = 1.0 - fresnel_dielectric(cosine, 1.5).reflectance();
  const double path_m = 0.1 / cosine;
  EXPECT_NEAR(luminance(test::render(scene, straight_settings())),
              100.0 / 25.0 * cosine / kPi * transmitted * transmitted * std::exp(-2.0 * path_m),
              1e-3);
}

TEST(LightTest, glass_pane_of_triangles_dims_like_an_exact_one) {
  Scene scene = floor_seen_from_above();
  scene.lights.push_back(test::point_light({4, 3, 0}, 100.0));
  test::add_box_mesh(scene, test::add(scene, test::glass(1.5)), {1.0, 0.05, 1.0},
                     test::translation({2, 1.5, 0}));
  const double cosine = 3.0 / 5.0;
  const double transmitted = 1.0 - fresnel_dielectric(cosine, 1.5).reflectance();
  EXPECT_NEAR(luminance(test::render(scene, straight_settings())),
              100.0 / 25.0 * cosine / kPi * transmitted * transmitted, 1e-3);
}

TEST(LightTest, emitter_under_water_seen_from_air_is_dimmed_by_the_index_squared) {
  for (const Mode mode : {Mode::Spectral, Mode::Rgb}) {
    Scene scene;
    // A glowing floor at the bottom of a tank of water of n = 4/3.
    test::add_square(scene, test::add(scene, test::emitter(Vec3f(1.0f))), 20.0,
                     test::translation({0, -1, 0}) * test::rotation({1, 0, 0}, -90.0));
    test::add_box(scene, test::add(scene, test::glass(4.0 / 3.0)), {30, 1.5, 30},
                  test::translation({0, -1.5, 0}));
    scene.cameras.push_back(test::orthographic_camera({0, 5, 0}, {0, 0, 0}, 0.01, 0.01));
    RenderSettings settings = white_settings();
    settings.mode = mode;
    // The index of water at 4/3: k_t = 1 − ((n − 1)/(n + 1))² = 0.979592; L = k_t/n².
    const double k_t = 1.0 - std::pow((1.0 / 3.0) / (7.0 / 3.0), 2);
    EXPECT_NEAR(luminance(test::render(scene, settings)), k_t * 9.0 / 16.0, 1e-4);
  }
}

TEST(LightTest, rough_metal_highlight_in_mirror_direction_is_the_ggx_peak) {
  Scene scene;
  Material metal = test::matte(Vec3f(1.0f));
  metal.metallic = 1.0f;
  metal.roughness = 0.5f;
  test::add_square(scene, test::add(scene, metal), 20.0, test::rotation({1, 0, 0}, -90.0));
  scene.cameras.push_back(test::orthographic_camera({0, 30, 0}, {0, 0, 0}, 1e-4, 1e-4));
  scene.lights.push_back(test::directional_light({0, -1, 0}, 1.0));
  // All cosines 1: D = 1/(π α²), V = 1/4, F = 1, so L = E/(4 π α²) with α = 0.25.
  EXPECT_NEAR(luminance(test::render(scene, white_settings())), 1.0 / (4.0 * kPi * 0.0625), 1e-3);
}

TEST(LightTest, smooth_metal_shows_no_highlight_of_a_point_light) {
  Scene scene;
  test::add_square(scene, test::add(scene, test::mirror("metal/Ag-Johnson")), 20.0,
                   test::rotation({1, 0, 0}, -90.0));
  scene.cameras.push_back(test::orthographic_camera({0, 30, 0}, {0, 0, 0}, 1e-4, 1e-4));
  scene.lights.push_back(test::directional_light({0, -1, 0}, 1.0));
  EXPECT_EQ(luminance(test::render(scene, white_settings())), 0.0f);
}

}  // namespace
}  // namespace abbe
