// Bump directions of normal maps whose coordinates a transform turns.

#include <gtest/gtest.h>

#include <cmath>

#include "abbe/integrate/surface/point.h"
#include "support/scene_builder.h"

namespace abbe {
namespace {

// A map of one texel that leans towards its u and, less, against its v.
TextureImage leaning() {
  TextureImage image;
  image.width = image.height = 1;
  for (const int value : {204, 153, 230, 255}) {
    image.rgba8.push_back(static_cast<std::uint8_t>(value));
  }
  return image;
}

Vec3f bump(const std::array<float, 4>& transform, const std::array<float, 4>& baked,
           bool has_tangents, const Mat4d& to_world = Mat4d(1.0)) {
  Scene scene;
  scene.images.push_back(leaning());
  scene.textures.push_back({});
  Material material = test::matte(Vec3f(0.5f));
  material.double_sided = true;
  material.normal_texture = TextureUse{.uv_linear = transform};
  test::add_square(scene, test::add(scene, material), 1.0, to_world);
  Mesh& mesh = scene.meshes.back();
  for (const Vec3f& p : mesh.positions) {
    const Vec2f uv(p.x, -p.y);
    mesh.uv[0].push_back({baked[0] * uv.x + baked[1] * uv.y, baked[2] * uv.x + baked[3] * uv.y});
  }
  if (has_tangents) mesh.tangents.assign(mesh.positions.size(), Vec4f(1.0f, 0.0f, 0.0f, 1.0f));
  const RenderSettings settings = test::small_settings();
  Notes notes;
  const LitWorld world = make_lit_world(scene, world_options(settings), caustic_options(settings),
                                        test::catalogue().observer(),
                                        test::catalogue().illuminant("illuminant/D65"), notes);
  const Vec3f origin(0.3f, 0.1f, 2.0f), down(0.0f, 0.0f, -1.0f);
  const Ray ray{origin, kInfinity, down};
  Hit hit;
  world.accelerator->closest_hits(std::span<const Ray>(&ray, 1), kAllBits, std::span<Hit>(&hit, 1));
  return surface_point(world, origin, down, hit).shading_normal;
}

TEST(Bumps, turn_with_the_map_as_if_it_were_baked) {
  constexpr std::array<float, 4> kNone{1.0f, 0.0f, 0.0f, 1.0f};
  const float c = std::cos(0.7f), s = std::sin(0.7f);
  const std::array<std::array<float, 4>, 4> turns{{{1.0f, 0.0f, 0.0f, -1.0f},
                                                   {c, s, -s, c},
                                                   {-3.0f * c, 3.0f * s, 3.0f * s, 3.0f * c},
                                                   {0.0f, 2.0f, -2.0f, 0.0f}}};
  Mat4d mirrored(1.0);
  mirrored[0][0] = -1.0;
  for (const Mat4d& place : {Mat4d(1.0), mirrored}) {
    for (const auto& turn : turns) {
      const Vec3f baked = bump(kNone, turn, false, place);
      EXPECT_GT(glm::length(baked - bump(kNone, kNone, false, place)), 0.1f);
      for (const bool has_tangents : {false, true}) {
        // Single precision.
        EXPECT_LT(glm::length(bump(turn, kNone, has_tangents, place) - baked), 1e-5f)
            << has_tangents << " " << turn[0] << " " << turn[1];
      }
    }
  }
}

}  // namespace
}  // namespace abbe
