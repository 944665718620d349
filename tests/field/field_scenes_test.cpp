// Scenes as people model them, against the values of tests/reference/optics.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <numeric>

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

/// Radiances of a line, row by row, in units of 1 cd/m² of equal energy.
std::vector<double> radiances(const Scene& scene, const RenderSettings& settings,
                              double line_nm = kLine_nm) {
  const Image image = test::render(scene, settings).image;
  std::vector<double> values;
  for (int y = 0; y < image.height; ++y)
    for (int x = 0; x < image.width; ++x)
      values.push_back(
          static_cast<double>(test::pixel(image, x, y, spectral_channel_name(line_nm))) /
          kPerLuminance);
  return values;
}

double mean_of(const std::vector<double>& values) {
  return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
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

INSTANTIATE_TEST_SUITE_P(scenes, FieldWall,
                         testing::Values(WallCase{"F2_2_panes", 0.8409, 0.8496},
                                         WallCase{"F2_3_panes", 0.7711, 0.7901},
                                         WallCase{"F3_plate_in_water", 0.9516, 0.9523},
                                         WallCase{"F4_hollow_box", 0.8409, 0.8496},
                                         WallCase{"F5_mirror_pane", 0.9170, 0.9187}),
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
                         testing::Values(PaneCase{"contact", "F6_panes_gap_0", 0.8996},
                                         PaneCase{"um_1", "F6_panes_gap_1e-06", 0.8176},
                                         PaneCase{"um_10", "F6_panes_gap_1e-05", 0.8176}),
                         [](const auto& test) { return std::string(test.param.name); });

TEST(FieldScene, floor_under_a_cube_is_seen_through_a_thin_gap) {
  RenderSettings settings = settings_of({8, 8}, 4);
  settings.caustics = false;
  settings.max_depth = 2;  // Without what goes to and fro in the cube.
  const auto [least, most] = extremes_of(shares_of_lamp(load("F6_cube_on_floor"), settings));
  EXPECT_NEAR(least, 0.8409, 1e-4);  // Two faces for the eye, two for the lamp; stated to 1e-4.
  EXPECT_NEAR(most, least, 1e-6);    // Roundings.
}

TEST(FieldScene, line_at_a_prisms_rim_does_not_depend_on_the_other_lines) {
  const Scene scene = load("F1_prism_red_rim");
  RenderSettings settings = settings_of({24, 24}, 9);
  settings.inner_reflections = 0;
  const auto rim = [&](const std::vector<double>& lines_nm) {
    settings.wavelengths.exact_nm = lines_nm;
    const std::vector<double> all = radiances(scene, settings, 650.0);
    std::vector<double> values;
    for (std::size_t row = 16; row <= 21; ++row)
      for (std::size_t column = 6; column <= 17; ++column) values.push_back(all[row * 24 + column]);
    return values;
  };
  const std::vector<double> alone = rim({650.0});
  const std::vector<double> together = rim({450.0, 550.0, 650.0});
  EXPECT_GT(mean_of(alone), 0.0);
  for (std::size_t i = 0; i < alone.size(); ++i)
    EXPECT_NEAR(together[i], alone[i], 1e-6 * mean_of(alone)) << i;
}

TEST(FieldScene, concave_mirror_of_many_facets_focuses_what_falls_on_it) {
  // 4 × 4 cm at the focus, of 10 × 10 cm of light.
  const double share =
      mean_of(shares_of_lamp(load("F7_concave_mirror_R4m"), settings_of({16, 16}, 16))) * 16.0 /
      100.0;
  // The image of a facet, 1.6 mm, is not small against the patch, and rounding bends facets.
  EXPECT_NEAR(share, 1.0, 0.1);
}

// Beside the middle: to the left the emitter in the water, to the right the one in air.
double seen_from_water(std::size_t column) {
  return radiances(load("F8_camera_in_water"), settings_of({41, 41}, 4)).at(20 * 41 + column);
}

TEST(FieldScene, camera_in_water_sees_an_emitter_in_the_water_as_it_is) {
  EXPECT_NEAR(seen_from_water(18), 1.0, 1e-3);
}

TEST(FieldScene, corner_cube_loses_no_light_to_a_limit_by_default) {
  const Scene scene = load("F9_corner_cube");
  RenderSettings settings = settings_of({24, 24}, 16);
  const double by_default = mean_of(radiances(scene, settings));
  settings.inner_reflections = 3;
  EXPECT_NEAR(by_default / mean_of(radiances(scene, settings)), 1.0, 0.005);
}

}  // namespace
}  // namespace abbe
