// In a uniform enclosure nothing that does not absorb can be seen.

#include <gtest/gtest.h>

#include <cmath>

#include "support/scene_builder.h"

namespace abbe {
namespace {

// Looks at the origin from inside a large sphere that glows at 1 cd/m².
Scene enclosure() {
  Scene scene;
  test::add_sphere(scene, test::add(scene, test::emitter(Vec3f(1.0f))), Vec3d(0.0), 50.0);
  scene.cameras.push_back(test::orthographic_camera({0, 0, 5}, {0, 0, 0}, 0.95, 0.95));
  return scene;
}

RenderSettings settings_of(Mode mode) {
  RenderSettings settings = test::small_settings();
  settings.mode = mode;
  settings.samples_per_pixel = 4;
  settings.max_depth = 32;
  return settings;
}

void expect_invisible(const Scene& scene, const RenderSettings& settings, double tolerance) {
  const test::Rendered result = test::render(scene, settings);
  Scene empty = scene;
  empty.instances.resize(1);
  const test::Rendered background = test::render(empty, settings);
  ASSERT_GT(test::pixel(background.image, 0, 0, "G"), 0.5f);
  for (std::size_t i = 0; i < result.image.pixels.size(); ++i) {
    const double ratio = static_cast<double>(result.image.pixels[i]) /
                         static_cast<double>(background.image.pixels[i]);
    EXPECT_NEAR(ratio, 1.0, tolerance) << "value " << i;
  }
}

class Furnace : public testing::TestWithParam<Mode> {};

TEST_P(Furnace, glass_ball_in_uniform_enclosure_is_invisible) {
  Scene scene = enclosure();
  test::add_sphere(scene, test::add(scene, test::glass("glass/schott/N-BK7")), Vec3d(0.0), 1.0);
  // Depth 32 leaves less than 1e-6 inside a ball of N-BK7 within 0.95 of its radius; the rest is
  // rounding.
  expect_invisible(scene, settings_of(GetParam()), 1e-4);
}

TEST_P(Furnace, dense_flint_box_in_uniform_enclosure_is_invisible) {
  Scene scene = enclosure();
  test::add_box(scene, test::add(scene, test::glass("glass/schott/N-SF66")), Vec3d(0.4, 0.3, 0.2),
                test::rotation(glm::normalize(Vec3d(1, 2, 3)), 35.0));
  RenderSettings settings = settings_of(GetParam());
  settings.max_depth = 60;
  settings.cutoff = 0.0;
  // Light trapped by total reflection between faces at right angles leaves through others; what
  // depth 60 cuts off is reported and allowed for here.
  expect_invisible(scene, settings, 1e-3);
}

TEST_P(Furnace, nested_glass_in_water_in_uniform_enclosure_is_invisible) {
  Scene scene = enclosure();
  test::add_sphere(scene, test::add(scene, test::glass("liquid/water-daimon-20c")), Vec3d(0.0),
                   1.0);
  test::add_sphere(scene, test::add(scene, test::glass("glass/schott/F2")), Vec3d(0.0), 0.6);
  test::add_sphere(scene, test::add(scene, test::glass(1.0)), Vec3d(0.0), 0.3);
  RenderSettings settings = settings_of(GetParam());
  settings.max_depth = 40;
  settings.cutoff = 1e-5;
  // Below the cutoff one child stands for two: unbiased, with noise in proportion to the cutoff.
  expect_invisible(scene, settings, 2e-3);
}

TEST_P(Furnace, rough_glass_loses_only_what_multiple_scattering_would_add) {
  Scene scene = enclosure();
  Material rough = test::glass(1.5);
  rough.roughness = 0.2f;
  test::add_sphere(scene, test::add(scene, rough), Vec3d(0.0), 1.0);
  RenderSettings settings = settings_of(GetParam());
  settings.samples_per_pixel = 64;
  const test::Rendered result = test::render(scene, settings);
  double mean = 0.0;
  for (int y = 2; y < 6; ++y) {
    for (int x = 2; x < 6; ++x) mean += static_cast<double>(test::pixel(result.image, x, y, "G"));
  }
  mean /= 16.0;
  // Single scattering at alpha 0.04 loses a little to masking and must not gain.
  EXPECT_GT(mean, 0.97);
  EXPECT_LT(mean, 1.0 + 1e-3);
}

INSTANTIATE_TEST_SUITE_P(modes, Furnace, testing::Values(Mode::Spectral, Mode::Rgb, Mode::Rgb3),
                         [](const auto& test) { return mode_name(test.param); });

TEST(FurnaceTest, matte_sphere_under_ambient_light_has_albedo_times_ambient) {
  Scene scene;
  test::add_sphere(scene, test::add(scene, test::matte(Vec3f(0.4f))), Vec3d(0.0), 10.0);
  scene.cameras.push_back(test::orthographic_camera({0, 0, 20}, {0, 0, 0}, 1.0, 1.0));
  scene.ambient = Ambient{2.0, {"illuminant/D65", test::catalogue().illuminant("illuminant/D65")}};
  RenderSettings settings = test::small_settings();
  settings.samples_per_pixel = 16;
  const test::Rendered result = test::render(scene, settings);
  for (const char* channel : {"R", "G", "B"}) {
    // 16 samples of 16 wavelengths integrate D65 to 1e-4.
    EXPECT_NEAR(test::pixel(result.image, 4, 4, channel), 0.8f, 2e-4f);
  }
}

}  // namespace
}  // namespace abbe
