// Albedos of layers against brute-force integration over directions.

#include "abbe/optics/rough/layer_albedo.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "abbe/optics/fresnel.h"
#include "support/ggx.h"

namespace abbe {
namespace {

double coat_by_force(double cosine, double roughness) {
  const test::Ggx ggx{roughness * roughness};
  const Vec3d view(std::sqrt(1.0 - cosine * cosine), 0.0, cosine);
  double sum = 0.0;
  ggx.for_each_visible(view, 300, [&](const Vec2d&, const Vec3d& half, double share) {
    sum += share * ggx.reflected_share(cosine, test::mirrored(view, half).z) *
           fresnel_dielectric(std::min(1.0, glm::dot(view, half)), 1.5).reflectance();
  });
  return sum;
}

TEST(LayerAlbedoTest, coat_is_the_integral_of_its_microfacets) {
  for (const double roughness : {0.1, 0.33, 0.6, 1.0}) {
    for (const double cosine : {0.15, 0.4, 0.7, 1.0}) {
      // Between nodes the table is linear.
      EXPECT_NEAR(
          LayerAlbedo::table().coat(static_cast<float>(cosine), static_cast<float>(roughness)),
          coat_by_force(cosine, roughness), 2e-3)
          << "roughness " << roughness << ", cosine " << cosine;
    }
  }
}

TEST(LayerAlbedoTest, smooth_coat_is_fresnels_reflectance_and_its_mean) {
  for (const double cosine : {0.25, 0.5, 0.9, 1.0}) {
    EXPECT_NEAR(LayerAlbedo::table().coat(static_cast<float>(cosine), 0.0f),
                fresnel_dielectric(cosine, 1.5).reflectance(), 2e-3);
  }
  // Of n = 1.5, as Egan & Hilgeman have it (0.0918).
  EXPECT_NEAR(LayerAlbedo::table().coat_mean(0.0f), 0.0918, 1e-3);
}

// The lobe over even steps of solid angle, and how much that is of light from there.
double sheen_by_force(double cosine, double roughness) {
  constexpr int kHeights = 1500, kTurns = 360;
  const Vec3d view(std::sqrt(1.0 - cosine * cosine), 0.0, cosine);
  double sum = 0.0;
  for (int i = 0; i < kHeights; ++i) {
    for (int j = 0; j < kTurns; ++j) {
      const double z = (i + 0.5) / kHeights, turn = std::numbers::pi * (j + 0.5) / kTurns;
      const double s = std::sqrt(1.0 - z * z);
      const Vec3d light(s * std::cos(turn), s * std::sin(turn), z);
      const Vec3d half = glm::normalize(view + light);
      sum += static_cast<double>(sheen_lobe(static_cast<float>(cosine), static_cast<float>(z),
                                            static_cast<float>(half.z),
                                            static_cast<float>(roughness))) *
             z;
    }
  }
  return sum * 2.0 * std::numbers::pi / (kHeights * kTurns);
}

TEST(LayerAlbedoTest, sheen_is_the_integral_of_its_lobe_and_never_above_one) {
  for (const double roughness : {0.15, 0.3, 0.55, 1.0}) {
    for (const double cosine : {0.02, 0.1, 0.3, 0.6, 0.95}) {
      const double table = static_cast<double>(
          LayerAlbedo::table().sheen(static_cast<float>(cosine), static_cast<float>(roughness)));
      const double right = sheen_by_force(cosine, roughness);
      EXPECT_LT(right, 1.0 + 1e-3);
      // Where it is divided by more for the sake of the light's side, there is less than the table
      // has; elsewhere the table, linear between nodes, is right within a hundredth.
      EXPECT_LT(right, std::min(1.0, table) + 0.01) << roughness << " " << cosine;
      if (roughness > 0.25 && cosine > 0.05) {
        EXPECT_NEAR(table, right, 0.015) << "roughness " << roughness << ", cosine " << cosine;
      }
    }
  }
}

}  // namespace
}  // namespace abbe
