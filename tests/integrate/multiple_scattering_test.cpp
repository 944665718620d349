// Rough metals that give back what meets more than one microfacet.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "abbe/optics/rough/microfacet_loss.h"
#include "integrate/rough_surface.h"
#include "support/ggx.h"
#include "support/scene_builder.h"

namespace abbe {
namespace {

// What the judge says that single scattering loses.
double lost(const test::Ggx& ggx, double cosine) {
  const Vec3d view(std::sqrt(1.0 - cosine * cosine), 0.0, cosine);
  double sum = 0.0;
  ggx.for_each_visible(view, 200, [&](const Vec2d&, const Vec3d& half, double share) {
    sum += share * (1.0 - ggx.reflected_share(cosine, test::mirrored(view, half).z));
  });
  return sum;
}

TEST(MicrofacetLossTest, table_is_the_integral_of_single_scattering) {
  for (const double roughness : {0.1, 0.33, 0.5, 0.77, 1.0}) {
    const test::Ggx ggx{roughness * roughness};
    const auto alpha = static_cast<float>(ggx.alpha);
    double mean = 0.0;
    constexpr int kAngles = 50;
    for (int i = 0; i < kAngles; ++i) {
      const double cosine = std::sqrt((i + 0.5) / kAngles);
      const double right = lost(ggx, cosine);
      mean += right / kAngles;
      // Between nodes the table is linear.
      EXPECT_NEAR(MicrofacetLoss::table().at(static_cast<float>(cosine), alpha), right, 2e-3)
          << "roughness " << roughness << ", cosine " << cosine;
    }
    EXPECT_NEAR(MicrofacetLoss::table().mean(alpha), mean, 1e-3) << "roughness " << roughness;
  }
}

double reflected(const RoughCase& c, bool multiple_scattering) {
  constexpr std::uint32_t kRays = 1 << 18;
  double sum = 0.0;
  RoughSurface surface(c, multiple_scattering);
  surface.follow(
      kRays, true, [&](std::uint32_t) { return c.view(); },
      [&](std::uint32_t, const Escaped& light) {
        if (light.lane == kMiddle && !light.is_refracted) sum += light.share / kRays;
      });
  return sum;
}

TEST(MultipleScattering, white_metal_returns_all_light) {
  for (const double roughness : {0.1, 0.3, 0.6, 1.0}) {
    for (const double angle_deg : {0.0, 45.0, 80.0}) {
      // 2^18 stratified samples.
      EXPECT_NEAR(reflected({Kind::WhiteMetal, roughness, angle_deg}, true), 1.0, 1e-3)
          << "roughness " << roughness << " at " << angle_deg << " degrees";
    }
  }
}

TEST(MultipleScattering, gold_gains_what_its_loss_leaves_after_more_reflections) {
  for (const double roughness : {0.3, 0.6, 1.0}) {
    const RoughCase c{Kind::Gold, roughness, 45.0};
    double k_r = 0.0, mean = 0.0;
    constexpr int kAngles = 50;
    for (int i = 0; i < kAngles; ++i) {
      const double cosine = std::sqrt((i + 0.5) / kAngles);
      k_r += c.reflectance(kMiddle, cosine) / kAngles;
      mean += lost(c.ggx(), cosine) / kAngles;
    }
    const double right = lost(c.ggx(), c.view().z) * k_r * k_r * (1.0 - mean) / (1.0 - k_r * mean);
    // Two runs of 2^18 samples that share their microfacets.
    EXPECT_NEAR(reflected(c, true) - reflected(c, false), right, 2e-3) << c;
  }
}

TEST(MultipleScattering, glass_and_sheets_are_as_without) {
  for (const Kind kind : {Kind::Glass, Kind::GlassFromInside, Kind::Sheet}) {
    const RoughCase c{kind, 0.7, 45.0};
    EXPECT_EQ(reflected(c, true), reflected(c, false)) << c;
  }
}

// What a surface sends along `view` of lamps, with its lobe for more than one microfacet.
double lamps_seen(const RoughCase& c, const Vec3d& view, std::vector<Light> lamps) {
  Scene scene;
  test::add_square(scene, test::add(scene, c.material()), 100.0, Mat4d(1.0));
  scene.lights = std::move(lamps);
  RenderSettings settings;
  settings.mode = Mode::Rgb;
  const LitWorld world = test::make_world(scene, settings);
  IntegratorSettings integrator;
  integrator.multiple_scattering = true;
  CameraSample sample;
  sample.direction = Vec3f(-view);
  sample.origin = -sample.direction;
  std::vector<float> radiance(static_cast<std::size_t>(world.lanes.lane_stride()));
  IntegratorStats stats;
  IntegratorScratch scratch;
  trace_samples(world, integrator, {&sample, 1}, {radiance}, stats, scratch);
  return static_cast<double>(radiance[1]);
}

TEST(MultipleScattering, lamps_from_all_around_show_a_white_metal_as_bright_as_they_are) {
  for (const double roughness : {0.7, 1.0}) {
    for (const double angle_deg : {0.0, 60.0}) {
      const RoughCase c{Kind::WhiteMetal, roughness, angle_deg};
      std::vector<Light> lamps;
      constexpr int kHeights = 48, kTurns = 48;
      for (int i = 0; i < kHeights * kTurns; ++i) {
        // Even in projected solid angle, which makes each lamp's E·cosine the same.
        const double sine = std::sqrt((i / kTurns + 0.5) / kHeights);
        const double turn = 2.0 * kPi * (i % kTurns + 0.5) / kTurns;
        const double cosine = std::sqrt(1.0 - sine * sine);
        const Vec3d light(sine * std::cos(turn), sine * std::sin(turn), cosine);
        lamps.push_back(test::directional_light(-light, kPi / (kHeights * kTurns) / cosine));
      }
      // 2 304 lamps leave 0.002 of the narrower lobe; the table of losses has 0.002.
      EXPECT_NEAR(lamps_seen(c, c.view(), lamps), 1.0, 4e-3) << c;
    }
  }
}

TEST(MultipleScattering, lobe_is_reciprocal) {
  for (const Kind kind : {Kind::WhiteMetal, Kind::Gold}) {
    for (const double roughness : {0.3, 1.0}) {
      const RoughCase c{kind, roughness, 70.0};
      const Vec3d there = c.view(), back(std::sin(0.4), 0.0, std::cos(0.4));
      const double one_way = lamps_seen(c, there, {test::directional_light(-back, 1.0)}) / back.z;
      const double other = lamps_seen(c, back, {test::directional_light(-there, 1.0)}) / there.z;
      // Single precision, off the peak.
      EXPECT_NEAR(one_way / other, 1.0, 1e-4) << c;
    }
  }
}

}  // namespace
}  // namespace abbe
