/// Screens with images, and the rays that see them: for tests of beams.
#pragma once

#include <functional>
#include <vector>

#include "support/scene_builder.h"

namespace abbe::test {

struct Line {
  Vec3d origin, direction;
};
inline constexpr int kTexels = 512;

inline TextureImage image_of(const std::function<Vec3f(int, int)>& color) {
  TextureImage image;
  image.width = image.height = kTexels;
  std::vector<std::uint8_t> codes;
  for (int y = 0; y < kTexels; ++y) {
    for (int x = 0; x < kTexels; ++x) {
      const Vec3f value = color(x, y);
      for (int c = 0; c < 3; ++c) {
        codes.push_back(static_cast<std::uint8_t>(255.0f * value[c] + 0.5f));
      }
      codes.push_back(255);
    }
  }
  image.rgba8 = SharedValues<std::uint8_t>(std::move(codes));
  return image;
}

inline RenderSettings rgb_settings() {
  RenderSettings settings = small_settings();
  settings.mode = Mode::Rgb;
  return settings;
}

inline Material silver(float roughness = 0.0f) {
  Material material;
  material.metallic = 1.0f;
  material.roughness = roughness;
  material.double_sided = true;
  return material;
}

inline void add_mesh(Scene& scene, Mesh mesh) {
  scene.meshes.push_back(std::move(mesh));
  Instance instance;
  instance.what = static_cast<std::uint32_t>(scene.meshes.size() - 1);
  scene.instances.push_back(instance);
}

/// A square about a place, uv from 0 to 1 along its sides.
inline Mesh textured_square(const Vec3d& place, const Vec3d& right, const Vec3d& up,
                            double half_m) {
  Mesh mesh;
  for (const Vec2d& uv : {Vec2d(0, 0), Vec2d(1, 0), Vec2d(1, 1), Vec2d(0, 1)}) {
    mesh.positions.push_back(
        Vec3f(place + half_m * ((2.0 * uv.x - 1.0) * right + (2.0 * uv.y - 1.0) * up)));
    mesh.uv[0].push_back(Vec2f(uv));
  }
  mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
  return mesh;
}

/// A self-luminous square with an image, about a place.
inline void add_screen(Scene& scene, TextureImage image, const Vec3d& place, const Vec3d& right,
                       const Vec3d& up, double half_m,
                       TextureFilter filter = TextureFilter::Linear) {
  scene.images.push_back(std::move(image));
  scene.textures.push_back(
      {.image = static_cast<std::uint32_t>(scene.images.size() - 1), .filter = filter});
  Material material = matte(Vec3f(1.0f));
  material.unlit = true;
  material.double_sided = true;
  material.base_color_texture =
      TextureUse{.texture = static_cast<std::uint32_t>(scene.textures.size() - 1)};
  Mesh mesh = textured_square(place, right, up, half_m);
  mesh.material = add(scene, material);
  add_mesh(scene, std::move(mesh));
}

/// What rays see of red, green and blue.
inline std::vector<Vec3f> all_seen(const LitWorld& world, const std::vector<Line>& rays,
                                   double per_m, int depth, std::uint32_t index = 0) {
  std::vector<CameraSample> samples;
  for (const Line& ray : rays) {
    CameraSample& sample = samples.emplace_back();
    sample.origin = Vec3f(ray.origin);
    sample.direction = glm::normalize(Vec3f(ray.direction));
    sample.footprint_per_m = static_cast<float>(per_m);
    sample.chance = {12345u, index};
  }
  const auto stride = static_cast<std::size_t>(world.lanes.lane_stride());
  std::vector<float> radiance(samples.size() * stride);
  IntegratorStats stats;
  IntegratorScratch scratch;
  trace_samples(world, {.max_depth = depth, .cutoff = 0.0f}, samples, {radiance}, stats, scratch);
  std::vector<Vec3f> colors;
  for (std::size_t i = 0; i < samples.size(); ++i) {
    const float* value = radiance.data() + i * stride;
    colors.push_back({value[0], value[1], value[2]});
  }
  return colors;
}

inline Vec3f seen(const LitWorld& world, const Line& ray, double per_m, int depth) {
  return all_seen(world, {ray}, per_m, depth).front();
}

}  // namespace abbe::test
