// Light that rough lobes and samples of light both find, against integrals of the lobe over what
// shines, in double precision.

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <memory>
#include <vector>

#include "abbe/base/constants.h"
#include "support/ggx.h"
#include "support/scene_builder.h"

namespace abbe {
namespace {

constexpr double kLuminance = 7.0;
const Vec3d kView = glm::normalize(Vec3d(0.0, -0.6, 0.8));

Material rough_white_metal(double roughness) {
  Material metal = test::matte(Vec3f(1.0f));
  metal.metallic = 1.0f;
  metal.roughness = static_cast<float>(roughness);
  return metal;
}

// A floor at the origin, its normal +z, seen along −kView.
Scene floor_of(const Material& material) {
  Scene scene;
  scene.emissive_light = true;
  test::add_square(scene, test::add(scene, material), 0.01, Mat4d(1.0));
  scene.cameras.push_back(test::orthographic_camera(kView, {0, 0, 0}, 1e-4, 1e-4));
  return scene;
}

Material shining() {
  return test::emitter(Vec3f(static_cast<float>(kLuminance)));
}

// A square lamp in the way of what the floor mirrors, facing it.
constexpr double kDistance = 1.0;
Mat4d lamp_place(double distance_m = kDistance) {
  const Vec3d away(0.0, 0.6, 0.8);
  const Vec3d x(1, 0, 0), z = -away;
  Mat4d place(1.0);
  place[0] = Vec4d(x, 0.0);
  place[1] = Vec4d(glm::cross(z, x), 0.0);
  place[2] = Vec4d(z, 0.0);
  place[3] = Vec4d(distance_m * away, 1.0);
  return place;
}

struct Seen {
  double mean = 0.0, deviation = 0.0;  ///< Over 64 pixels.
};

Seen seen(const Scene& scene, int samples) {
  RenderSettings settings = test::small_settings();
  settings.mode = Mode::Rgb;
  settings.samples_per_pixel = samples;
  const test::Rendered result = test::render(scene, settings);
  double sum = 0.0, squares = 0.0;
  for (int y = 0; y < 8; ++y) {
    for (int x = 0; x < 8; ++x) {
      const auto value = static_cast<double>(test::pixel(result.image, x, y, "G"));
      sum += value / 64.0;
      squares += value * value / 64.0;
    }
  }
  return {sum, std::sqrt(std::max(0.0, squares - sum * sum))};
}

// What a white metal of that roughness sends to the view of light from a direction: f_r·cosθ.
double lobe(double roughness, const Vec3d& light) {
  const test::Ggx ggx{roughness * roughness};
  if (!(light.z > 0.0)) return 0.0;
  return ggx.distribution(glm::normalize(kView + light)) / (4.0 * kView.z) /
         (1.0 + ggx.lambda(kView.z) + ggx.lambda(light.z));
}

// Of the square lamp; through what it goes, direction by direction.
double light_of_square(double roughness, double half_m,
                       const std::function<double(const Vec3d&)>& through = {}) {
  constexpr int kSteps = 400;
  const Mat4d place = lamp_place();
  double sum = 0.0;
  for (int i = 0; i < kSteps; ++i) {
    for (int j = 0; j < kSteps; ++j) {
      const Vec3d at(place * Vec4d(half_m * ((i + 0.5) * 2.0 / kSteps - 1.0),
                                   half_m * ((j + 0.5) * 2.0 / kSteps - 1.0), 0.0, 1.0));
      const Vec3d way = glm::normalize(at);
      const double cosine = -glm::dot(way, Vec3d(place[2]));
      sum += lobe(roughness, way) * cosine / glm::dot(at, at) * (through ? through(way) : 1.0);
    }
  }
  return kLuminance * sum * 4.0 * half_m * half_m / (kSteps * kSteps);
}

Scene lit_by_square(const Material& floor, double half_m) {
  Scene scene = floor_of(floor);
  test::add_square(scene, test::add(scene, shining()), half_m, lamp_place());
  return scene;
}

TEST(SharedLight, rough_metal_shows_the_integral_of_its_lobe_over_lamps_of_any_size) {
  for (const double roughness : {0.1, 0.35, 0.7, 1.0}) {
    for (const double half_m : {0.02, 0.2, 1.0}) {
      const double expected = light_of_square(roughness, half_m);
      const Seen found = seen(lit_by_square(rough_white_metal(roughness), half_m), 64);
      // Four deviations of the mean of 64 pixels, and the rounding of what is seen.
      EXPECT_NEAR(found.mean, expected, 4.0 * found.deviation / 8.0 + 1e-3 * expected)
          << roughness << " " << half_m;
      EXPECT_LT(found.deviation, 0.1 * expected) << roughness << " " << half_m;
    }
  }
}

// By the lobe's ray alone, one in a hundred of which meets the lamp, pixels of 8 samples deviate
// by several times their mean.
TEST(SharedLight, small_lamps_leave_little_grain_in_eight_samples) {
  for (const double roughness : {0.3, 0.6, 1.0}) {
    const Seen found = seen(lit_by_square(rough_white_metal(roughness), 0.02), 8);
    EXPECT_LT(found.deviation, 0.05 * found.mean) << roughness;
  }
}

TEST(SharedLight, a_veil_and_a_clear_sheet_take_the_same_of_rays_and_samples) {
  constexpr double kRoughness = 0.5, kHalf = 0.3;
  Scene veiled = lit_by_square(rough_white_metal(kRoughness), kHalf);
  Material veil = test::matte(Vec3f(0.0f));
  veil.base_color_rec709.w = 0.25f;
  veil.alpha_mode = AlphaMode::Blend;
  veil.double_sided = true;
  veil.metallic = 0.0f;
  veil.roughness = 1.0f;
  test::add_square(veiled, test::add(veiled, veil), 3.0, lamp_place(0.5));
  const Seen through_veil = seen(veiled, 256);
  const double expected = 0.75 * light_of_square(kRoughness, kHalf);
  // The veil's own reflection of the lamp's back is nothing: it is black but for Fresnel's share of
  // the floor, below 1 % of what the floor sends up.
  EXPECT_NEAR(through_veil.mean / expected, 1.0, 0.015);

  Scene behind_sheet = lit_by_square(rough_white_metal(kRoughness), kHalf);
  Material sheet = test::glass(1.5);
  sheet.has_volume = false;
  test::add_square(behind_sheet, test::add(behind_sheet, sheet), 3.0, lamp_place(0.5));
  const Vec3d normal(0.0, 0.6, 0.8);
  const double of_sheet = light_of_square(kRoughness, kHalf, [&](const Vec3d& way) {
    const double c = glm::dot(way, normal), t = std::sqrt(1.0 - (1.0 - c * c) / 2.25);
    const double s = (c - 1.5 * t) / (c + 1.5 * t), p = (1.5 * c - t) / (1.5 * c + t);
    return 1.0 - 0.5 * (s * s + p * p);
  });
  // What goes on between sheet and floor adds 4 % of a half of 4 %.
  EXPECT_NEAR(seen(behind_sheet, 256).mean / of_sheet, 1.0, 0.01);
}

// A boundary bends rays: what they see behind it is theirs, samples end there. One of next to no
// index changes nothing but that.
TEST(SharedLight, behind_a_boundary_it_is_counted_once) {
  constexpr double kRoughness = 0.7, kHalf = 1.0;
  Scene scene = lit_by_square(rough_white_metal(kRoughness), kHalf);
  test::add_box(scene, test::add(scene, test::glass(1.0 + 1e-5)), {3.0, 3.0, 0.05},
                lamp_place(0.5));
  // 16 000 rays, of which a half meet the lamp: 0.6 % at one deviation.
  EXPECT_NEAR(seen(scene, 256).mean / light_of_square(kRoughness, kHalf), 1.0, 0.02);
}

TEST(SharedLight, lamp_that_touches_rough_glass_is_counted_once) {
  Material glass = test::glass(1.5);
  glass.roughness = 0.4f;
  Scene scene;
  test::add_box_mesh(scene, test::add(scene, glass), {0.1, 0.1, 0.05}, Mat4d(1.0));
  test::add_square(scene, test::add(scene, shining()), 0.1, test::translation({0, 0, -0.05}));
  scene.cameras.push_back(test::orthographic_camera(kView, {0, 0, 0}, 0.02, 0.02));
  const Seen by_rays = seen(scene, 64);
  scene.emissive_light = true;
  const Seen by_both = seen(scene, 64);
  // Three standard errors of 64 pixels each; a shadow ray that ends before the boundary adds 10 %.
  const double error = std::hypot(by_rays.deviation, by_both.deviation) / 8.0;
  EXPECT_NEAR(by_both.mean, by_rays.mean, 3.0 * error);
  EXPECT_LT(3.0 * error, 0.05 * by_rays.mean);
}

TEST(SharedLight, one_bright_texel_is_a_highlight_of_rough_metal) {
  constexpr int kWidth = 64, kHeight = 32, kColumn = 40, kRow = 8;
  constexpr double kRadiance = 1e4, kRoughness = 0.7;
  auto sun = std::make_shared<Environment>();
  sun->image.width = kWidth;
  sun->image.height = kHeight;
  sun->image.rgb_rec709.assign(kWidth * kHeight, Vec3f(0.0f));
  sun->image.rgb_rec709[kRow * kWidth + kColumn] = Vec3f(static_cast<float>(kRadiance));
  Scene scene = floor_of(rough_white_metal(kRoughness));
  scene.environment = sun;
  // The bilinear hat over the four texels around it, y is up in the image.
  double expected = 0.0;
  constexpr int kSteps = 100;
  for (int i = 0; i < 2 * kSteps; ++i) {
    for (int j = 0; j < 2 * kSteps; ++j) {
      const double x = (i + 0.5) / kSteps - 1.0, y = (j + 0.5) / kSteps - 1.0;
      const double theta = kPi * (kRow + 0.5 + y) / kHeight;
      const double phi = 2.0 * kPi * ((kColumn + 0.5 + x) / kWidth - 0.5);
      const Vec3d way(std::sin(theta) * std::cos(phi), std::cos(theta),
                      std::sin(theta) * std::sin(phi));
      expected += kRadiance * (1.0 - std::abs(x)) * (1.0 - std::abs(y)) * lobe(kRoughness, way) *
                  std::sin(theta) * (2.0 * kPi / kWidth) * (kPi / kHeight) / (kSteps * kSteps);
    }
  }
  const Seen found = seen(scene, 64);
  EXPECT_NEAR(found.mean / expected, 1.0, 5e-3);
  EXPECT_LT(found.deviation, 0.1 * expected);
}

// A lamp behind a frosted sheet, on the way straight through it: the mirror image of what its
// microfacets reflect, with Fresnel's share that goes on.
TEST(SharedLight, a_frosted_sheet_shows_a_lamp_behind_it_by_the_integral_of_its_lobe) {
  constexpr double kHalf = 0.05;
  for (const double roughness : {0.4, 0.8}) {
    Material sheet = test::glass(1.5);
    sheet.has_volume = false;
    sheet.roughness = static_cast<float>(roughness);
    Scene scene = floor_of(sheet);
    Mat4d place = lamp_place();
    for (int column = 0; column < 4; ++column) place[column].z = -place[column].z;
    place[0] = -place[0];  // Mirrored, it faces the sheet again.
    test::add_square(scene, test::add(scene, shining()), kHalf, place);
    const double expected = light_of_square(roughness, kHalf, [&](const Vec3d& way) {
      const Vec3d half = glm::normalize(way + kView);
      const double c = glm::dot(way, half), t = std::sqrt(1.0 - (1.0 - c * c) / 2.25);
      const double s = (c - 1.5 * t) / (c + 1.5 * t), p = (1.5 * c - t) / (1.5 * c + t);
      return 1.0 - 0.5 * (s * s + p * p);
    });
    const Seen found = seen(scene, 64);
    EXPECT_NEAR(found.mean, expected, 4.0 * found.deviation / 8.0 + 2e-3 * expected) << roughness;
    EXPECT_LT(found.deviation, 0.1 * expected) << roughness;
  }
}

}  // namespace
}  // namespace abbe
