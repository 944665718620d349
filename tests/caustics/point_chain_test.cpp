// Light of point and spot lamps through and off flat faces, against closed forms.

#include <gtest/gtest.h>

#include <cmath>

#include "abbe/base/constants.h"
#include "abbe/image/exr/exr.h"
#include "abbe/optics/dispersion.h"
#include "abbe/optics/fresnel.h"
#include "support/scene_builder.h"

namespace abbe {
namespace {

constexpr double kLampHeight_m = 2.0;

RenderSettings line_settings() {
  RenderSettings settings = test::small_settings();
  settings.wavelengths.exact_nm = {kLineF_nm, kLine_d_nm, kLineC_nm};
  return settings;
}

// Radiance at the middle of the picture.
double radiance(const Scene& scene, const RenderSettings& settings, double wavelength_nm) {
  return static_cast<double>(
      test::pixel(test::render(scene, settings).image, 4, 4, spectral_channel_name(wavelength_nm)));
}

// A matte floor at y = 0, seen at one point from a side, and a lamp of 1 cd above the origin.
Scene floor_scene(const Vec3d& target) {
  Scene scene;
  test::add_square(scene, test::add(scene, test::matte(Vec3f(1.0f))), 20.0,
                   test::rotation({1, 0, 0}, -90.0));
  scene.lights.push_back(test::point_light({0, kLampHeight_m, 0}, 1.0));
  const Vec3d way = glm::normalize(Vec3d(0.9, -0.1, 0.0));
  scene.cameras.push_back(test::orthographic_camera(target - 4.0 * way, target, 1e-5, 1e-5));
  return scene;
}

// What 1 lx of the lamp's light makes of the floor's radiance, by the light right below it.
double radiance_per_lux(double wavelength_nm) {
  return radiance(floor_scene({0, 0, 0}), line_settings(), wavelength_nm) * kLampHeight_m *
         kLampHeight_m;
}

// Illuminance of a floor below a lamp of 1 cd and a clear slab between, by the angle of the ray
// outside: E = I·τ²·cosθ·dΩ/dA⊥ with r(θ) = h·tanθ + t·tanθ′, dΩ = sinθ dθ dφ, dA = r dr dφ.
struct SlabLight {
  double r_m = 0.0, illuminance = 0.0;
};
SlabLight slab_light(double angle_rad, double n, double thickness_m) {
  const double sine = std::sin(angle_rad);
  const double cosine = std::cos(angle_rad);
  const double cos_inside = std::sqrt(1.0 - sine * sine / (n * n));
  const double air_m = kLampHeight_m - thickness_m;
  const double r = air_m * sine / cosine + thickness_m * sine / (n * cos_inside);
  const double dr =
      air_m / (cosine * cosine) + thickness_m * cosine / (n * cos_inside * cos_inside * cos_inside);
  const double tau = fresnel_dielectric(cosine, n).transmittance();
  return {r, tau * tau * sine / (r * dr)};
}

TEST(PointChain, slab_of_dispersive_glass_lights_the_floor_by_the_closed_form) {
  Material glass = test::glass("glass/schott/N-SF11");
  for (const double angle_deg : {5.0, 30.0, 55.0}) {
    for (const double line_nm : {kLineF_nm, kLine_d_nm, kLineC_nm}) {
      const double n = refractive_index(glass.index, line_nm);
      const SlabLight expected = slab_light(glm::radians(angle_deg), n, 0.4);
      Scene scene = floor_scene({-expected.r_m, 0.0, 0.0});
      test::add_box(scene, test::add(scene, glass), {5.0, 0.2, 5.0},
                    test::translation({0, 1.0, 0}));
      RenderSettings settings = line_settings();
      settings.inner_reflections = 0;
      const double measured = radiance(scene, settings, line_nm) / radiance_per_lux(line_nm);
      // Single precision.
      EXPECT_NEAR(measured, expected.illuminance, 1e-4 * expected.illuminance)
          << angle_deg << "°, " << line_nm;
    }
  }
}

TEST(PointChain, two_inner_reflections_of_a_slab_add_what_fresnel_leaves_for_them) {
  // Right below the lamp: E = τ²/(h + t/n)² once, and τ²ρ²/(h + 3t/n)² behind two reflections. The
  // sides, which reflect too, are far away.
  const double n = 1.8;
  const double air_m = kLampHeight_m - 0.4;
  Scene scene = floor_scene({0, 0, 0});
  test::add_box(scene, test::add(scene, test::glass(n)), {50.0, 0.2, 50.0},
                test::translation({0, 1.0, 0}));
  RenderSettings settings = line_settings();
  settings.inner_reflections = 2;
  const double rho = normal_reflectance(n);
  const double tau = 1.0 - rho;
  const double expected = tau * tau / std::pow(air_m + 0.4 / n, 2) +
                          tau * tau * rho * rho / std::pow(air_m + 1.2 / n, 2);
  EXPECT_NEAR(radiance(scene, settings, kLine_d_nm) / radiance_per_lux(kLine_d_nm), expected,
              1e-4 * expected);  // Single precision.
}

TEST(PointChain, two_slabs_one_below_the_other_are_two_bodies_of_a_chain) {
  Scene scene = floor_scene({0, 0, 0});
  test::add_box(scene, test::add(scene, test::glass(1.5)), {5.0, 0.1, 5.0},
                test::translation({0, 1.5, 0}));
  test::add_box(scene, test::add(scene, test::glass(1.7)), {5.0, 0.2, 5.0},
                test::translation({0, 0.7, 0}));
  RenderSettings settings = line_settings();
  settings.inner_reflections = 0;
  const double tau = (1.0 - normal_reflectance(1.5)) * (1.0 - normal_reflectance(1.7));
  const double path_m = 1.4 + 0.2 / 1.5 + 0.4 / 1.7;
  // Once to and fro between them, too: half a metre apart.
  const double echo = normal_reflectance(1.5) * normal_reflectance(1.7);
  const double expected =
      tau * tau * (1.0 / (path_m * path_m) + echo / ((path_m + 1.0) * (path_m + 1.0)));
  EXPECT_NEAR(radiance(scene, settings, kLine_d_nm) / radiance_per_lux(kLine_d_nm), expected,
              1e-4 * expected);  // Single precision.
}

TEST(PointChain, absorption_counts_the_bent_way) {
  const double n = 1.6;
  const double angle = glm::radians(40.0);
  const SlabLight expected = slab_light(angle, n, 0.4);
  Scene scene = floor_scene({-expected.r_m, 0.0, 0.0});
  Material glass = test::glass(n);
  glass.absorption_per_m = Spectrum::constant(3.0);
  test::add_box(scene, test::add(scene, glass), {5.0, 0.2, 5.0}, test::translation({0, 1.0, 0}));
  RenderSettings settings = line_settings();
  settings.inner_reflections = 0;
  const double path_m = 0.4 / std::sqrt(1.0 - std::pow(std::sin(angle) / n, 2));
  const double dimmed = expected.illuminance * std::exp(-3.0 * path_m);
  EXPECT_NEAR(radiance(scene, settings, kLine_d_nm) / radiance_per_lux(kLine_d_nm), dimmed,
              1e-4 * dimmed);  // Single precision.
}

TEST(PointChain, mirror_is_a_lamp_behind_it) {
  // A mirror of 1 m at x = 1, facing the lamp; the mirror image of the lamp is at x = 2.
  Scene scene = floor_scene({-0.5, 0.0, 0.0});
  const double bare = radiance(scene, line_settings(), kLine_d_nm);
  const Material silver = test::mirror("metal/Ag-Johnson");
  test::add_square(scene, test::add(scene, silver), 1.0,
                   test::translation({1, 1, 0}) * test::rotation({0, 1, 0}, -90.0));
  const double distance2 = 2.5 * 2.5 + kLampHeight_m * kLampHeight_m;
  const double reflectance =
      fresnel_conductor(2.5 / std::sqrt(distance2), silver.conductor->n.value(kLine_d_nm),
                        silver.conductor->k.value(kLine_d_nm));
  const double expected = reflectance * kLampHeight_m / (distance2 * std::sqrt(distance2));
  const double added = radiance(scene, line_settings(), kLine_d_nm) - bare;
  // A difference of two radiances in single precision.
  EXPECT_NEAR(added / radiance_per_lux(kLine_d_nm), expected, 2e-5);
}

TEST(PointChain, mirror_lights_only_what_its_outline_lets_see_the_lamp) {
  // The image at (2, 2) sends light through the mirror, x = 1 and y up to 1, down to where the ray
  // through its lower and upper edge meets the floor: x = 0 at y = 1.
  const auto added = [](double x) {
    Scene scene = floor_scene({x, 0.0, 0.0});
    const double bare = radiance(scene, line_settings(), kLine_d_nm);
    test::add_square(scene, test::add(scene, test::mirror("metal/Ag-Johnson")), 0.5,
                     test::translation({1, 0.5, 0}) * test::rotation({0, 1, 0}, -90.0));
    return radiance(scene, line_settings(), kLine_d_nm) - bare;
  };
  EXPECT_GT(added(0.01), 0.0);
  EXPECT_EQ(added(-0.01), 0.0);
}

TEST(PointChain, ground_under_water_is_as_far_as_the_index_makes_it) {
  // Straight below: E⊥ = I·τ/(h + d/n)². Out to the camera: τ/n².
  const double n = 4.0 / 3.0;
  Scene scene = floor_scene({0, 0, 0});
  scene.cameras.front() = test::orthographic_camera({0.0, 1.5, 0.0}, {0, 0, 0}, 1e-5, 1e-5);
  // A floor of the water's own index does not shine in it.
  scene.materials.front().index = ConstantIndex{n};
  test::add_box(scene, test::add(scene, test::glass(n)), {10.0, 0.6, 10.0},
                test::translation({0, 0.4, 0}));
  RenderSettings settings = line_settings();
  settings.inner_reflections = 0;
  const double tau = 1.0 - normal_reflectance(n);
  const double expected = tau / std::pow(1.0 + 1.0 / n, 2) * tau / (n * n);
  EXPECT_NEAR(radiance(scene, settings, kLine_d_nm) / radiance_per_lux(kLine_d_nm), expected,
              1e-4 * expected);  // Single precision.
}

TEST(PointChain, lamp_inside_glass_lights_the_floor_below) {
  // In glass over d = 0.5 m, then h = 1.5 m of air: E = I·τ/(d + n·h)².
  const double n = 1.5;
  Scene scene = floor_scene({0, 0, 0});
  test::add_box(scene, test::add(scene, test::glass(n)), {3.0, 0.7, 3.0},
                test::translation({0, 2.2, 0}));
  RenderSettings settings = line_settings();
  settings.inner_reflections = 0;
  const double expected = (1.0 - normal_reflectance(n)) / std::pow(0.5 + n * 1.5, 2);
  EXPECT_NEAR(radiance(scene, settings, kLine_d_nm) / radiance_per_lux(kLine_d_nm), expected,
              1e-4 * expected);  // Single precision.
}

TEST(PointChain, opaque_ball_before_behind_or_in_the_glass_blocks_the_light) {
  for (const double height : {1.5, 1.0, 0.5}) {
    Scene scene = floor_scene({0, 0, 0});
    RenderSettings settings = line_settings();
    settings.inner_reflections = 0;
    test::add_box(scene, test::add(scene, test::glass(1.5)), {1.0, 0.2, 1.0},
                  test::translation({0, 1.0, 0}));
    test::add_sphere(scene, test::add(scene, test::matte(Vec3f(0.5f))), {0, height, 0}, 0.05);
    EXPECT_EQ(radiance(scene, settings, kLine_d_nm), 0.0) << height;
  }
}

TEST(PointChain, spot_lights_through_glass_only_inside_its_cone) {
  const double n = 1.5;
  for (const double angle_deg : {9.0, 11.0}) {
    const SlabLight expected = slab_light(glm::radians(angle_deg), n, 0.4);
    Scene scene = floor_scene({-expected.r_m, 0.0, 0.0});
    Light& lamp = scene.lights.front();
    lamp.type = LightType::Spot;
    lamp.inner_cone_rad = glm::radians(9.5);
    lamp.outer_cone_rad = glm::radians(10.0);
    lamp.to_world = lamp.to_world * test::rotation({1, 0, 0}, -90.0);
    test::add_box(scene, test::add(scene, test::glass(n)), {5.0, 0.2, 5.0},
                  test::translation({0, 1.0, 0}));
    RenderSettings settings = line_settings();
    settings.inner_reflections = 0;
    const double measured = radiance(scene, settings, kLine_d_nm) / radiance_per_lux(kLine_d_nm);
    if (angle_deg < 10.0) {
      EXPECT_NEAR(measured, expected.illuminance,
                  1e-4 * expected.illuminance);  // Single precision.
    } else {
      EXPECT_EQ(measured, 0.0);
    }
  }
}

TEST(PointChain, mesh_with_a_face_that_is_not_convex_has_no_dark_seam) {
  // An L of glass, of which top and bottom are six triangles each: light crosses their seams.
  Mesh mesh;
  const std::vector<Vec2f> outline = {{0, 0}, {2, 0}, {2, 1}, {1, 1}, {1, 2}, {0, 2}};
  for (const float y : {0.8f, 1.2f}) {
    for (const Vec2f& p : outline) mesh.positions.push_back({p.x - 0.5f, y, p.y - 0.5f});
  }
  const std::vector<std::array<std::uint32_t, 3>> top = {
      {0, 1, 2}, {0, 2, 3}, {0, 3, 4}, {0, 4, 5}};
  for (const auto& t : top) {
    mesh.triangles.push_back(t);  // Of the lower side: seen from below counter-clockwise.
    mesh.triangles.push_back({t[0] + 6, t[2] + 6, t[1] + 6});
  }
  for (std::uint32_t i = 0; i < 6; ++i) {
    const std::uint32_t j = (i + 1) % 6;
    mesh.triangles.push_back({i, i + 6, j});
    mesh.triangles.push_back({j, i + 6, j + 6});
  }
  Scene scene = floor_scene({0, 0, 0});
  const double n = 1.5;
  mesh.material = test::add(scene, test::glass(n));
  scene.instances.push_back({.name = "L", .what = static_cast<std::uint32_t>(scene.meshes.size())});
  scene.meshes.push_back(mesh);
  RenderSettings settings = line_settings();
  settings.inner_reflections = 0;
  // A patch of floor whose light crosses the seam from (0, 0) to (1, 1) in the middle.
  settings.size = {32, 32};
  scene.cameras.front() = test::orthographic_camera({0, 0.5, 0}, {0, 0, 0}, 0.05, 0.05);
  const Image image = test::render(scene, settings).image;
  const double expected = std::pow(1.0 - normal_reflectance(n), 2) /
                          std::pow(kLampHeight_m - 0.4 + 0.4 / n, 2) * radiance_per_lux(kLine_d_nm);
  for (int y = 0; y < 32; ++y) {
    for (int x = 0; x < 32; ++x) {
      const auto value =
          static_cast<double>(test::pixel(image, x, y, spectral_channel_name(kLine_d_nm)));
      // 0.05 m from the axis the cosines take 0.2 %.
      EXPECT_NEAR(value, expected, 4e-3 * expected) << x << ", " << y;
    }
  }
}

TEST(PointChain, film_on_the_glass_changes_the_light_as_fresnel_with_it_does) {
  // A quarter wave of index √n at 550 nm takes the reflection away.
  const double n = 1.52;
  Material coated = test::glass(n);
  ThinFilm film;
  film.index = ConstantIndex{std::sqrt(n)};
  film.thickness_max_nm = static_cast<float>(550.0 / 4.0 / std::sqrt(n));
  coated.film = film;
  RenderSettings settings = test::small_settings();
  settings.wavelengths.exact_nm = {550.0};
  settings.inner_reflections = 0;
  for (const bool is_parallel : {false, true}) {
    Scene scene = floor_scene({0, 0, 0});
    if (is_parallel) scene.lights.front() = test::directional_light({0, -1, 0}, 1.0);
    const double bare = radiance(scene, settings, 550.0);
    test::add_box(scene, test::add(scene, coated), {5.0, 0.2, 5.0}, test::translation({0, 1.0, 0}));
    const double apparent =
        is_parallel ? 1.0 : std::pow(kLampHeight_m / (kLampHeight_m - 0.4 + 0.4 / n), 2);
    // Single precision.
    EXPECT_NEAR(radiance(scene, settings, 550.0) / bare, apparent, 1e-4 * apparent);
  }
}

}  // namespace
}  // namespace abbe
