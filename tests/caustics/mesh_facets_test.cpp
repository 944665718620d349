// Which triangles are one facet: those that are coplanar but for rounding, whatever their tilt; and
// the light off a mirror that is curved so gently that its triangles nearly are.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "abbe/base/constants.h"
#include "abbe/caustics/flat/bodies.h"
#include "abbe/image/exr/exr.h"
#include "support/scene_builder.h"

namespace abbe {
namespace {

using Surface = std::function<Vec3d(double, double)>;

// `count` × `count` quads over u, v in [-1, 1]; its front is where u × v points.
Mesh grid(std::uint32_t count, const Surface& place) {
  Mesh mesh;
  for (std::uint32_t i = 0; i <= count; ++i) {
    for (std::uint32_t j = 0; j <= count; ++j) {
      mesh.positions.emplace_back(place((2.0 * i - count) / count, (2.0 * j - count) / count));
    }
  }
  for (std::uint32_t i = 0; i < count; ++i) {
    for (std::uint32_t j = 0; j < count; ++j) {
      const std::uint32_t a = i * (count + 1) + j;
      mesh.triangles.push_back({a, a + count + 1, a + count + 2});
      mesh.triangles.push_back({a, a + count + 2, a + 1});
    }
  }
  return mesh;
}

// Six such grids as one box, each corner moved in double precision and then rounded.
Mesh gridded_box(std::uint32_t count, const Vec3d& half_m, const Mat4d& baked) {
  Mesh box;
  for (int axis = 0; axis < 3; ++axis) {
    for (const double side : {-1.0, 1.0}) {
      const Mesh face = grid(count, [&](double u, double v) {
        Vec3d at(0.0);
        at[axis] = side;
        at[(axis + 1) % 3] = side * u;
        at[(axis + 2) % 3] = v;
        return Vec3d(baked * Vec4d(half_m * at, 1.0));
      });
      const auto first = static_cast<std::uint32_t>(box.positions.size());
      box.positions.insert(box.positions.end(), face.positions.begin(), face.positions.end());
      for (const auto& t : face.triangles) {
        box.triangles.push_back({t[0] + first, t[1] + first, t[2] + first});
      }
    }
  }
  return box;
}

Scene scene_of(Mesh mesh, const Material& material, const Mat4d& to_world) {
  Scene scene;
  mesh.material = test::add(scene, material);
  scene.meshes.push_back(std::move(mesh));
  scene.instances.push_back({"body", 0u, to_world});
  return scene;
}

std::size_t facet_count(const Scene& scene) {
  Notes notes;
  const FlatBodies flat = find_flat_bodies(scene, notes);
  EXPECT_TRUE(notes.all().empty());
  return flat.facets.size();
}

TEST(MeshFacets, box_of_many_triangles_has_six_facets_wherever_it_stands) {
  const Mat4d turned = test::rotation({1, 2, 3}, 37.0);
  Mat4d stretched(1.0);
  stretched[0][0] = 3.0, stretched[1][1] = 0.02, stretched[2][0] = 0.4;
  const Vec3d half(0.5, 0.03, 0.2);
  for (const std::uint32_t count : {1u, 3u, 12u}) {
    const Mesh box = gridded_box(count, half, Mat4d(1.0));
    const Mesh turned_box = gridded_box(count, half, turned);
    const Mesh far_box = gridded_box(count, half, test::translation({300, -200, 100}) * turned);
    for (const Mat4d& to_world :
         {Mat4d(1.0), turned, stretched * turned, test::translation({1e3, 2e3, -3e3}) * stretched,
          test::translation({1e6, -2e6, 3e6}) * turned}) {
      for (const Mesh& mesh : {box, turned_box, far_box}) {
        EXPECT_EQ(facet_count(scene_of(mesh, test::glass(1.5), to_world)), 6u) << count;
      }
    }
  }
}

TEST(MeshFacets, cap_of_slivers_is_one_facet) {
  // A column of 100 sides turned askew, its caps fans about their first corner.
  constexpr std::uint32_t kSides = 100;
  const Mat4d turned = test::rotation({2, -1, 1}, 71.0);
  Mesh mesh;
  for (std::uint32_t i = 0; i < kSides; ++i) {
    const double angle = 2.0 * kPi * i / kSides;
    for (const double y : {0.0, 1.0}) {
      mesh.positions.emplace_back(Vec3d(turned * Vec4d(std::cos(angle), y, std::sin(angle), 1.0)));
    }
  }
  for (std::uint32_t i = 0; i < kSides; ++i) {
    const std::uint32_t a = 2 * i;
    const std::uint32_t b = 2 * ((i + 1) % kSides);
    mesh.triangles.push_back({a, a + 1, b});
    mesh.triangles.push_back({b, a + 1, b + 1});
    if (i > 0 && i + 1 < kSides) {
      mesh.triangles.push_back({0, a, b});
      mesh.triangles.push_back({1, b + 1, a + 1});
    }
  }
  EXPECT_EQ(facet_count(scene_of(mesh, test::glass(1.5), Mat4d(1.0))), kSides + 2);
}

TEST(MeshFacets, roof_of_a_tenth_of_a_milliradian_is_two_facets) {
  // Over 10 cm it rises 5 µm: a thousand roundings. Directions within 1.4 mrad were one once.
  for (const double tilt_rad : {1e-4, 3e-4, 1e-3}) {
    const Mesh roof = grid(2, [&](double u, double v) {
      return Vec3d(0.05 * u, 0.05 * v, -tilt_rad * 0.05 * std::abs(u));
    });
    // A mirror's are met from both sides, if it has both.
    Material mirror = test::mirror("metal/Ag-Johnson");
    EXPECT_EQ(facet_count(scene_of(roof, mirror, Mat4d(1.0))), 2u) << tilt_rad;
    mirror.double_sided = true;
    EXPECT_EQ(facet_count(scene_of(roof, mirror, Mat4d(1.0))), 4u) << tilt_rad;
  }
}

// A mirror of 10 × 10 cm about the origin, z = ±(x² + y²)/2R to fourth order: its light is to go
// along −Z and a little aside.
constexpr double kHalf_m = 0.05;
constexpr double kRadius_m = 4.0;

Mesh bowl(std::uint32_t count, double sign) {
  return grid(count, [&](double u, double v) {
    const double r2 = kHalf_m * kHalf_m * (u * u + v * v);
    return Vec3d(kHalf_m * u, kHalf_m * v,
                 sign * r2 / (kRadius_m + std::sqrt(kRadius_m * kRadius_m - r2)));
  });
}

Material ideal_mirror() {
  Material material;
  material.roughness = 0.0f;
  material.double_sided = true;
  return material;
}

// The mean irradiance over the lamp's own within a square of 4 × 4 cm, R/2 from a mirror.
double share_at_focus(const Mesh& mirror, const RenderSettings& settings,
                      const std::string& channel) {
  Scene scene = scene_of(mirror, ideal_mirror(), Mat4d(1.0));
  // Aside by 2°, so that the screen keeps no light from the mirror.
  const double aside = 2.0 * kPi / 180.0;
  const Vec3d back(std::sin(aside), 0.0, std::cos(aside));
  const Vec3d screen = 0.5 * kRadius_m * back;
  scene.lights.push_back(test::directional_light({back.x, 0.0, -back.z}, 1000.0));
  test::add_square(scene, test::add(scene, test::matte(Vec3f(1.0f))), 0.03,
                   test::translation(screen) * test::rotation({0, 1, 0}, 182.0));
  scene.cameras.push_back(test::orthographic_camera(screen - 0.5 * back, screen, 0.02, 0.02));
  Scene open = scene;
  open.instances.erase(open.instances.begin());
  open.lights.front() = test::directional_light(back, 1000.0);
  const auto mean = [&](const Image& image) {
    double sum = 0.0;
    for (int y = 0; y < image.height; ++y) {
      for (int x = 0; x < image.width; ++x) {
        sum += static_cast<double>(test::pixel(image, x, y, channel));
      }
    }
    return sum / (image.width * image.height);
  };
  return mean(test::render(scene, settings).image) / mean(test::render(open, settings).image);
}

RenderSettings focus_settings(int size) {
  RenderSettings settings = test::small_settings();
  settings.size = {size, size};
  settings.wavelengths.exact_nm = {550.0};
  return settings;
}

TEST(GentleMirror, bowl_of_4_m_gathers_its_light_in_the_focus) {
  // The lamp's image is as large as a facet, 10 cm / 64, whatever the number of facets.
  const double power =
      share_at_focus(bowl(64, 1.0), focus_settings(64), spectral_channel_name(550.0)) * 0.04 *
      0.04 / (4.0 * kHalf_m * kHalf_m);
  // Aberrations are far below 4 cm; cos 2° of the mirror's area and of edges of 1.6 mm sampled by
  // pixels of 0.6 mm.
  EXPECT_NEAR(power, 1.0, 0.1);
}

TEST(GentleMirror, bowl_gathers_its_light_in_full_spectrum) {
  RenderSettings settings = test::small_settings();
  settings.size = {32, 32};
  const double power =
      share_at_focus(bowl(64, 1.0), settings, "G") * 0.04 * 0.04 / (4.0 * kHalf_m * kHalf_m);
  EXPECT_NEAR(power, 1.0, 0.1);
}

TEST(GentleMirror, ball_of_4_m_spreads_its_light_as_from_behind) {
  // From R/2 behind the mirror to R/2 before it a beam grows to twice its width, so the square gets
  // a quarter of the irradiance. It holds 9.6 stripes of light and dark: a sixth of them off.
  EXPECT_NEAR(share_at_focus(bowl(48, -1.0), focus_settings(64), spectral_channel_name(550.0)),
              0.25, 0.04);
}

TEST(GentleMirror, of_more_triangles_than_can_be_followed_says_so) {
  Notes notes;
  const FlatBodies flat =
      find_flat_bodies(scene_of(bowl(256, 1.0), ideal_mirror(), Mat4d(1.0)), notes);
  EXPECT_TRUE(flat.bodies.empty());
  ASSERT_EQ(notes.all().size(), 1u);
  EXPECT_EQ(notes.all()[0].where, "body");
  EXPECT_THAT(notes.all()[0].text, testing::HasSubstr("131072 triangles"));
}

// Waves of 42°, whose facets light each other.
Mesh waves(std::uint32_t count) {
  return grid(count, [](double u, double v) {
    return Vec3d(u, v, 0.1 * std::sin(9.0 * u) * std::cos(7.0 * v));
  });
}

TEST(WavyMirrors, of_more_facets_together_than_can_be_followed_are_left_out_and_named) {
  // Two of 1800 facets, three of 800: 6000 in all, 2400 without those of the most.
  Material mirror = ideal_mirror();
  mirror.double_sided = false;
  Scene scene = scene_of(waves(30), mirror, Mat4d(1.0));
  scene.instances[0].name = "large";
  scene.meshes.push_back(waves(20));
  scene.meshes.push_back(bowl(32, 1.0));  // A gentle one is counted apart.
  for (const std::uint32_t mesh : {1u, 1u, 1u, 2u, 0u}) {
    const double x = 5.0 * static_cast<double>(scene.instances.size());
    scene.instances.push_back({mesh == 0 ? "large" : "small", mesh, test::translation({x, 0, 0})});
  }
  Notes notes;
  const FlatBodies flat = find_flat_bodies(scene, notes);
  EXPECT_EQ(flat.bodies.size(), 4u);
  for (const FlatBody& body : flat.bodies) EXPECT_EQ(body.name, "small");
  ASSERT_EQ(notes.all().size(), 2u);
  EXPECT_EQ(notes.all()[0].where, "large");
  EXPECT_THAT(notes.all()[0].text,
              testing::HasSubstr("light of lamps that it reflects is left out"));
  EXPECT_THAT(notes.all()[0].text, testing::HasSubstr("facets together, more than 4096"));
  // Without the large ones nothing is left out.
  scene.instances.erase(scene.instances.begin());
  scene.instances.pop_back();
  Notes none;
  EXPECT_EQ(find_flat_bodies(scene, none).bodies.size(), 4u);
  EXPECT_TRUE(none.all().empty());
}

TEST(GentleLens, of_many_facets_is_left_to_straight_rays_and_says_so) {
  // Two gentle bowls back to back, their rims joined by walls of quads.
  constexpr std::uint32_t kCount = 32;
  Mesh lens = bowl(kCount, -1.0);
  const auto half = static_cast<std::uint32_t>(lens.positions.size());
  for (Vec3f& position : lens.positions) position.z += 0.01f;
  const auto top = lens.triangles;
  for (std::uint32_t i = 0; i < half; ++i) {
    lens.positions.push_back(lens.positions[i] * Vec3f(1.0f, 1.0f, -1.0f));
  }
  for (const auto& t : top) lens.triangles.push_back({t[0] + half, t[2] + half, t[1] + half});
  const auto wall = [&](std::uint32_t a, std::uint32_t b) {
    lens.triangles.push_back({b, a, a + half});
    lens.triangles.push_back({b, a + half, b + half});
  };
  for (std::uint32_t i = 0; i < kCount; ++i) {
    const std::uint32_t row = kCount + 1;
    wall(i * row, (i + 1) * row);
    wall((i + 1) * row + kCount, i * row + kCount);
    wall(i + 1, i);
    wall(kCount * row + i, kCount * row + i + 1);
  }
  Notes notes;
  const FlatBodies flat = find_flat_bodies(scene_of(lens, test::glass(1.5), Mat4d(1.0)), notes);
  EXPECT_TRUE(flat.bodies.empty());
  ASSERT_EQ(flat.fallbacks.size(), 1u);
  EXPECT_THAT(flat.fallbacks[0], testing::HasSubstr("facets, more than 512"));
}

}  // namespace
}  // namespace abbe
