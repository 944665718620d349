/// Beams: textures seen in mirrors and through glass are as coarse as the rays of a pixel say that
/// part there. Judged by differences of rays traced in double precision.
#include "abbe/integrate/surface/beam.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <vector>

#include "integrate/beam_screen.h"

namespace abbe {
namespace {

using test::add_mesh;
using test::add_screen;
using test::all_seen;
using test::image_of;
using test::kTexels;
using test::Line;
using test::rgb_settings;
using test::seen;
using test::silver;

/// What mirrors and lenses make of a ray.
using Path = std::function<Line(Line)>;

Vec3d mirrored(const Vec3d& direction, const Vec3d& normal) {
  return direction - 2.0 * glm::dot(direction, normal) * normal;
}

Vec3d bent(const Vec3d& direction, Vec3d normal, double eta_ti) {
  if (glm::dot(direction, normal) > 0.0) normal = -normal;
  return glm::refract(direction, normal, 1.0 / eta_ti);
}

/// Where a ray meets a sphere; the farther place where `far` is set.
Vec3d on_sphere(const Line& ray, const Vec3d& center, double radius_m, bool far) {
  const Vec3d from = ray.origin - center;
  const double b = glm::dot(from, ray.direction);
  const double root = std::sqrt(b * b - glm::dot(from, from) + radius_m * radius_m);
  return ray.origin + (far ? root - b : -root - b) * ray.direction;
}

Vec3d on_plane(const Line& ray, const Vec3d& normal, const Vec3d& place) {
  return ray.origin +
         glm::dot(normal, place - ray.origin) / glm::dot(normal, ray.direction) * ray.direction;
}

/// How wide, across the last ray, what a pixel's rays cover is at a distance behind the last
/// surface: along the shorter axis of the ellipse.
double traced_width_m(const Path& path, const Line& ray, double per_m, double distance_m) {
  const Line last = path(ray);
  const Vec3d place = last.origin + distance_m * last.direction;
  const Basis basis{Vec3f(ray.direction)};
  const auto change = [&](const Vec3d& axis) {
    const auto met = [&](double side) {
      const Vec3d direction = glm::normalize(ray.direction + 0.5 * side * per_m * axis);
      return on_plane(path({ray.origin, direction}), last.direction, place);
    };
    return met(1.0) - met(-1.0);
  };
  const Vec3d a = change(Vec3d(basis.tangent));
  const Vec3d b = change(Vec3d(basis.bitangent));
  const double mean = 0.5 * (glm::dot(a, a) + glm::dot(b, b));
  const double area = glm::length(glm::cross(a, b));
  return area / std::sqrt(mean + std::sqrt(std::max(0.0, mean * mean - area * area)));
}

/// Red only in the four texels about the middle: at every level a quarter of what it was at the one
/// before, so that red tells the level. Green everywhere.
TextureImage dot() {
  return image_of([](int x, int y) {
    const bool is_middle =
        (x == kTexels / 2 || x == kTexels / 2 - 1) && (y == kTexels / 2 || y == kTexels / 2 - 1);
    return Vec3f(is_middle ? 1.0f : 0.0f, 1.0f, 0.0f);
  });
}

/// The level, of which the middle of dot() has that share of red: levels are mixed linearly.
double level_of(double red) {
  double level = 0.0;
  while (red < 0.25) {
    red *= 4.0;
    level += 1.0;
  }
  return level + (1.0 - red) / 0.75;
}

/// The footprint that the screen was looked up with, over that of the traced rays.
/// `depth`: surfaces on the path; light that was reflected more often is left out.
double width_ratio(Scene scene, const Path& path, const Line& ray, double distance_m, int depth,
                   double texels_wide) {
  const Line last = path(ray);
  const double per_m = 1e-3;
  const double expected = traced_width_m(path, ray, per_m, distance_m);
  const double half = 0.5 * kTexels * expected / texels_wide;
  const Basis basis{Vec3f(last.direction)};
  add_screen(scene, dot(), last.origin + distance_m * last.direction, Vec3d(basis.tangent),
             Vec3d(basis.bitangent), half);
  const Vec3f color = seen(test::make_world(scene, rgb_settings()), ray, per_m, depth);
  EXPECT_GT(color.y, 0.01f);
  const double level = level_of(static_cast<double>(color.x / color.y));
  return std::exp2(level - std::log2(texels_wide));
}

// Of a level: red in eight bits an sRGB, mipmaps in sixteen; and beams are first differences of
// rays, traced ones the mean over a pixel.
constexpr double kRounding = 0.01;

TEST(Beam, thick_pane_is_seen_through_at_the_level_of_the_traced_rays) {
  for (const double tilt_deg : {0.0, 30.0, 60.0, 75.0}) {
    const Mat4d pose = test::rotation({0, 1, 0}, tilt_deg);
    const Vec3d normal(pose[2]);
    Scene scene;
    test::add_box(scene, test::add(scene, test::glass(1.6)), {30, 30, 1.0}, pose);
    const Path path = [&](Line ray) {
      Line inside{on_plane(ray, normal, normal), bent(ray.direction, normal, 1.6)};
      return Line{on_plane(inside, normal, -normal), bent(inside.direction, normal, 1.0 / 1.6)};
    };
    // The screen is clear of the pane.
    for (const double distance_m : {0.6, 4.0}) {
      const double ratio = width_ratio(scene, path, {{0, 0, 6}, {0, 0, -1}}, distance_m, 2, 11.0);
      EXPECT_NEAR(ratio, 1.0, kRounding) << tilt_deg << " deg, " << distance_m << " m";
    }
  }
}

TEST(Beam, sphere_mirrors_are_seen_in_at_the_level_of_the_traced_rays) {
  Scene scene;
  test::add_sphere(scene, test::add(scene, silver()), Vec3d(0.0), 1.0);
  const auto path = [](bool is_concave) {
    return Path([is_concave](Line ray) {
      const Vec3d place = on_sphere(ray, Vec3d(0.0), 1.0, is_concave);
      return Line{place, mirrored(ray.direction, place)};
    });
  };
  // At the middle and off it, where the two curvatures that a beam meets part.
  for (const double off : {0.0, 0.5, 0.85}) {
    EXPECT_NEAR(width_ratio(scene, path(false), {{off, 0.1, 3}, {0, 0, -1}}, 1.5, 1, 11.0), 1.0,
                kRounding)
        << "convex, " << off;
    // Short of the focus, and far behind it.
    for (const double distance_m : {0.2, 1.2}) {
      EXPECT_NEAR(
          width_ratio(scene, path(true), {{0.6 * off, 0.1, 0.4}, {0, 0, -1}}, distance_m, 1, 11.0),
          1.0, kRounding)
          << "concave, " << off << ", " << distance_m;
    }
  }
}

TEST(Beam, glass_ball_is_seen_through_at_the_level_of_the_traced_rays) {
  Scene scene;
  test::add_sphere(scene, test::add(scene, test::glass(1.5)), Vec3d(0.0), 1.0);
  const Path path = [](Line ray) {
    const Vec3d in = on_sphere(ray, Vec3d(0.0), 1.0, false);
    const Line inside{in, bent(ray.direction, in, 1.5)};
    const Vec3d out = on_sphere(inside, Vec3d(0.0), 1.0, true);
    return Line{out, bent(inside.direction, out, 1.0 / 1.5)};
  };
  for (const double off : {0.05, 0.3, 0.6}) {
    for (const double distance_m : {0.1, 5.0}) {
      EXPECT_NEAR(width_ratio(scene, path, {{off, 0, 3}, {0, 0, -1}}, distance_m, 2, 11.0), 1.0,
                  kRounding)
          << off << ", " << distance_m;
    }
  }
}

/// A bowl z = −curvature·(x² + 2·y²)/2 as triangles with its normals.
Mesh bowl(double curvature) {
  Mesh mesh;
  constexpr int kSide = 33;
  for (int j = 0; j < kSide; ++j) {
    for (int i = 0; i < kSide; ++i) {
      const double x = (i - 16) / 40.0, y = (j - 16) / 40.0;
      mesh.positions.push_back(Vec3f(Vec3d(x, y, -0.5 * curvature * (x * x + 2.0 * y * y))));
      mesh.normals.push_back(Vec3f(glm::normalize(Vec3d(curvature * x, 2.0 * curvature * y, 1.0))));
    }
  }
  for (std::uint32_t j = 0; j + 1 < kSide; ++j) {
    for (std::uint32_t i = 0; i + 1 < kSide; ++i) {
      const std::uint32_t a = j * kSide + i;
      mesh.triangles.push_back({a, a + 1, a + 1 + kSide});
      mesh.triangles.push_back({a, a + 1 + kSide, a + kSide});
    }
  }
  return mesh;
}

TEST(Beam, smooth_meshes_bend_beams_as_the_surface_that_they_stand_for) {
  for (const double curvature : {-0.5, 0.5, 2.0}) {
    Scene scene;
    Mesh mesh = bowl(curvature);
    mesh.material = test::add(scene, silver());
    add_mesh(scene, std::move(mesh));
    const Path path = [&](Line ray) {
      // The facets lie within 1e-3 of it.
      Vec3d at = on_plane(ray, {0, 0, 1}, Vec3d(0.0));
      for (int i = 0; i < 20; ++i) {
        const double z = -0.5 * curvature * (at.x * at.x + 2.0 * at.y * at.y);
        at = on_plane(ray, {0, 0, 1}, {0, 0, z});
      }
      const Vec3d normal = glm::normalize(Vec3d(curvature * at.x, 2.0 * curvature * at.y, 1.0));
      return Line{at, mirrored(ray.direction, normal)};
    };
    const Line ray{{0.13, 0.07, 3}, glm::normalize(Vec3d(0.02, 0.05, -1))};
    // Interpolated normals change by 3 % more or less than those of the surface within a triangle.
    EXPECT_NEAR(width_ratio(scene, path, ray, 2.0, 1, 11.0), 1.0, 0.05) << curvature;
  }
}

TEST(Beam, normal_maps_bend_beams_as_the_surface_that_they_stand_for) {
  for (const double curvature : {-0.3, 0.5}) {
    // The normals of z = −curvature·(x² + y²)/2 on a square from −1 to 1.
    Scene scene;
    TextureImage image;
    image.width = image.height = kTexels;
    std::vector<std::uint16_t> codes;
    const auto place = [](int i) { return 2.0 * (i + 0.5) / kTexels - 1.0; };
    const auto normal_at = [&](double x, double y) {
      return glm::normalize(Vec3d(curvature * x, curvature * y, 1.0));
    };
    for (int y = 0; y < kTexels; ++y) {
      for (int x = 0; x < kTexels; ++x) {
        // Green is where v gets smaller.
        const Vec3d normal = normal_at(place(x), place(y)) * Vec3d(1, -1, 1);
        for (int c = 0; c < 3; ++c) {
          codes.push_back(static_cast<std::uint16_t>(65535.0 * (0.5 * normal[c] + 0.5) + 0.5));
        }
        codes.push_back(65535);
      }
    }
    image.rgba16 = SharedValues<std::uint16_t>(std::move(codes));
    scene.images.push_back(std::move(image));
    scene.textures.push_back(
        {.wrap_s = TextureWrap::ClampToEdge, .wrap_t = TextureWrap::ClampToEdge});
    Material material = silver();
    material.normal_texture = TextureUse{};
    Mesh mesh = test::textured_square({0, 0, 0}, {1, 0, 0}, {0, 1, 0}, 1.0);
    mesh.material = test::add(scene, material);
    add_mesh(scene, std::move(mesh));
    const Path path = [&](Line ray) {
      const Vec3d at = on_plane(ray, {0, 0, 1}, Vec3d(0.0));
      return Line{at, mirrored(ray.direction, normal_at(at.x, at.y))};
    };
    const Line ray{{0.13, 0.07, 3}, glm::normalize(Vec3d(0.02, 0.05, -1))};
    // Of a pixel the normal's difference on one side, in a map of sixteen bits.
    EXPECT_NEAR(width_ratio(scene, path, ray, 2.0, 1, 11.0), 1.0, 0.02) << curvature;
  }
}

/// Noise of texels and a smooth slope.
TextureImage noise() {
  std::uint32_t state = 1u;
  return image_of([state](int x, int y) mutable {
    state = state * 1664525u + 1013904223u;
    const float slope = static_cast<float>(x + y) / (2.0f * kTexels);
    return Vec3f(0.5f + static_cast<float>(state >> 24) / 510.0f, slope,
                 (x / 4 + y / 4) % 2 == 0 ? 1.0f : 0.0f);
  });
}

TEST(Beam, flat_mirror_shows_what_stands_behind_it) {
  // A screen at −z seen in the mirror z = 0, and the same at +z.
  const Vec3d place(0.2, 0.1, 1.0), right(1, 0, 0), up = glm::normalize(Vec3d(0, 1, 0.7));
  const auto behind = [](const Vec3d& v) { return Vec3d(v.x, v.y, -v.z); };
  Scene mirror, direct;
  test::add_square(mirror, test::add(mirror, silver()), 2.0, Mat4d(1.0));
  add_screen(mirror, noise(), place, right, up, 1.0);
  add_screen(direct, noise(), behind(place), right, behind(up), 1.0);
  const LitWorld in_mirror = test::make_world(mirror, rgb_settings());
  const LitWorld alone = test::make_world(direct, rgb_settings());
  for (const double per_m : {1e-4, 2e-3, 1e-2, 0.1}) {
    for (const double x : {-0.5, -0.1, 0.2, 0.55}) {
      const Vec3d eye(3.0, 0.4, 2.5);
      const Line ray{eye, glm::normalize(behind(place + x * right + 0.7 * x * up) - eye)};
      const Vec3f reflected = seen(in_mirror, ray, per_m, 1);
      const Vec3f expected = seen(alone, ray, per_m, 1);
      ASSERT_GT(expected.y, 0.0f);
      // Rays step 2e-6 m off the mirror, and texels of 4 mm differ by up to 0.8.
      EXPECT_LT(glm::distance(reflected, expected), 1e-3f * glm::length(expected))
          << per_m << ", " << x;
    }
  }
}

/// A checkerboard in a ball mirror at z = 0, on a wall at some height: the mean difference of
/// pixels, a ray each, from what 1024 rays see of its squares themselves, as beams choose the level
/// and as the length of the way alone would.
struct Difference {
  double by_beam = 0.0, by_length = 0.0;
};
Difference difference_in_ball(double eye_z, double wall_z, double cell_m, bool is_concave) {
  const double half = 0.5 * kTexels / 4.0 * cell_m, per_m = 0.01;
  const TextureImage checker = image_of(
      [](int x, int y) { return Vec3f((x / 4 + y / 4) % 2 == 0 ? 0.9f : 0.1f, 0.0f, 0.0f); });
  const auto world_with = [&](TextureFilter filter) {
    Scene scene;
    test::add_sphere(scene, test::add(scene, silver()), Vec3d(0.0), 1.0);
    add_screen(scene, checker, {0, 0, wall_z}, {1, 0, 0}, {0, 1, 0}, half, filter);
    return test::make_world(scene, rgb_settings());
  };
  const LitWorld filtered = world_with(TextureFilter::Linear);
  const LitWorld plain = world_with(TextureFilter::Nearest);
  const WorldTexture texture(checker, {}, TextureEncoding::Srgb);
  const Vec3d eye(0, 0, eye_z);
  const auto ray_to = [&](double x, double y) {
    return Line{eye, glm::normalize(Vec3d(0.12 + per_m * x, 0.05 + per_m * y, -1))};
  };
  constexpr int kPixels = 8, kAcross = 32;
  Difference result;
  for (int pixel = 0; pixel < kPixels * kPixels; ++pixel) {
    const int x = pixel % kPixels, y = pixel / kPixels;
    std::vector<Line> rays;
    for (int i = 0; i < kAcross * kAcross; ++i) {
      rays.push_back(ray_to(x + (i % kAcross + 0.5) / kAcross, y + (i / kAcross + 0.5) / kAcross));
    }
    float expected = 0.0f;
    for (const Vec3f& color : all_seen(plain, rays, per_m, 1)) {
      expected += color.x / static_cast<float>(rays.size());
    }
    const Line ray = ray_to(x + 0.5, y + 0.5);
    const Vec3d mirror = on_sphere(ray, Vec3d(0.0), 1.0, is_concave);
    const Vec3d wall =
        on_plane({mirror, mirrored(ray.direction, mirror)}, {0, 0, 1}, {0, 0, wall_z});
    const double width_m = per_m * (glm::distance(eye, mirror) + glm::distance(mirror, wall));
    const Vec2f uv(Vec2d(wall) / (2.0 * half) + 0.5);
    const float by_length = texture.value(uv, static_cast<float>(width_m / (2.0 * half))).x;
    const float by_beam = seen(filtered, ray, per_m, 1).x;
    result.by_beam += static_cast<double>(std::abs(by_beam - expected)) / kPixels / kPixels;
    result.by_length += static_cast<double>(std::abs(by_length - expected)) / kPixels / kPixels;
  }
  return result;
}

TEST(Beam, checkerboard_in_a_ball_is_as_coarse_as_its_pixels) {
  // A convex one shrinks: squares half as wide as a pixel are grey, not noise.
  const Difference convex = difference_in_ball(3.0, 4.0, 0.08, false);
  EXPECT_LT(convex.by_beam, 0.2 * convex.by_length);
  // A concave one magnifies: squares twice as wide as a pixel are there, not grey.
  const Difference concave = difference_in_ball(0.4, 0.45, 0.025, true);
  EXPECT_LT(concave.by_beam, 0.2 * concave.by_length);
}

TEST(Beam, rough_mirror_shows_no_finer_level_than_a_smooth_one_and_in_the_end_what_it_blurs) {
  const auto contrast = [](float roughness, std::uint32_t index) {
    Scene scene;
    test::add_square(scene, test::add(scene, silver(roughness)), 20.0, Mat4d(1.0));
    add_screen(scene, noise(), {0, 0, 2}, {1, 0, 0}, {0, 1, 0}, 20.0);
    const LitWorld world = test::make_world(scene, rgb_settings());
    double sum = 0.0, sum2 = 0.0;
    constexpr int kRays = 64;
    std::vector<Line> rays;
    for (int i = 0; i < kRays; ++i) {
      rays.push_back({{4.0, 0.031 * i, 1.0}, glm::normalize(Vec3d(-1.0, 0.1, -0.8))});
    }
    for (const Vec3f& color : all_seen(world, rays, 2e-2, 1, index)) {
      const double red = static_cast<double>(color.x / std::max(color.y, 1e-6f));
      sum += red;
      sum2 += red * red;
    }
    return std::sqrt(std::max(0.0, sum2 / kRays - sum * sum / kRays / kRays));
  };
  const double smooth = contrast(0.0f, 0);
  const double first = contrast(0.4f, 0);
  const double late = contrast(0.4f, 1u << 20);
  EXPECT_LT(first, 0.5 * smooth);
  EXPECT_GT(late, 2.0 * first);
}

TEST(Beam, widened_beam_is_nowhere_narrower_than_it_would_have_been) {
  const Vec3f along(0.0f, 0.0f, 1.0f);
  for (const float bend : {-2e-3f, 0.0f, 3e-3f}) {
    const Beam beam{{Vec3f(1e-3f, 0, 0), Vec3f(2e-4f, 2e-3f, 0)},
                    {Vec3f(bend, 1e-3f, 0), Vec3f(0, -bend, 0)}};
    for (const float angle_rad : {0.0f, 1e-3f, 0.3f}) {
      const Beam wide = widened(beam, along, angle_rad);
      for (const float way_m : {0.0f, 0.3f, 0.7f, 2.0f, 50.0f}) {
        EXPECT_GE(beam_width_m(moved(wide, way_m), along) * (1.0f + 1e-6f),
                  beam_width_m(moved(beam, way_m), along));
      }
    }
  }
  EXPECT_FLOAT_EQ(lobe_width_rad(100.0f, 0), 0.1f);
  EXPECT_FLOAT_EQ(lobe_width_rad(100.0f, 99), 0.01f);
  EXPECT_EQ(lobe_width_rad(0.0f, 5), 0.0f);
}

}  // namespace
}  // namespace abbe
