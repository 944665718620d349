// Colours of scenes, by whatever way they reach the lanes, develop to themselves under D65.
#include <gtest/gtest.h>

#include "abbe/color/color.h"
#include "support/scene_builder.h"

namespace abbe {
namespace {

constexpr double kPi_lx = 3.14159265358979;

// A floor whose radiance is its reflectance.
Scene floor_of(const Vec3f& factor_rec709) {
  Scene scene;
  test::add_square(scene, test::add(scene, test::matte(factor_rec709)), 20.0,
                   test::rotation({1, 0, 0}, -90.0));
  scene.cameras.push_back(test::orthographic_camera({0, 30, 0}, {0, 0, 0}, 1.0, 1.0));
  scene.lights.push_back(test::directional_light({0, -1, 0}, kPi_lx));
  return scene;
}

void add_texel(Scene& scene, std::uint8_t r, std::uint8_t g, std::uint8_t b) {
  scene.images.push_back({"texel", 1, 1, {r, g, b, 255}, {}});
  scene.textures.push_back({});
  scene.materials.front().base_color_texture = TextureUse{};
  Mesh& mesh = scene.meshes.front();
  mesh.uv[0].assign(mesh.positions.size(), Vec2f(0.5f));
}

Vec3d shown(const Scene& scene, Mode mode, Uplift uplift) {
  RenderSettings settings = test::small_settings();
  settings.samples_per_pixel = 16;
  settings.mode = mode;
  settings.uplift = uplift;
  const Image image = test::render(scene, settings).image;
  Vec3d mean(0.0);
  for (int y = 0; y < 8; ++y) {
    for (int x = 0; x < 8; ++x) {
      mean += Vec3d(test::pixel(image, x, y, "R"), test::pixel(image, x, y, "G"),
                    test::pixel(image, x, y, "B")) /
              64.0;
    }
  }
  return mean;
}

void expect_color(const Scene& scene, const Vec3d& rgb_rec709) {
  for (const Uplift uplift : {Uplift::JakobHanika, Uplift::MallettYuksel}) {
    const Vec3d seen = shown(scene, Mode::Spectral, uplift);
    // 16 samples of 16 wavelengths, and of Mallett and Yuksel's own round trip the same.
    for (int c = 0; c < 3; ++c) {
      EXPECT_NEAR(seen[c], rgb_rec709[c], 1e-3) << uplift_name(uplift) << ' ' << c;
    }
  }
  const Vec3d as_rgb = shown(scene, Mode::Rgb, Uplift::JakobHanika);
  for (int c = 0; c < 3; ++c) EXPECT_NEAR(as_rgb[c], rgb_rec709[c], 1e-5) << c;
}

TEST(UpliftRender, constant_colours_develop_to_themselves) {
  expect_color(floor_of({0.8f, 0.3f, 0.1f}), {0.8, 0.3, 0.1});
}

TEST(UpliftRender, colours_of_vertices_develop_to_themselves) {
  Scene scene = floor_of({0.5f, 1.0f, 0.5f});
  Mesh& mesh = scene.meshes.front();
  mesh.colors_rec709.assign(mesh.positions.size(), Vec4f(0.4f, 0.25f, 1.0f, 1.0f));
  expect_color(scene, {0.2, 0.25, 0.5});
}

TEST(UpliftRender, texels_develop_to_themselves) {
  Scene scene = floor_of(Vec3f(1.0f));
  add_texel(scene, 40, 200, 120);
  expect_color(scene,
               {srgb_decode(40 / 255.0), srgb_decode(200 / 255.0), srgb_decode(120 / 255.0)});
}

TEST(UpliftRender, texels_beyond_rec709_keep_their_negative_channels) {
  Scene scene = floor_of(Vec3f(1.0f));
  scene.color_space = RgbSpace::Rec2020;
  add_texel(scene, 60, 180, 60);
  const double low = srgb_decode(60 / 255.0), high = srgb_decode(180 / 255.0);
  const Vec3d wanted = rgb_to_rec709(RgbSpace::Rec2020) * Vec3d(low, high, low);
  ASSERT_LT(wanted.r, -0.1);
  const Vec3d smooth = shown(scene, Mode::Spectral, Uplift::JakobHanika);
  // 16 samples of 16 wavelengths, as above.
  for (int c = 0; c < 3; ++c) EXPECT_NEAR(smooth[c], wanted[c], 1e-3) << c;
  // What knows Rec.709 alone shows its nearest channel.
  EXPECT_NEAR(shown(scene, Mode::Spectral, Uplift::MallettYuksel).r, 0.0, 1e-3);
  EXPECT_NEAR(shown(scene, Mode::Rgb, Uplift::JakobHanika).r, 0.0, 1e-6);  // rounding
}

}  // namespace
}  // namespace abbe
