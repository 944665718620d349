#include "abbe/scene/colors.h"

#include <gtest/gtest.h>

namespace abbe {
namespace {

// A textured material whose texels are red, green, grey and grey again in a space.
Scene scene_of(RgbSpace space) {
  Scene scene;
  scene.color_space = space;
  scene.images.push_back(
      {"a", 2, 2, {255, 0, 0, 255, 0, 255, 0, 255, 99, 99, 99, 255, 99, 99, 99, 255}, {}});
  scene.textures.push_back({});
  Material material;
  material.base_color_texture = TextureUse{};
  scene.materials.push_back(material);
  return scene;
}

TEST(SceneColors, texels_beyond_rec709_and_beyond_all_surfaces_are_counted) {
  const ColorCount of_rec709 = count_colors(scene_of(RgbSpace::Rec709));
  EXPECT_EQ(of_rec709.outside_rec709, 0u);
  EXPECT_EQ(of_rec709.impossible, 0u);
  const ColorCount of_acescg = count_colors(scene_of(RgbSpace::AcesCg));
  EXPECT_EQ(of_acescg.outside_rec709, 2u);
  EXPECT_EQ(of_acescg.impossible, 2u);
}

TEST(SceneColors, factor_takes_part) {
  // Primaries of the others are spectral or beyond, and never exist.
  Scene scene = scene_of(RgbSpace::DisplayP3);
  // Dark enough to exist, but still outside Rec.709.
  scene.materials[0].base_color_rec709 = Vec4f(0.05f, 0.05f, 0.05f, 1.0f);
  EXPECT_EQ(count_colors(scene).outside_rec709, 2u);
  EXPECT_EQ(count_colors(scene).impossible, 0u);
}

TEST(SceneColors, lights_count_at_half_their_brightness) {
  Scene scene;
  scene.color_space = RgbSpace::DisplayP3;
  Light light;
  light.color_rec709 = rgb_to_rec709(RgbSpace::DisplayP3) * Vec3d(1.0, 0.0, 0.0);
  scene.lights.push_back(light);
  EXPECT_EQ(count_colors(scene).outside_rec709, 1u);
  EXPECT_EQ(count_colors(scene).impossible, 0u);
}

TEST(SceneColors, conversion_keeps_white_and_alpha) {
  Scene scene = scene_of(RgbSpace::AcesCg);
  scene.materials[0].base_color_rec709 = Vec4f(0.5f, 0.5f, 0.5f, 0.25f);
  convert_colors_to_rec709(scene);
  for (int c = 0; c < 3; ++c) EXPECT_NEAR(scene.materials[0].base_color_rec709[c], 0.5f, 1e-6f);
  EXPECT_EQ(scene.materials[0].base_color_rec709.w, 0.25f);
}

}  // namespace
}  // namespace abbe
