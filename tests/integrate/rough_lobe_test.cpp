// Rough metal, glass and sheets against single scattering on GGX microfacets in double precision.

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "integrate/rough_surface.h"
#include "support/ggx.h"
#include "support/scene_builder.h"

namespace abbe {
namespace {

std::vector<RoughCase> cases(const std::vector<double>& roughnesses,
                             const std::vector<double>& angles_deg) {
  std::vector<RoughCase> all;
  for (const Kind kind :
       {Kind::WhiteMetal, Kind::Gold, Kind::Glass, Kind::GlassFromInside, Kind::Sheet}) {
    for (const double roughness : roughnesses) {
      for (const double angle_deg : angles_deg) all.push_back({kind, roughness, angle_deg});
    }
  }
  return all;
}

// The microfacet that sent light there.
Vec3d facet_of(const RoughCase& c, const Vec3d& view, const Escaped& light) {
  Vec3d sum = view + light.direction;
  if (light.is_refracted && c.kind == Kind::Sheet) {
    sum = view + Vec3d(light.direction.x, light.direction.y, -light.direction.z);
  } else if (light.is_refracted) {
    sum = -(view + c.eta_ti(light.lane) * light.direction);
  }
  return glm::normalize(sum.z < 0.0 ? -sum : sum);
}

// What the judge says of a facet: shares and directions.
struct Judged {
  Vec3d reflected{0.0}, refracted{0.0};
  double reflected_share = 0.0, refracted_share = 0.0;
};

Judged judged(const RoughCase& c, int lane, const Vec3d& view, const Vec3d& half) {
  const test::Ggx ggx = c.ggx();
  const double k_r = c.reflectance(lane, std::min(1.0, glm::dot(view, half)));
  Judged result;
  result.reflected = test::mirrored(view, half);
  const double let_by = ggx.reflected_share(view.z, result.reflected.z);
  result.reflected_share = k_r * let_by;
  if (c.kind == Kind::Sheet) {
    result.refracted = {result.reflected.x, result.reflected.y, -result.reflected.z};
    result.refracted_share = (1.0 - k_r) * let_by;
  } else if (const auto t = test::bent(view, half, c.eta_ti(lane)); !c.is_metal() && t) {
    result.refracted = *t;
    result.refracted_share = (1.0 - k_r) * ggx.refracted_share(-t->z);
  }
  return result;
}

TEST(RoughLobe, light_goes_where_a_visible_microfacet_sends_it_with_its_share) {
  for (const RoughCase& c : cases({0.1, 0.3, 0.6, 1.0}, {0.0, 30.0, 60.0, 80.0})) {
    SCOPED_TRACE(testing::PrintToString(c));
    RoughSurface surface(c);
    double worst = 0.0;
    surface.follow(
        500, true, [&](std::uint32_t) { return c.view(); },
        [&](std::uint32_t, const Escaped& light) {
          const Judged right = judged(c, light.lane, c.view(), facet_of(c, c.view(), light));
          const double share = light.is_refracted ? right.refracted_share : right.reflected_share;
          worst = std::max(worst, std::abs(light.share - share));
          EXPECT_EQ(light.is_refracted, light.direction.z < 0.0);
        });
    // The facet is had back from directions in single precision; near the critical angle Fresnel's
    // k_r grows with the root of what they err by.
    EXPECT_LT(worst, 2e-3);
  }
}

constexpr int kRings = 8, kSectors = 12;

int bin_of(const Vec2d& place) {
  return std::min(kRings - 1, static_cast<int>(place.x * kRings)) * kSectors +
         std::min(kSectors - 1, static_cast<int>(place.y * kSectors));
}

// Pearson's sum over bins of at least five, as many standard deviations above what chance makes of
// it. Source: Wilson & Hilferty, PNAS 17, 1931.
double deviation(const std::vector<double>& found, const std::vector<double>& expected) {
  double sum = 0.0, rest_found = 0.0, rest_expected = 0.0;
  int bins = 0;
  for (std::size_t i = 0; i < found.size(); ++i) {
    if (expected[i] < 5.0) {
      rest_found += found[i];
      rest_expected += expected[i];
      continue;
    }
    sum += std::pow(found[i] - expected[i], 2) / expected[i];
    ++bins;
  }
  if (rest_expected >= 5.0) {
    sum += std::pow(rest_found - rest_expected, 2) / rest_expected;
    ++bins;
  }
  if (bins < 2) return rest_found + sum;  // Nothing is expected, or all in one.
  const double freedom = bins - 1;
  const double spread = 2.0 / (9.0 * freedom);
  return (std::cbrt(sum / freedom) - 1.0 + spread) / std::sqrt(spread);
}

TEST(RoughLobe, directions_have_the_density_of_visible_microfacets) {
  constexpr std::uint32_t kRays = 8000;
  for (const RoughCase& c : cases({0.1, 0.3, 0.6, 1.0}, {0.0, 45.0, 80.0})) {
    SCOPED_TRACE(testing::PrintToString(c));
    // The last bin is for light that no ray carries on.
    std::vector<double> expected[2], found[2];
    for (int way = 0; way < 2; ++way) {
      expected[way].assign(kRings * kSectors + 1, 0.0);
      expected[way].back() = kRays;
      found[way] = expected[way];
      std::fill(found[way].begin(), found[way].end() - 1, 0.0);
    }
    const auto count = [](std::vector<double>& bins, const Vec2d& place, double share) {
      bins[static_cast<std::size_t>(bin_of(place))] += share;
      bins.back() -= share;
    };
    c.ggx().for_each_visible(c.view(), 384,
                             [&](const Vec2d& place, const Vec3d& half, double share) {
                               const Judged right = judged(c, kMiddle, c.view(), half);
                               if (right.reflected_share > 0.0)
                                 count(expected[0], place, kRays * share);
                               if (right.refracted_share > 0.0)
                                 count(expected[1], place, kRays * share);
                             });
    RoughSurface surface(c);
    surface.follow(
        kRays, false, [&](std::uint32_t) { return c.view(); },
        [&](std::uint32_t, const Escaped& light) {
          if (light.lane != kMiddle) return;
          const Vec3d half = facet_of(c, c.view(), light);
          count(found[light.is_refracted ? 1 : 0], c.ggx().place_of(half), 1.0);
        });
    // Chance passes four deviations once in 30 000 tries; there are a hundred, with fixed seeds.
    EXPECT_LT(deviation(found[0], expected[0]), 4.0) << "reflected";
    if (!c.is_metal()) {
      EXPECT_LT(deviation(found[1], expected[1]), 4.0) << "refracted";
    }
  }
}

TEST(RoughLobe, power_in_all_and_within_cones_is_that_of_the_integral) {
  const double cone = std::cos(glm::radians(5.0));
  for (const RoughCase& c : cases({0.3, 0.5, 0.7, 1.0}, {0.0, 60.0})) {
    SCOPED_TRACE(testing::PrintToString(c));
    const Vec3d view = c.view();
    const Judged axis = judged(c, kMiddle, view, {0.0, 0.0, 1.0});
    // All that is reflected, that refracted, and of each the part about its axis.
    std::array<double, 4> right{}, found{};
    const auto add = [&](std::array<double, 4>& sums, bool is_refracted, const Vec3d& direction,
                         double share) {
      sums[is_refracted ? 1 : 0] += share;
      const Vec3d& middle = is_refracted ? axis.refracted : axis.reflected;
      if (glm::dot(direction, middle) > cone) sums[is_refracted ? 3 : 2] += share;
    };
    c.ggx().for_each_visible(view, 500, [&](const Vec2d&, const Vec3d& half, double share) {
      const Judged j = judged(c, kMiddle, view, half);
      add(right, false, j.reflected, share * j.reflected_share);
      add(right, true, j.refracted, share * j.refracted_share);
    });
    constexpr std::uint32_t kRays = 1 << 15;
    RoughSurface surface(c);
    surface.follow(
        kRays, true, [&](std::uint32_t) { return view; },
        [&](std::uint32_t, const Escaped& light) {
          if (light.lane != kMiddle) return;
          add(found, light.is_refracted, light.direction, light.share / kRays);
        });
    // 2^15 stratified samples; of the few within a cone, one in ten lies where chance has it.
    EXPECT_NEAR(found[0], right[0], 1e-3);
    EXPECT_NEAR(found[1], right[1], 1e-3);
    EXPECT_NEAR(found[2], right[2], 0.05 * right[2] + 3e-4);
    EXPECT_NEAR(found[3], right[3], 0.05 * right[3] + 3e-4);
    EXPECT_LT(found[0] + found[1], 1.0 + 1e-5);
  }
}

TEST(RoughLobe, glass_exchanges_as_much_between_two_cones_both_ways) {
  // Light from all directions of a ring, by cosine; what gets from a ring of the outside to one of
  // the inside, times n² of where it comes from, is what gets back.
  constexpr int kRingsOfLight = 3;
  constexpr std::uint32_t kRays = 1 << 16;
  const auto ring_of = [](double cosine) {
    return std::min(kRingsOfLight - 1, static_cast<int>((1.0 - cosine * cosine) * kRingsOfLight));
  };
  for (const double roughness : {0.3, 0.7}) {
    double sent[2][kRingsOfLight][kRingsOfLight] = {};
    for (const Kind kind : {Kind::Glass, Kind::GlassFromInside}) {
      const bool inside = kind == Kind::GlassFromInside;
      RoughSurface surface({kind, roughness, 0.0});
      const auto view = [](std::uint32_t i) {
        // Stratified by the golden ratio, and independent of what the surface draws.
        const double u = (i + 0.5) / kRays;
        const double turn = 2.0 * std::numbers::pi * std::fmod(i * 0.6180339887498949, 1.0);
        return Vec3d(std::sqrt(u) * std::cos(turn), std::sqrt(u) * std::sin(turn),
                     std::sqrt(1.0 - u));
      };
      surface.follow(kRays, false, view, [&](std::uint32_t i, const Escaped& light) {
        if (light.lane != kMiddle || !light.is_refracted) return;
        const int from = ring_of(view(i).z), to = ring_of(-light.direction.z);
        (inside ? sent[1][to][from] : sent[0][from][to]) += light.share / kRays;
      });
    }
    const double n = RoughCase{Kind::Glass, roughness, 0.0}.eta_ti(kMiddle);
    for (int a = 0; a < kRingsOfLight; ++a) {
      for (int b = 0; b < kRingsOfLight; ++b) {
        // 2^16 rays, and with n² 3.7 times that error: 0.01 is four deviations of a third of them.
        EXPECT_NEAR(sent[0][a][b], n * n * sent[1][a][b], 0.01)
            << "roughness " << roughness << ", rings " << a << " and " << b;
      }
    }
  }
}

TEST(RoughLobe, highlights_of_lamps_are_the_lobe_and_reciprocal) {
  for (const RoughCase& c : cases({0.05, 0.1, 0.3, 0.6, 1.0}, {0.0, 45.0, 80.0})) {
    SCOPED_TRACE(testing::PrintToString(c));
    // At the mirror's angle to see narrow lobes, too, and off it.
    for (const double off_deg : {0.0, 1.0, 20.0}) {
      const double angle = glm::radians(c.angle_deg - off_deg);
      const Vec3d ends[2] = {c.view(),
                             {-0.6 * std::sin(angle), -0.8 * std::sin(angle), std::cos(angle)}};
      double lobe[2] = {};
      for (int way = 0; way < 2; ++way) {
        const Vec3d view = ends[way], light = ends[1 - way];
        const auto up = [&](const Vec3d& v) {
          return c.kind == Kind::GlassFromInside ? Vec3d(v.x, v.y, -v.z) : v;
        };
        Scene scene;
        test::add_square(scene, test::add(scene, c.material()), 100.0, Mat4d(1.0));
        scene.lights.push_back(test::directional_light(-up(light), 1.0));
        RenderSettings settings;
        settings.mode = Mode::Rgb;
        const LitWorld world = test::make_world(scene, settings);
        CameraSample sample;
        sample.direction = Vec3f(-up(view));
        sample.origin = -sample.direction;
        std::vector<float> radiance(static_cast<std::size_t>(world.lanes.lane_stride()));
        IntegratorStats stats;
        IntegratorScratch scratch;
        trace_samples(world, {}, {&sample, 1}, {radiance}, stats, scratch);
        // From inside, both ways have the same factor of 1/n².
        lobe[way] = static_cast<double>(radiance[1]) / light.z;
      }
      EXPECT_NEAR(lobe[0] / lobe[1], 1.0, 1e-3);
      if (c.kind != Kind::WhiteMetal) continue;
      const test::Ggx ggx = c.ggx();
      const Vec3d half = glm::normalize(ends[0] + ends[1]);
      const double right =
          ggx.distribution(half) /
          (4.0 * ends[0].z * ends[1].z * (1.0 + ggx.lambda(ends[0].z) + ggx.lambda(ends[1].z)));
      // Half vectors in single precision; at roughness 0.05 the lobe falls by half in 0.1°.
      EXPECT_NEAR(lobe[0] / right, 1.0, 1e-3);
    }
  }
}

}  // namespace
}  // namespace abbe
