/// Colours that differ from place to place, seen by spread fans: the lanes of a fan have what a ray
/// of one wavelength has.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string>

#include "support/scene_builder.h"

namespace abbe {
namespace {

enum class Colour { Base, Unlit, Emission, Vertices };

/// A square in the XY plane of side 2 as cells × cells squares, uv from 0 to 1.
Mesh grid(int cells, bool has_colors) {
  Mesh mesh;
  const int side = cells + 1;
  for (int y = 0; y < side; ++y) {
    for (int x = 0; x < side; ++x) {
      const Vec2f uv(static_cast<float>(x) / static_cast<float>(cells),
                     static_cast<float>(y) / static_cast<float>(cells));
      mesh.positions.push_back({2.0f * uv.x - 1.0f, 2.0f * uv.y - 1.0f, 0.0f});
      mesh.uv[0].push_back(uv);
      if (has_colors) mesh.colors_rec709.push_back({uv.x, 1.0f - uv.x, uv.y, 1.0f});
    }
  }
  for (int y = 0; y < cells; ++y) {
    for (int x = 0; x < cells; ++x) {
      const auto a = static_cast<std::uint32_t>(y * side + x);
      const auto b = a + 1, c = a + static_cast<std::uint32_t>(side), d = c + 1;
      mesh.triangles.push_back({a, b, d});
      mesh.triangles.push_back({a, d, c});
    }
  }
  return mesh;
}

/// Three by three texels: neighbours alike and not, grey, black and white.
TextureImage texture() {
  TextureImage image;
  image.width = image.height = 3;
  image.rgba8 = {255, 40,  20,  255, 255, 40,  20,  255, 30, 200, 90, 255,
                 128, 128, 128, 255, 10,  20,  240, 255, 30, 200, 90, 255,
                 0,   0,   0,   255, 255, 255, 255, 255, 30, 200, 90, 255};
  return image;
}

/// A screen behind a prism of dense flint.
Scene screen_behind_prism(Colour colour, int cells) {
  Scene scene;
  scene.images.push_back(texture());
  scene.textures.push_back(Texture{});
  Material material = test::matte(Vec3f(0.9f));
  if (colour == Colour::Emission) {
    material = test::emitter(Vec3f(3.0f, 2.0f, 4.0f));
    material.emissive_texture = TextureUse{};
  } else if (colour != Colour::Vertices) {
    material.base_color_texture = TextureUse{};
    material.unlit = colour == Colour::Unlit;
  }
  scene.meshes.push_back(grid(cells, colour == Colour::Vertices));
  scene.meshes.back().material = test::add(scene, material);
  Instance screen;
  screen.what = static_cast<std::uint32_t>(scene.meshes.size() - 1);
  screen.to_world = test::translation({-0.3, 0, -1.5});
  scene.instances.push_back(screen);
  test::add_prism(scene, test::add(scene, test::glass("glass/schott/N-SF11")), 40.0, 1.0,
                  test::translation({0.5, 0, 0}));
  scene.lights.push_back(test::point_light({0.5, 0.4, 1.5}, 20.0));
  scene.cameras.push_back(test::orthographic_camera({0, 0, 5}, {0, 0, 0}, 0.2, 0.2));
  return scene;
}

class SpreadMaterialTest : public testing::TestWithParam<Colour> {
 protected:
  static test::Rendered rendered(Colour colour, int cells, int cluster_lanes, Uplift uplift) {
    RenderSettings settings = test::small_settings();
    settings.size = {12, 12};
    settings.caustics = false;
    settings.max_depth = 4;
    // No choice by chance between children: both ways follow the same.
    settings.cutoff = 0.0;
    settings.cluster_lanes = cluster_lanes;
    settings.uplift = uplift;
    return test::render(screen_behind_prism(colour, cells), settings);
  }

  static void expect_alike(const test::Rendered& a, const test::Rendered& b, float tolerance) {
    float brightest = 0.0f;
    for (int y = 0; y < 12; ++y) {
      for (int x = 0; x < 12; ++x) {
        for (const char* channel : {"R", "G", "B"}) {
          const float value = test::pixel(a.image, x, y, channel);
          brightest = std::max(brightest, value);
          EXPECT_NEAR(value, test::pixel(b.image, x, y, channel),
                      tolerance * (1.0f + std::abs(value)))
              << channel << " at " << x << ", " << y;
        }
      }
    }
    EXPECT_GT(brightest, 0.05f);
  }
};

TEST_P(SpreadMaterialTest, lanes_of_a_fan_see_the_colours_that_rays_of_one_wavelength_see) {
  for (const Uplift uplift : {Uplift::JakobHanika, Uplift::MallettYuksel}) {
    const test::Rendered fans = rendered(GetParam(), 1, 0, uplift);
    const test::Rendered rays = rendered(GetParam(), 1, 1, uplift);
    EXPECT_GT(fans.stats.spread_fans, 100u);
    EXPECT_EQ(rays.stats.spread_fans, 0u);
    // Sums in single precision, in another order.
    expect_alike(fans, rays, 2e-6f);
  }
}

TEST_P(SpreadMaterialTest, colours_of_a_fine_mesh_are_those_of_a_coarse_one) {
  // 45 000 triangles: so many that their memory is fetched ahead of shading.
  const test::Rendered coarse = rendered(GetParam(), 1, 0, Uplift::JakobHanika);
  const test::Rendered fine = rendered(GetParam(), 150, 0, Uplift::JakobHanika);
  // Places on a triangle come from its weights, which are rounded to single precision.
  expect_alike(coarse, fine, 1e-4f);
}

std::string name_of(const testing::TestParamInfo<Colour>& of) {
  constexpr std::array kNames{"base", "unlit", "emission", "vertices"};
  return kNames.at(static_cast<std::size_t>(of.param));
}

INSTANTIATE_TEST_SUITE_P(Colours, SpreadMaterialTest,
                         testing::Values(Colour::Base, Colour::Unlit, Colour::Emission,
                                         Colour::Vertices),
                         name_of);

}  // namespace
}  // namespace abbe
