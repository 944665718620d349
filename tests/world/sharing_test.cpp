// Instances that share the data of their mesh: which do, and that nothing else changes.

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "abbe/base/error.h"
#include "abbe/integrate/surface/point.h"
#include "abbe/render/settings.h"
#include "abbe/world/emitters.h"
#include "abbe/world/world.h"
#include "support/scene_builder.h"

namespace abbe {
namespace {

// A bumpy ball with all attributes, somewhere in its own space.
Mesh ball(std::uint32_t material, const Vec3d& center) {
  constexpr std::uint32_t kRows = 12, kColumns = 24;
  Mesh mesh;
  mesh.material = material;
  for (std::uint32_t j = 0; j <= kRows; ++j) {
    for (std::uint32_t i = 0; i <= kColumns; ++i) {
      const double theta = kPi * j / kRows, phi = 2.0 * kPi * i / kColumns;
      const Vec3d n(std::sin(theta) * std::cos(phi), std::cos(theta),
                    std::sin(theta) * std::sin(phi));
      mesh.positions.emplace_back(center + (1.0 + 0.1 * std::sin(5.0 * n.x + 3.0 * n.y)) * n);
      mesh.normals.emplace_back(n);
      mesh.tangents.emplace_back(Vec3f(Vec3d(-std::sin(phi), 0.0, std::cos(phi))), 1.0f);
      mesh.uv[0].emplace_back(static_cast<float>(i) / kColumns, static_cast<float>(j) / kRows);
      mesh.colors_rec709.emplace_back(0.5f + 0.5f * Vec3f(n), 1.0f);
    }
  }
  for (std::uint32_t j = 0; j < kRows; ++j) {
    for (std::uint32_t i = 0; i < kColumns; ++i) {
      const std::uint32_t a = j * (kColumns + 1) + i, b = a + kColumns + 1;
      if (j > 0) mesh.triangles.push_back({a, a + 1, b + 1});
      if (j + 1 < kRows) mesh.triangles.push_back({a, b + 1, b});
    }
  }
  return mesh;
}

TextureImage bumps() {
  TextureImage image;
  image.width = image.height = 16;
  for (int i = 0; i < 256; ++i) {
    for (const int value : {100 + i % 50, 130 + i % 31, 220, 255}) {
      image.rgba8.push_back(static_cast<std::uint8_t>(value));
    }
  }
  return image;
}

// Balls of one mesh at random places, under two nodes each, some of them mirror images, above a
// floor, lit by a lamp.
Scene balls(unsigned seed, int count, const Vec3d& center) {
  Scene scene;
  scene.images.push_back(bumps());
  scene.textures.push_back({});
  Material material = test::matte(Vec3f(0.8f, 0.6f, 0.4f));
  material.normal_texture = TextureUse{};
  scene.meshes.push_back(ball(test::add(scene, material), center));
  std::mt19937 engine(seed);
  const auto uniform = [&](double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(engine);
  };
  for (int i = 0; i < count; ++i) {
    Mat4d to_world = test::translation({uniform(-4, 4), uniform(-2, 2), uniform(-4, 4)});
    for (int node = 0; node < 2; ++node) {
      const Vec3d axis(uniform(-1, 1), uniform(-1, 1), uniform(0.1, 1));
      Mat4d scaled(1.0);
      for (int a = 0; a < 3; ++a) scaled[a][a] = uniform(0.5, 0.9);
      if (uniform(0, 1) < 0.3) scaled[1][1] = -scaled[1][1];
      to_world = to_world * test::rotation(glm::normalize(axis), uniform(0, 360)) * scaled;
    }
    scene.instances.push_back({"", std::uint32_t{0}, to_world * test::translation(-center)});
  }
  test::add_square(scene, test::add(scene, test::matte(Vec3f(0.5f))), 20.0,
                   test::translation({0, -4, 0}) * test::rotation({1, 0, 0}, -90));
  scene.lights.push_back(test::directional_light({0.3, -1.0, -0.4}, 3.0));
  scene.cameras.push_back(test::perspective_camera({0, 3, 12}, {0, 0, 0}, 45));
  return scene;
}

LitWorld world_of(const Scene& scene, const RenderSettings& settings, bool shares) {
  WorldOptions options = world_options(settings);
  options.sharing.least_saved_triangles = shares ? 1 : ~std::size_t{0};
  Notes notes;
  return make_lit_world(scene, options, caustic_options(settings), test::catalogue().observer(),
                        test::catalogue().illuminant("illuminant/D65"), notes);
}

RenderSettings settings_of(Mode mode) {
  RenderSettings settings = test::small_settings();
  settings.mode = mode;
  return settings;
}

std::size_t shared_count(const Scene& scene) {
  return world_of(scene, settings_of(Mode::Rgb), true).geometry.places.size();
}

TEST(sharing, instances_beyond_the_threshold_share_one_copy) {
  const Scene scene = balls(1, 60, Vec3d(0.0));
  const LitWorld shared = world_of(scene, settings_of(Mode::Rgb), true);
  const LitWorld flat = world_of(scene, settings_of(Mode::Rgb), false);
  EXPECT_EQ(shared.geometry.places.size(), 60u);
  EXPECT_EQ(shared.geometry.meshes.size(), 2u);  // One as it is, one mirrored.
  EXPECT_EQ(flat.geometry.places.size(), 0u);
  EXPECT_LT(shared.geometry.bytes(), flat.geometry.bytes() / 10);
  EXPECT_EQ(shared.geometry.surfaces.size(), flat.geometry.surfaces.size());
}

TEST(sharing, few_instances_stay_flat_by_default) {
  const Scene scene = balls(1, 60, Vec3d(0.0));
  const LitWorld world = test::make_world(scene, settings_of(Mode::Rgb));
  EXPECT_TRUE(world.geometry.places.empty());
}

// Such balls, in rows and columns, none of which touches anything.
Scene balls_apart(unsigned seed, int count, const Material& material) {
  Scene scene = balls(seed, count, Vec3d(0.0));
  scene.materials[0] = material;
  for (int i = 0; i < count; ++i) {
    scene.instances[static_cast<std::size_t>(i)].to_world[3] =
        Vec4d(2.5 * (i % 4) - 3.75, 2.5 * (i / 4 % 2) - 1.5, -2.5 * (i / 8), 1.0);
  }
  return scene;
}

Material shining() {
  Material material = test::matte(Vec3f(0.5f));
  material.emissive_rec709 = Vec3f(1.0f, 0.8f, 0.5f);
  material.lights_others = LightsOthers::Yes;
  return material;
}

TEST(sharing, what_shines_or_lets_light_in_shares_where_nothing_touches) {
  for (const Material& material : {test::matte(Vec3f(0.5f)), shining(), test::glass(1.5)}) {
    const Scene scene = balls_apart(1, 20, material);
    EXPECT_EQ(shared_count(scene), 20u);
  }
  // Each place of a lamp is known by itself.
  const LitWorld shared = world_of(balls_apart(1, 20, shining()), settings_of(Mode::Rgb), true);
  const LitWorld flat = world_of(balls_apart(1, 20, shining()), settings_of(Mode::Rgb), false);
  EXPECT_EQ(shared.emitters->piece_count(), flat.emitters->piece_count());
}

TEST(sharing, glass_that_may_touch_something_has_primitives_of_its_own) {
  Scene scene = balls_apart(1, 20, test::glass(1.5));
  // Two that reach into each other.
  scene.instances[3].to_world = test::translation({100, 0, 0});
  scene.instances[4].to_world = test::translation({101, 0, 0});
  EXPECT_EQ(shared_count(scene), 18u);
  // One that reaches through what stops light.
  scene.instances[4].to_world = test::translation({200, 0, 0});
  EXPECT_EQ(shared_count(scene), 20u);
  test::add_square(scene, 1, 20.0, test::translation({200, 0, 0}));
  EXPECT_EQ(shared_count(scene), 19u);
}

TEST(sharing, glass_whose_pieces_touch_has_primitives_of_its_own) {
  Scene scene = balls_apart(1, 20, test::glass(1.5));
  Mesh& mesh = scene.meshes[0];
  const Mesh piece = mesh;
  const auto first = static_cast<std::uint32_t>(mesh.positions.size());
  const auto append = [&](auto& to, const auto& from) {
    to.insert(to.end(), from.begin(), from.end());
  };
  for (const Vec3f& position : piece.positions) mesh.positions.push_back(0.5f * position);
  append(mesh.normals, piece.normals);
  append(mesh.tangents, piece.tangents);
  append(mesh.uv[0], piece.uv[0]);
  append(mesh.colors_rec709, piece.colors_rec709);
  for (const auto& t : piece.triangles) {
    mesh.triangles.push_back({t[0] + first, t[1] + first, t[2] + first});
  }
  EXPECT_EQ(shared_count(scene), 20u);
  for (std::size_t i = 0; i < first; ++i)
    mesh.positions[first + i] = 1.5f * piece.positions[i] + Vec3f(0.5f, 0.0f, 0.0f);
  EXPECT_EQ(shared_count(scene), 0u);
}

// Its light is followed from faces in the world; that of a lamp, where there is one.
TEST(sharing, glass_of_exact_light_has_primitives_of_its_own) {
  Scene scene;
  const std::uint32_t glass = test::add(scene, test::glass(1.5));
  test::add_box_mesh(scene, glass, Vec3d(1.0), test::translation({0, 0, 0}));
  for (int i = 1; i < 10; ++i) {
    scene.instances.push_back({"", std::uint32_t{0}, test::translation({3.0 * i, 0, 0})});
  }
  const auto count = [&] {
    WorldOptions options = world_options(settings_of(Mode::Rgb));
    options.sharing = {.least_saved_triangles = 1, .least_triangles = 1};
    Notes notes;
    return make_lit_world(scene, options, caustic_options(settings_of(Mode::Rgb)),
                          test::catalogue().observer(),
                          test::catalogue().illuminant("illuminant/D65"), notes)
        .geometry.places.size();
  };
  EXPECT_EQ(count(), 10u);
  scene.lights.push_back(test::directional_light({0.3, -1.0, -0.4}, 3.0));
  EXPECT_EQ(count(), 0u);
}

TEST(sharing, what_glass_may_touch_has_primitives_of_its_own) {
  Scene scene = balls(1, 20, Vec3d(0.0));
  scene.instances[3].to_world = test::translation({100, 0, 0});
  test::add_box_mesh(scene, test::add(scene, test::glass(1.5)), Vec3d(1.0),
                     test::translation({101.5, 0, 0}));
  EXPECT_EQ(shared_count(scene), 19u);
}

TEST(sharing, transform_that_nearly_flattens_is_not_shared) {
  Scene scene = balls(1, 20, Vec3d(0.0));
  scene.instances[5].to_world[1] *= 1e-5;
  EXPECT_EQ(shared_count(scene), 19u);
}

// Points are computed from the mesh and the transform, and are those of triangles in the world.
TEST(sharing, points_on_surfaces_are_those_of_flat_geometry) {
  for (const double off_center_m : {0.0, 1e4}) {
    const Scene scene = balls(2, 40, Vec3d(off_center_m, 0.0, 0.0));
    const RenderSettings settings = settings_of(Mode::Rgb);
    const LitWorld shared = world_of(scene, settings, true);
    const LitWorld flat = world_of(scene, settings, false);
    std::mt19937 engine(3);
    std::uniform_real_distribution<float> uniform(-1.0f, 1.0f);
    std::size_t compared = 0, differ = 0;
    for (int i = 0; i < 4000; ++i) {
      const Vec3f from = 12.0f * glm::normalize(Vec3f(uniform(engine), 0.2f, uniform(engine)));
      const Vec3f to = 3.0f * Vec3f(uniform(engine), uniform(engine), uniform(engine));
      const Ray ray{from, kInfinity, glm::normalize(to - from)};
      Hit a, b;
      shared.accelerator->closest_hits(std::span(&ray, 1), kAllBits, std::span(&a, 1));
      flat.accelerator->closest_hits(std::span(&ray, 1), kAllBits, std::span(&b, 1));
      if (!a.is_hit() || !b.is_hit()) {
        differ += a.is_hit() != b.is_hit() ? 1 : 0;
        continue;
      }
      const SurfacePoint p = surface_point(shared, ray.origin, ray.direction, a);
      const SurfacePoint q = surface_point(flat, ray.origin, ray.direction, b);
      // A ray at an edge may meet either side of it; one that grazes a ball, or passes it.
      if (p.surface != q.surface || glm::dot(p.normal, q.normal) < 1.0f - 1e-4f) {
        ++differ;
        continue;
      }
      ++compared;
      // A ray's place on a surface is known to its rounding over the cosine: 12 m·2^-24·100. The
      // corners of balls authored at 10 km are the same numbers in both.
      EXPECT_LT(glm::length(p.position - q.position), 1e-4f);
      EXPECT_LT(glm::length(p.shading_normal - q.shading_normal), 1e-3f);
      EXPECT_LT(glm::length(p.uv[0] - q.uv[0]), 1e-4f);
      EXPECT_LT(glm::length(p.color_rec709 - q.color_rec709), 1e-3f);
      EXPECT_NEAR(p.uv_per_m[0], q.uv_per_m[0], 1e-3f * q.uv_per_m[0]);
      // The step off the surface allows for the roundings of both spaces, and is no leap.
      EXPECT_GE(p.offset_m, 0.9f * q.offset_m);
      EXPECT_LT(p.offset_m, 1e-4f);
    }
    EXPECT_GT(compared, 1000u);
    EXPECT_LT(differ, 40u);
  }
}

// A ray that steps off a surface does not meet it again, whichever side it takes.
TEST(sharing, step_off_a_surface_clears_it) {
  Scene scene = balls(4, 60, Vec3d(0.0));
  // Far from the origin for their size.
  for (std::size_t i = 0; i < 60; ++i) scene.instances[i].to_world[3] += Vec4d(300, 200, -500, 0);
  scene.materials[0].normal_texture.reset();
  const LitWorld world = world_of(scene, settings_of(Mode::Rgb), true);
  ASSERT_EQ(world.geometry.places.size(), 60u);
  std::mt19937 engine(5);
  std::uniform_real_distribution<float> uniform(-1.0f, 1.0f);
  std::size_t met = 0, again = 0;
  for (int i = 0; i < 20000; ++i) {
    const Vec3f to =
        Vec3f(300, 200, -500) + 4.0f * Vec3f(uniform(engine), uniform(engine), uniform(engine));
    const Vec3f direction =
        glm::normalize(Vec3f(uniform(engine), uniform(engine), uniform(engine)) + Vec3f(0.01f));
    const Ray ray{to - 10.0f * direction, kInfinity, direction};
    Hit hit;
    world.accelerator->closest_hits(std::span(&ray, 1), kAllBits, std::span(&hit, 1));
    if (!hit.is_hit() || !world.geometry.is_shared(hit.primitive)) continue;
    ++met;
    const SurfacePoint point = surface_point(world, ray.origin, ray.direction, hit);
    for (int side = 0; side < 2; ++side) {
      const Vec3f outgoing =
          glm::normalize(Vec3f(uniform(engine), uniform(engine), uniform(engine)) + Vec3f(0.01f));
      const Ray next{off_surface(point, outgoing), kInfinity, outgoing};
      Hit second;
      world.accelerator->closest_hits(std::span(&next, 1), kAllBits, std::span(&second, 1));
      again += second.primitive == hit.primitive ? 1 : 0;
    }
  }
  EXPECT_GT(met, 2000u);
  EXPECT_EQ(again, 0u);
}

// How many pixels differ by more than rounding, of pictures with and without shared data.
int differing_pixels(const Scene& scene, const RenderSettings& settings) {
  const Image a = test::render(world_of(scene, settings, true), scene.cameras[0], settings).image;
  const Image b = test::render(world_of(scene, settings, false), scene.cameras[0], settings).image;
  int differ = 0;
  double brightest = 0.0;
  for (int y = 0; y < settings.size.y; ++y) {
    for (int x = 0; x < settings.size.x; ++x) {
      const float of_a = test::pixel(a, x, y, "G"), of_b = test::pixel(b, x, y, "G");
      brightest = std::max(brightest, static_cast<double>(of_a));
      // Colours of dispersed light lie beyond Rec. 709, and have negative channels.
      const float size = std::abs(of_a) + std::abs(of_b);
      differ += std::abs(of_a - of_b) > 1e-3f * size + 1e-5f ? 1 : 0;
    }
  }
  EXPECT_GT(brightest, 0.1);
  return differ;
}

// A silhouette or the edge of a shadow may pass a sample on the other side; nothing else differs.
TEST(sharing, images_agree_with_flat_ones_but_for_rounding) {
  const Scene scene = balls(6, 60, Vec3d(0.0));
  for (const Mode mode : {Mode::Rgb, Mode::Spectral}) {
    for (const char* accelerator : {"kdtree", "brute"}) {
      RenderSettings settings = settings_of(mode);
      settings.size = mode == Mode::Rgb ? Vec2i{64, 48} : Vec2i{32, 24};
      settings.accelerator = accelerator;
      EXPECT_LE(differing_pixels(scene, settings), settings.size.x * settings.size.y / 300);
    }
  }
}

TEST(sharing, images_of_glass_and_lamps_agree_with_flat_ones_but_for_rounding) {
  RenderSettings settings = settings_of(Mode::Spectral);
  settings.size = {48, 36};
  for (const Material& material : {shining(), test::glass(1.5)}) {
    Scene scene = balls_apart(6, 16, material);
    EXPECT_LE(differing_pixels(scene, settings), settings.size.x * settings.size.y / 300);
    // From within one.
    scene.cameras[0] =
        test::perspective_camera(Vec3d(scene.instances[5].to_world[3]), {0, 0, -9}, 45);
    EXPECT_LE(differing_pixels(scene, settings), settings.size.x * settings.size.y / 300);
  }
}

}  // namespace
}  // namespace abbe
