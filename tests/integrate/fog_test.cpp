// Light that fog scatters once, against integrals and closed forms.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>

#include "abbe/base/constants.h"
#include "abbe/image/exr/exr.h"
#include "abbe/integrate/light/light_paths.h"
#include "abbe/optics/dispersion.h"
#include "abbe/optics/fresnel.h"
#include "support/scene_builder.h"

namespace abbe {
namespace {

constexpr double kExtinction = 0.3;

// Looks down the z axis from z = 5 through fog; nothing else is there but a ball behind the camera.
Scene foggy_scene() {
  Scene scene;
  scene.fog = Fog{.extinction_per_m = kExtinction, .albedo = {}};
  test::add_sphere(scene, test::add(scene, test::matte(Vec3f(0.0f))), {0, 0, 20}, 0.1);
  scene.cameras.push_back(test::orthographic_camera({0, 0, 5}, {0, 0, 0}, 1e-5, 1e-5));
  return scene;
}

RenderSettings fog_settings() {
  RenderSettings settings = test::small_settings();
  settings.samples_per_pixel = 64;
  return settings;
}

double luminance(const Scene& scene) {
  const Image image = test::render(scene, fog_settings()).image;
  return 0.2126 * test::pixel(image, 4, 4, "R") + 0.7152 * test::pixel(image, 4, 4, "G") +
         0.0722 * test::pixel(image, 4, 4, "B");
}

// Simpson's rule with 20 000 intervals.
double integral(double from, double to, const std::function<double(double)>& f) {
  constexpr int kCount = 20000;
  const double h = (to - from) / kCount;
  double sum = f(from) + f(to);
  for (int i = 1; i < kCount; ++i) sum += f(from + i * h) * (i % 2 == 1 ? 4.0 : 2.0);
  return sum * h / 3.0;
}

// What a lamp of 100 cd at (1, 0, 0) sends back from depth t, dimmed on both ways.
double scattered_from_lamp(double t) {
  const double r2 = 1.0 + (5.0 - t) * (5.0 - t);
  return kExtinction / (4.0 * kPi) * 100.0 / r2 * std::exp(-kExtinction * (t + std::sqrt(r2)));
}

TEST(Fog, point_light_shows_the_integral_of_single_scattering) {
  Scene scene = foggy_scene();
  scene.lights.push_back(test::point_light({1, 0, 0}, 100.0));
  const double expected = integral(0.0, 40.0, scattered_from_lamp);
  // 128 places stratified in angle: the smooth rest varies by 2e-3 of the whole.
  EXPECT_NEAR(luminance(scene) / expected, 1.0, 2e-3);
}

TEST(Fog, ball_in_the_way_leaves_a_shaft_of_shadow) {
  Scene scene = foggy_scene();
  scene.lights.push_back(test::point_light({1, 0, 0}, 100.0));
  // A plate at x = 0.5 that hides z from 0 to 1: its edges are at z/2.
  test::add_box(scene, test::add(scene, test::matte(Vec3f(0.0f))), {0.001, 1.0, 0.25},
                test::translation({0.5, 0.0, 0.25}));
  const double expected =
      integral(0.0, 4.0, scattered_from_lamp) + integral(5.0, 40.0, scattered_from_lamp);
  // The two edges fall into one of 128 strata each, and the plate is 2 mm thick.
  EXPECT_NEAR(luminance(scene) / expected, 1.0, 0.015);
}

TEST(Fog, spot_light_shows_its_cone_alone) {
  for (const double tilt_deg : {0.0, 40.0, 85.0, 130.0}) {
    Scene scene = foggy_scene();
    Light light = test::point_light({1, 0, 0}, 100.0);
    light.type = LightType::Spot;
    light.inner_cone_rad = 0.1;
    light.outer_cone_rad = 0.5;
    // A lamp shines along its −z, here turned to −x and then towards +z, the camera.
    light.to_world = light.to_world * test::rotation({0, 1, 0}, 90.0 + tilt_deg);
    const double tilt = glm::radians(tilt_deg);
    const Vec3d axis(-std::cos(tilt), 0.0, std::sin(tilt));
    scene.lights.push_back(light);
    const double scale = 1.0 / (std::cos(0.1) - std::cos(0.5));
    const double expected = integral(0.0, 40.0, [&](double t) {
      const Vec3d way(-1.0, 0.0, 5.0 - t);
      const double cosine = glm::dot(glm::normalize(way), axis);
      const double cone = std::clamp((cosine - std::cos(0.5)) * scale, 0.0, 1.0);
      return scattered_from_lamp(t) * cone * cone;
    });
    // Stratified as the point light; the cone's soft edge adds to it.
    EXPECT_NEAR(luminance(scene), expected, 2e-3 * expected + 1e-7) << tilt_deg;
  }
}

TEST(Fog, beam_across_the_view_glows_by_its_width_without_noise) {
  Scene scene = foggy_scene();
  Light beam = test::directional_light({1, 0, 0}, 1000.0);
  beam.beam = BeamSize{.width_m = 0.04, .height_m = 0.06};
  beam.to_world = test::translation({-0.5, 0, 0}) * test::rotation({0, 1, 0}, -90.0);
  scene.lights.push_back(beam);
  // Its width lies along z: from depth 4.98 to 5.02, half a metre behind its window.
  const double expected = 1000.0 / (4.0 * kPi) * std::exp(-0.5 * kExtinction) *
                          (std::exp(-4.98 * kExtinction) - std::exp(-5.02 * kExtinction));
  // Single precision of e^(−σt) differences.
  EXPECT_NEAR(luminance(scene) / expected, 1.0, 5e-4);
}

TEST(Fog, point_light_above_a_slab_of_glass_lights_the_fog_below_on_bent_ways) {
  Scene scene = foggy_scene();
  scene.lights.push_back(test::point_light({0, 2, 0}, 100.0));
  // A wall ends the view at z = -4, before the slab's own ends come into play.
  test::add_square(scene, test::add(scene, test::matte(Vec3f(0.0f))), 0.05,
                   test::translation({0, 0, -4}));
  RenderSettings settings = fog_settings();
  settings.wavelengths.exact_nm = {kLine_d_nm};
  const auto radiance = [&] {
    return static_cast<double>(
        test::pixel(test::render(scene, settings).image, 4, 4, spectral_channel_name(kLine_d_nm)));
  };
  const double open = radiance();
  test::add_box(scene, test::add(scene, test::glass("glass/schott/N-SF11")), {5.0, 0.2, 5.0},
                test::translation({0, 1.0, 0}));
  const double below = radiance();
  const double open_integral = integral(0.0, 9.0, [](double t) {
    const double r2 = 4.0 + (5.0 - t) * (5.0 - t);
    return std::exp(-kExtinction * (t + std::sqrt(r2))) / r2;
  });
  // The ways one by one, in double precision; smooth, so that 240 places are plenty.
  const LitWorld world = test::make_world(scene, settings);
  double below_integral = 0.0;
  constexpr int kPlaces = 240;
  for (int i = 0; i < kPlaces; ++i) {
    const double t = 9.0 * (i + 0.5) / kPlaces;
    for (const LightChain& chain : chains_to_light(world, 0, {0.0, 0.0, 5.0 - t}, 0)) {
      below_integral += chain.paths.front().irradiance * std::exp(-kExtinction * t) * 9.0 / kPlaces;
    }
  }
  // The slab brings the lamp nearer by more than its faces take away.
  EXPECT_GT(below, 1.02 * open);
  // Stratified as the point light above, twice.
  EXPECT_NEAR(below / open, below_integral / open_integral, 4e-3 * below / open);
}

TEST(Fog, sun_in_fog_before_a_black_wall_shows_what_fog_hides) {
  Scene scene = foggy_scene();
  scene.lights.push_back(test::directional_light({1, 0, 0}, 1000.0));
  test::add_square(scene, test::add(scene, test::matte(Vec3f(0.0f))), 0.01,
                   test::translation({0, 0, 1}));
  const double expected = 1000.0 / (4.0 * kPi) * (1.0 - std::exp(-4.0 * kExtinction));
  // The wavelength quadrature's 1e-4.
  EXPECT_NEAR(luminance(scene) / expected, 1.0, 2e-4);
}

// A sun's illuminance is what it is at the scene: a pane that is hardly there, or a mirror on the
// way, changes nothing of what fog takes.
TEST(Fog, sun_behind_a_pane_or_off_a_mirror_is_the_sun) {
  Scene scene = foggy_scene();
  // The sun shines upwards; what the mirror above throws down, slanted, falls on the floor as well.
  test::add_square(scene, test::add(scene, test::matte(Vec3f(0.5f))), 0.05,
                   test::translation({0, 0, 1}));
  const auto lit_by = [&](const Vec3d& towards) {
    Scene lit = scene;
    lit.lights.push_back(test::directional_light(towards, 1000.0));
    return lit;
  };
  const double straight = luminance(lit_by({0, 1, -1}));
  Scene paned = lit_by({0, 1, -1});
  test::add_box(paned, test::add(paned, test::glass(1.0001)), {12.0, 0.1, 12.0},
                test::translation({0, -2, 1}));
  // Two faces lose (0.00005)² each; the quadrature's 1e-4.
  EXPECT_NEAR(luminance(paned) / straight, 1.0, 4e-4);

  Scene mirrored = lit_by({0, -1, -1});
  Material gold = test::mirror("metal/Au-Johnson");
  test::add_square(mirrored, test::add(mirrored, gold), 10.0,
                   test::translation({0, -2, 1}) * test::rotation({1, 0, 0}, -90.0));
  Scene bare = mirrored;
  bare.fog.reset();
  Scene without = lit_by({0, -1, -1});
  Scene bare_without = without;
  bare_without.fog.reset();
  // What the mirror adds on the wall itself, less what fog takes between it and the camera.
  const double clear = luminance(bare) - luminance(bare_without);
  const double wall_only = std::exp(-4.0 * kExtinction) * clear;
  // Fog that the mirror lights scatters as if the sun came that way, too: half a metre of its own.
  const double fog = luminance(mirrored) - luminance(without) - wall_only;
  const double reflected = clear / (luminance(bare_without));
  const double fog_of_sun =
      luminance(lit_by({0, -1, -1})) - std::exp(-4.0 * kExtinction) * luminance(bare_without);
  EXPECT_NEAR(fog / (reflected * fog_of_sun), 1.0, 4e-3);
}

// A beam in the XZ plane that passes a 60° prism of N-SF11 at minimum deviation for the d line.
struct FoggyPrism {
  static constexpr double kApart_m = 0.3;   ///< From the prism to where the camera looks.
  static constexpr double kBefore_m = 0.2;  ///< From the beam's window to the prism.
  double n_d, angle_d;
  Vec3d entry{-0.02, 0.0, 0.02 * 0.5 / std::sqrt(0.75)};
  Vec3d towards;

  FoggyPrism() {
    n_d = refractive_index(test::glass("glass/schott/N-SF11").index, kLine_d_nm);
    angle_d = std::asin(0.5 * n_d);
    towards = way(angle_d - kPi / 6.0);
  }
  static Vec3d way(double angle) { return {std::sin(angle), 0.0, -std::cos(angle)}; }

  // Radiance of a line, looking down the prism's edge at a place in the beam.
  double radiance(const Vec3d& place, bool has_prism, double wavelength_nm) const {
    Scene scene;
    scene.fog = Fog{.extinction_per_m = kExtinction, .albedo = {}};
    if (has_prism) {
      test::add_prism(scene, test::add(scene, test::glass("glass/schott/N-SF11")), 60.0, 0.06,
                      Mat4d(1.0));
    } else {
      test::add_sphere(scene, test::add(scene, test::matte(Vec3f(0.0f))), {0, 0, 20}, 0.1);
    }
    Light beam = test::directional_light(towards, 1000.0);
    beam.beam = BeamSize{.width_m = 0.002, .height_m = 0.016};
    // Its −z along the way, its y upright.
    const double turn_deg = glm::degrees(std::atan2(-towards.x, -towards.z));
    const Vec3d start = entry - kBefore_m * towards;
    beam.to_world = test::translation(start) * test::rotation({0, 1, 0}, turn_deg);
    scene.lights.push_back(beam);
    scene.cameras.push_back(test::orthographic_camera(place + Vec3d(0, 1, 0), place, 1e-5, 1e-5));
    RenderSettings settings = test::small_settings();
    settings.wavelengths.exact_nm = {kLineF_nm, kLine_d_nm, kLineC_nm};
    return test::pixel(test::render(scene, settings).image, 4, 4,
                       spectral_channel_name(wavelength_nm));
  }
};

TEST(Fog, beam_behind_a_prism_glows_where_each_line_goes_and_as_bright_as_fresnel_says) {
  const FoggyPrism prism;
  const Dispersion index = test::glass("glass/schott/N-SF11").index;
  for (const double line_nm : {kLineF_nm, kLine_d_nm, kLineC_nm}) {
    const double n = refractive_index(index, line_nm);
    const double angle_2 = std::asin(std::sin(prism.angle_d) / n);
    const double angle_3 = kPi / 3.0 - angle_2;
    const double angle_4 = std::asin(n * std::sin(angle_3));
    // From the entry along the refracted way to the second face, n·x = 0 there.
    const Vec3d inside = FoggyPrism::way(angle_2 - kPi / 6.0);
    const Vec3d normal(0.5, 0.0, -std::sqrt(0.75));
    const Vec3d exit =
        prism.entry - glm::dot(normal, prism.entry) / glm::dot(normal, inside) * inside;
    const Vec3d place = exit + FoggyPrism::kApart_m * FoggyPrism::way(kPi / 6.0 - angle_4);
    const double open = prism.radiance(prism.entry - 0.1 * prism.towards, false, line_nm);
    const double tau = fresnel_dielectric(std::cos(prism.angle_d), n).transmittance() *
                       fresnel_dielectric(std::cos(angle_3), 1.0 / n).transmittance();
    const double narrowing =
        std::cos(prism.angle_d) / std::cos(angle_2) * std::cos(angle_3) / std::cos(angle_4);
    const double farther_m = FoggyPrism::kBefore_m - 0.1 + FoggyPrism::kApart_m;
    // Single precision.
    EXPECT_NEAR(prism.radiance(place, true, line_nm) / open,
                tau * narrowing * std::exp(-kExtinction * farther_m), 1e-4)
        << line_nm;
    for (const double other_nm : {kLineF_nm, kLine_d_nm, kLineC_nm}) {
      if (other_nm == line_nm) continue;
      // The lines are apart by more than the beam is wide.
      EXPECT_EQ(prism.radiance(place, true, other_nm), 0.0) << line_nm << ' ' << other_nm;
    }
  }
}

}  // namespace
}  // namespace abbe
