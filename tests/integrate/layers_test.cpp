// Clearcoat, sheen, anisotropy, specular and diffuse transmission against closed forms.

#include <gtest/gtest.h>

#include <cmath>

#include "integrate/layered_square.h"

namespace abbe {
namespace {

TEST(Layers, smooth_coat_on_smooth_metal_is_a_pane_before_a_mirror) {
  Material m = white_metal(0.0f);
  m.base_color_rec709 = Vec4f(0.5f, 0.5f, 0.5f, 1.0f);
  m.clearcoat = coat_of(0.75f);
  for (const double angle : {0.0, 45.0, 75.0}) {
    const Vec3d view = direction_at(angle);
    const double coat = k_r(view.z);
    const double metal = 0.5 + 0.5 * std::pow(1.0 - view.z, 5);
    const double covered = coat + (1 - coat) * (1 - coat) * metal / (1 - metal * coat);
    // One ray for both, in single precision.
    EXPECT_NEAR(Square(m).carried(view, 1).ideal, 0.25 * metal + 0.75 * covered, 1e-5) << angle;
  }
}

TEST(Layers, coat_takes_from_diffuse_light_on_both_ways) {
  Material m = test::matte(Vec3f(0.4f));
  m.clearcoat = coat_of(1.0f);
  const Vec3d view = direction_at(30.0), light = direction_at(60.0);
  const double right =
      0.4 / kPi * light.z * (1 - k_r(view.z)) * (1 - k_r(light.z)) / (1 - 0.4 * 0.0918);
  // The mean of Fresnel's reflectance comes from a table, within 1e-3 of 0.0918.
  EXPECT_NEAR(Square(m).lit_by(view, {test::directional_light(-light, 1.0)}), right,
              2e-4 * right + 5e-5);
}

TEST(Layers, specular_gives_the_reflectance_at_normal_and_grazing_incidence) {
  Material m = white_plastic(0.0f);
  m.specular = specular_of(0.5f, 2.0f);
  EXPECT_NEAR(Square(m).carried(direction_at(0.0), 1).ideal, 0.5 * 0.08, 1e-5);
  const Vec3d steep = direction_at(80.0);
  const double grazing = (k_r(steep.z) - 0.04) / 0.96;
  EXPECT_NEAR(Square(m).carried(steep, 1).ideal, 0.5 * (0.08 + 0.92 * grazing), 1e-5);
  m.specular = specular_of(1.0f, 100.0f);
  EXPECT_NEAR(Square(m).carried(direction_at(30.0), 1).ideal, 1.0, 1e-5);
  m.specular = specular_of(0.0f, 1.0f);
  EXPECT_EQ(Square(m).carried(direction_at(30.0), 1).ideal, 0.0);
}

TEST(Layers, what_is_under_a_coloured_reflection_keeps_its_hue) {
  Material m = test::matte(Vec3f(0.5f));
  m.index = ConstantIndex{1.5};
  m.roughness = 0.0f;
  m.specular = SpecularPart{};
  m.specular->color_rec709 = Vec3f(20.0f, 5.0f, 0.0f);
  const Vec3d view(0.0, 0.0, 1.0);
  // Green reflects 0.2 and red 0.8, which is what the diffuse part of all goes without.
  EXPECT_NEAR(Square(m).carried(view, 1).ideal, 0.2, 1e-5);
  EXPECT_NEAR(Square(m).lit_by(view, {test::directional_light(-view, 1.0)}), 0.2 * 0.5 / kPi, 1e-5);
}

TEST(Layers, specular_of_an_infinite_index_is_the_reflectance_itself) {
  Material m = white_plastic(0.0f);
  m.index_is_infinite = true;
  m.specular = specular_of(0.5f, 0.2f);
  EXPECT_NEAR(Square(m).carried(direction_at(0.0), 1).ideal, 0.5 * 0.2, 1e-5);
  const Vec3d view = direction_at(60.0);
  const double right = 0.5 * (0.2 + 0.8 * std::pow(0.5, 5));
  EXPECT_NEAR(Square(m).carried(view, 1).ideal, right, 1e-5);
}

TEST(Layers, light_from_behind_comes_through_diffusely) {
  Material m = test::matte(Vec3f(0.8f));
  m.diffuse_transmission = through_of(0.25f, 0.6f);
  Square square(m);
  // 2^14 directions.
  EXPECT_NEAR(square.broad_albedo(direction_at(40.0)), 0.75 * 0.8, 1e-4);
  EXPECT_NEAR(square.broad_albedo(direction_at(40.0), true), 0.25 * 0.6, 1e-4);
}

TEST(Layers, lobes_are_reciprocal) {
  Material m = white_metal(0.4f);
  m.clearcoat = coat_of(0.6f, 0.3f);
  m.sheen = sheen_of(Vec3f(0.7f), 0.4f);
  m.anisotropy = brushed(0.6f, 0.3f);
  const Vec3d a = direction_at(65.0), b(std::sin(0.4), 0.0, std::cos(0.4));
  const double there = Square(m).lit_by(a, {test::directional_light(-b, 1.0)}) / b.z;
  const double back = Square(m).lit_by(b, {test::directional_light(-a, 1.0)}) / a.z;
  EXPECT_NEAR(there / back, 1.0, 1e-4);
}

TEST(Layers, brushed_metal_has_the_distribution_of_two_roughnesses) {
  Material m = white_metal(0.5f);
  m.anisotropy = brushed(0.8f);
  const double alpha_b = 0.25, alpha_t = 0.25 + 0.64 * 0.75;
  for (const Vec3d& light : {direction_at(20.0), Vec3d(std::sin(0.7), 0.0, std::cos(0.7)),
                             Vec3d(0.0, std::sin(0.7), std::cos(0.7))}) {
    const Vec3d view(-0.3, 0.2, std::sqrt(1.0 - 0.13));
    const Vec3d half = glm::normalize(view + light);
    const auto lambda = [&](const Vec3d& v) {
      const double tan2 = (std::pow(alpha_t * v.x, 2) + std::pow(alpha_b * v.y, 2)) / (v.z * v.z);
      return 0.5 * (std::sqrt(1.0 + tan2) - 1.0);
    };
    const double bracket =
        std::pow(half.x / alpha_t, 2) + std::pow(half.y / alpha_b, 2) + half.z * half.z;
    const double right = 1.0 / (kPi * alpha_t * alpha_b * bracket * bracket) /
                         (4.0 * view.z * (1.0 + lambda(view) + lambda(light)));
    EXPECT_NEAR(Square(m).lit_by(view, {test::directional_light(-light, 1.0)}) / right, 1.0, 1e-3);
  }
}

TEST(Layers, modes_agree_on_grey_layers) {
  Material m = white_plastic(0.4f);
  m.clearcoat = coat_of(1.0f, 0.2f);
  m.sheen = sheen_of(Vec3f(0.5f), 0.5f);
  const Vec3d view = direction_at(40.0), light = direction_at(-30.0);
  const double rgb = Square(m, Mode::Rgb).lit_by(view, {test::directional_light(-light, 1.0)});
  const double rgb3 = Square(m, Mode::Rgb3).lit_by(view, {test::directional_light(-light, 1.0)});
  EXPECT_NEAR(rgb / rgb3, 1.0, 1e-5);
}

}  // namespace
}  // namespace abbe
