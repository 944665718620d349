// Rough metal before a small disc of light, against the integral of its lobe.
#include <gtest/gtest.h>

#include <filesystem>

#include "abbe/image/exr/exr.h"
#include "abbe/load/gltf.h"
#include "support/scene_builder.h"

namespace abbe {
namespace {

struct Row {
  const char* scene;
  float roughness;
  double share;  ///< Of the power, sent to within 5° of the mirror's direction; computed apart.
};

class RoughMetalScene : public testing::TestWithParam<Row> {};

TEST_P(RoughMetalScene, shows_the_share_of_its_lobe_within_five_degrees) {
  Notes notes;
  Scene scene = load_gltf(std::filesystem::path(ABBE_SOURCE_DIR) / "tests/reference/optics" /
                              (std::string(GetParam().scene) + ".gltf"),
                          test::catalogue(), {}, notes);
  scene.materials.at(1).roughness = GetParam().roughness;
  RenderSettings settings = test::small_settings();
  settings.samples_per_pixel = 4096;
  settings.wavelengths.exact_nm = {550.0};
  const Image image = test::render(scene, settings).image;
  double sum = 0.0;
  for (int i = 0; i < 64; ++i) {
    sum += static_cast<double>(test::pixel(image, i % 8, i / 8, spectral_channel_name(550.0)));
  }
  // The disc has 1 cd/m² of equal energy: 683.002 lm/W times 106.856917 nm, the observer's sum.
  const double share = sum / 64.0 * 683.002 * 106.856917;
  // A quarter of a million samples leave 2 % of the smallest; the disc has 64 straight sides.
  EXPECT_NEAR(share, GetParam().share, 0.05 * GetParam().share + 3e-4);
}

INSTANTIATE_TEST_SUITE_P(scenes, RoughMetalScene,
                         testing::Values(Row{"F10_rough_metal_0.3", 0.3f, 0.1905},
                                         Row{"F10_rough_metal_0.5", 0.5f, 0.0296},
                                         Row{"F10_rough_metal_0.5", 0.7f, 0.0079},
                                         Row{"F10_rough_metal_1.0", 1.0f, 0.0019}));

}  // namespace
}  // namespace abbe
