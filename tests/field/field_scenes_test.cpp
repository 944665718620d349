// Scenes as people model them, against the values of tests/reference/optics.

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>

#include "abbe/base/constants.h"
#include "abbe/image/exr/exr.h"
#include "abbe/load/gltf.h"
#include "support/scene_builder.h"

namespace abbe {
namespace {

constexpr double kLine_nm = 550.0;
// Spectral radiance of 1 cd/m² of equal energy, by the observer's sum in steps of 1 nm.
constexpr double kPerLuminance = 1.0 / (kLuminousEfficacy_lm_per_W * 106.856917);

Scene load(const std::string& name) {
  Notes notes;
  return load_gltf(
      std::filesystem::path(ABBE_SOURCE_DIR) / "tests/reference/optics" / (name + ".gltf"),
      test::catalogue(), {}, notes);
}

RenderSettings settings_of(const Vec2i& size, int samples) {
  RenderSettings settings = test::small_settings();
  settings.size = size;
  settings.samples_per_pixel = samples;
  settings.wavelengths.exact_nm = {kLine_nm};
  return settings;
}

/// Radiances, row by row, in units of 1 cd/m² of equal energy.
std::vector<double> radiances(const Scene& scene, const RenderSettings& settings) {
  const Image image = test::render(scene, settings).image;
  std::vector<double> values;
  for (int y = 0; y < image.height; ++y)
    for (int x = 0; x < image.width; ++x)
      values.push_back(
          static_cast<double>(test::pixel(image, x, y, spectral_channel_name(kLine_nm))) /
          kPerLuminance);
  return values;
}

std::pair<double, double> extremes_of(const std::vector<double>& values) {
  const auto [least, most] = std::minmax_element(values.begin(), values.end());
  return {*least, *most};
}

/// Irradiances of a wall of albedo 0.8 over that of its lamp at normal incidence.
std::vector<double> shares_of_lamp(const Scene& scene, const RenderSettings& settings) {
  std::vector<double> values = radiances(scene, settings);
  for (double& value : values) value *= kPi / 0.8 / scene.lights.front().intensity;
  return values;
}

struct WallCase {
  const char* scene;
  double least, most;  ///< Without and with all inner reflections.
};

class FieldWall : public testing::TestWithParam<WallCase> {};

TEST_P(FieldWall, wall_behind_flat_bodies_gets_what_passes_them) {
  const WallCase& expected = GetParam();
  const auto [least, most] =
      extremes_of(shares_of_lamp(load(expected.scene), settings_of({6, 6}, 4)));
  // Figures are stated to 1e-4.
  EXPECT_GT(least, expected.least - 1e-4);
  EXPECT_LT(most, expected.most + 1e-4);
}

INSTANTIATE_TEST_SUITE_P(scenes, FieldWall, testing::Values(WallCase{"F2_2_panes", 0.8409, 0.8496}),
                         [](const auto& test) { return std::string(test.param.scene); });

struct PaneCase {
  const char* name;
  const char* scene;
  double passed;
};

class FieldPanes : public testing::TestWithParam<PaneCase> {};

TEST_P(FieldPanes, emitter_is_seen_through_two_panes_at_45_degrees) {
  const PaneCase& expected = GetParam();
  const auto [least, most] = extremes_of(radiances(load(expected.scene), settings_of({6, 6}, 4)));
  // Figures are stated to 1e-4; light that goes round in the gap more often than a path may is
  // left out.
  EXPECT_GT(least, expected.passed - 1e-3);
  EXPECT_LT(most, expected.passed + 1e-3);
}

INSTANTIATE_TEST_SUITE_P(scenes, FieldPanes,
                         testing::Values(PaneCase{"um_10", "F6_panes_gap_1e-05", 0.8176}),
                         [](const auto& test) { return std::string(test.param.name); });

TEST(FieldScene, camera_in_water_sees_an_emitter_in_the_water_as_it_is) {
  const Scene scene = load("F8_camera_in_water");
  // Left of the middle.
  EXPECT_NEAR(radiances(scene, settings_of({41, 41}, 4)).at(20 * 41 + 18), 1.0, 1e-3);
}

}  // namespace
}  // namespace abbe
