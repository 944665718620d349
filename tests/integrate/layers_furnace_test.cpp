// No layer gives back more light than it gets, and rays bring what lobes have.

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "integrate/layered_square.h"

namespace abbe {
namespace {

std::vector<Material> layered() {
  std::vector<Material> all;
  for (const float base : {0.0f, 0.4f, 1.0f}) {
    for (const bool metal : {false, true}) {
      const Material bare = metal ? white_metal(base) : white_plastic(base);
      for (const float coat : {0.0f, 0.4f, 0.8f}) {
        Material m = bare;
        m.clearcoat = coat_of(coat == 0.4f ? 0.5f : 1.0f, coat);
        all.push_back(m);
        m.sheen = sheen_of(Vec3f(1.0f), 0.5f);
        all.push_back(m);
      }
      for (const float sheen : {0.2f, 0.5f, 1.0f}) {
        Material m = bare;
        m.sheen = sheen_of(Vec3f(1.0f, 0.8f, 0.5f), sheen);
        all.push_back(m);
      }
      Material m = bare;
      // Smooth ones are as narrow across as no grid of lamps shows.
      if (base > 0.0f) {
        m.anisotropy = brushed(0.8f);
        all.push_back(m);
      }
      m = bare;
      m.specular = specular_of(1.0f, 10.0f);
      m.diffuse_transmission = through_of(0.5f, 1.0f);
      all.push_back(m);
    }
  }
  return all;
}

TEST(Layers, white_furnace_is_never_passed) {
  for (const Material& m : layered()) {
    for (const double angle : {0.0, 45.0, 75.0, 85.0}) {
      Square square(m);
      const Vec3d view = direction_at(angle);
      double all = square.broad_albedo(view) + square.carried(view, 1).ideal;
      if (m.diffuse_transmission) all += square.broad_albedo(view, true);
      EXPECT_LT(all, 1.0 + 1e-3) << "roughness " << m.roughness << ", metallic " << m.metallic
                                 << ", coat " << (m.clearcoat ? m.clearcoat->roughness : -1.0f)
                                 << ", sheen " << (m.sheen ? m.sheen->roughness : -1.0f) << ", at "
                                 << angle;
      EXPECT_GT(all, 0.05);
    }
  }
}

// Lamps light all lobes; of a sky the narrow ones are found by rays, and none is counted twice.
TEST(Layers, sky_lights_as_lamps_from_all_around_do) {
  for (const float roughness : {0.0f, 0.5f}) {
    for (const bool metal : {false, true}) {
      Material bare = metal ? white_metal(roughness) : white_plastic(roughness);
      bare.base_color_rec709 = Vec4f(0.6f, 0.6f, 0.6f, 1.0f);
      std::vector<Material> all(5, bare);
      all[0].clearcoat = coat_of(1.0f);
      all[1].clearcoat = coat_of(0.8f, 0.5f);
      all[2].sheen = sheen_of(Vec3f(0.5f), 0.5f);
      all[3] = all[1];
      all[3].sheen = all[2].sheen;
      all[3].diffuse_transmission = through_of(0.4f, 0.8f);
      all[4].specular = specular_of(0.7f, 3.0f);
      for (const Material& m : all) {
        const Vec3d view = direction_at(50.0);
        Square square(m);
        double right = square.broad_albedo(view) + square.carried(view, 1).ideal;
        if (m.diffuse_transmission) right += square.broad_albedo(view, true);
        // 2^12 stratified samples of four directions.
        EXPECT_NEAR(square.in_even_light(view, 1 << 12), right, 5e-3)
            << "roughness " << roughness << ", metallic " << metal << ", coat "
            << (m.clearcoat ? m.clearcoat->roughness : -1.0f) << ", sheen "
            << (m.sheen ? m.sheen->roughness : -1.0f);
      }
    }
  }
}

TEST(Layers, sampled_rays_carry_the_integral_of_the_rough_lobes) {
  std::vector<Material> metals;
  for (const float base : {0.4f, 0.8f}) {
    Material m = white_metal(base);
    m.base_color_rec709 = Vec4f(0.9f, 0.7f, 0.5f, 1.0f);
    m.anisotropy = brushed(0.7f, 0.5f);
    metals.push_back(m);
    m.clearcoat = coat_of(0.8f, 0.5f);
    metals.push_back(m);
    m.anisotropy.reset();
    metals.push_back(m);
    m.clearcoat->roughness = 0.0f;
    metals.push_back(m);
  }
  for (const Material& m : metals) {
    for (const double angle : {0.0, 50.0, 75.0}) {
      Square square(m);
      const Vec3d view = direction_at(angle);
      // 2^13 stratified rays, 2^14 directions.
      EXPECT_NEAR(square.carried(view, 1 << 13).sampled, square.broad_albedo(view), 4e-3)
          << "roughness " << m.roughness << ", coat "
          << (m.clearcoat ? m.clearcoat->roughness : -1.0f) << ", at " << angle;
    }
  }
}

// Of a white metal whose microfacets have two roughnesses, by the slopes of its facets over the
// stretched plane where they are round: what of light from a direction leaves it at once.
double brushed_albedo(double alpha_t, double alpha_b, const Vec3d& view) {
  const auto lambda = [&](const Vec3d& v) {
    const double tan2 = (std::pow(alpha_t * v.x, 2) + std::pow(alpha_b * v.y, 2)) / (v.z * v.z);
    return 0.5 * (std::sqrt(1.0 + tan2) - 1.0);
  };
  constexpr int kSteps = 600;
  double sum = 0.0;
  for (int turn = 0; turn < kSteps; ++turn) {
    const double phi = 2.0 * kPi * (turn + 0.5) / kSteps;
    for (int i = 0; i < kSteps; ++i) {
      const double steep = std::tan((i + 0.5) / kSteps * kPi / 2.0);
      const double widens = 1.0 + steep * steep;
      const Vec3d slope(-alpha_t * steep * std::cos(phi), -alpha_b * steep * std::sin(phi), 1.0);
      const Vec3d facet = glm::normalize(slope);
      const Vec3d out = 2.0 * glm::dot(view, facet) * facet - view;
      if (!(glm::dot(view, facet) > 0.0) || !(out.z > 0.0)) continue;
      sum += steep / widens * glm::dot(view, slope) / (1.0 + lambda(view) + lambda(out));
    }
  }
  return sum * kPi / kSteps / kSteps / view.z;
}

// As narrow across as no even grid of lamps shows: of 2^14, light from 75° would be 1.09.
TEST(Layers, polished_brushed_metal_gives_back_what_its_facets_do) {
  Material m = white_metal(0.0f);
  m.anisotropy = brushed(0.8f);
  const double alpha_b = std::pow(static_cast<double>(kSmoothRoughness), 2);
  const double alpha_t = alpha_b + 0.64 * (1.0 - alpha_b);
  for (const double angle : {0.0, 45.0, 75.0, 85.0}) {
    const Vec3d view = direction_at(angle);
    // 2^13 stratified rays.
    EXPECT_NEAR(Square(m).carried(view, 1 << 13).sampled, brushed_albedo(alpha_t, alpha_b, view),
                4e-3)
        << angle;
  }
}

}  // namespace
}  // namespace abbe
