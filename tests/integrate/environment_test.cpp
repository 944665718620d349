// Light from all around against closed forms.

#include <gtest/gtest.h>

#include <cmath>
#include <memory>

#include "abbe/base/constants.h"
#include "support/scene_builder.h"

namespace abbe {
namespace {

constexpr int kWidth = 64, kHeight = 32;

Scene floor_from_above(const Material& material) {
  Scene scene;
  test::add_square(scene, test::add(scene, material), 20.0, test::rotation({1, 0, 0}, -90.0));
  scene.cameras.push_back(test::orthographic_camera({0, 30, 0}, {0, 0, 0}, 1e-4, 1e-4));
  return scene;
}

std::shared_ptr<Environment> even(const Vec3f& color) {
  auto environment = std::make_shared<Environment>();
  environment->image.width = kWidth;
  environment->image.height = kHeight;
  environment->image.rgb_rec709.assign(kWidth * kHeight, color);
  return environment;
}

double seen(const Scene& scene, int samples, Mode mode = Mode::Spectral) {
  RenderSettings settings = test::small_settings();
  settings.samples_per_pixel = samples;
  settings.mode = mode;
  const test::Rendered result = test::render(scene, settings);
  double sum = 0.0;
  for (int y = 0; y < 8; ++y) {
    for (int x = 0; x < 8; ++x) {
      sum += static_cast<double>(test::pixel(result.image, x, y, "G"));
    }
  }
  return sum / 64.0;
}

TEST(EnvironmentTest, white_matte_floor_under_even_light_has_its_radiance) {
  for (const Mode mode : {Mode::Spectral, Mode::Rgb}) {
    Scene scene = floor_from_above(test::matte(Vec3f(1.0f)));
    scene.environment = even(Vec3f(2.0f));
    // 64 pixels of 256 samples of 4 directions, stratified: 3e-3 a pixel, 4e-4 of their mean.
    EXPECT_NEAR(seen(scene, 256, mode), 2.0, 2e-3) << mode_name(mode);
  }
}

TEST(EnvironmentTest, takes_the_place_of_ambient_light) {
  Scene scene = floor_from_above(test::matte(Vec3f(1.0f)));
  scene.environment = even(Vec3f(0.0f));
  scene.ambient = Ambient{1.0, {}};
  EXPECT_EQ(seen(scene, 4), 0.0);
}

TEST(EnvironmentTest, mirror_shows_it_and_rays_that_meet_nothing_see_it_where_it_is_visible) {
  Material mirror = test::matte(Vec3f(1.0f));
  mirror.metallic = 1.0f;
  mirror.roughness = 0.0f;
  Scene scene = floor_from_above(mirror);
  scene.environment = even(Vec3f(2.0f));
  EXPECT_NEAR(seen(scene, 4), 2.0, 1e-3);

  Scene nothing = scene;
  nothing.instances.clear();
  EXPECT_NEAR(seen(nothing, 4), 2.0, 1e-3);
  auto hidden = even(Vec3f(2.0f));
  hidden->visible = false;
  nothing.environment = hidden;
  EXPECT_EQ(seen(nothing, 4), 0.0);
}

// One bright texel: the light of a far lamp in its direction. Its solid angle is the integral of
// the bilinear hat: 2π/W · π/H · sine of its height, to second order.
TEST(EnvironmentTest, bright_texel_lights_as_a_lamp_in_its_direction) {
  constexpr int kColumn = 40, kRow = 8;
  constexpr double kRadiance = 1e4;
  auto sun = even(Vec3f(0.0f));
  sun->image.rgb_rec709[kRow * kWidth + kColumn] = Vec3f(static_cast<float>(kRadiance));
  sun->rotation_deg = 30.0;
  Scene scene = floor_from_above(test::matte(Vec3f(1.0f)));
  scene.environment = sun;
  const double theta = kPi * (kRow + 0.5) / kHeight;
  const double solid_angle = 2.0 * kPi / kWidth * kPi / kHeight * std::sin(theta);
  const double expected = kRadiance * solid_angle * std::cos(theta) / kPi;
  // A texel is 0.1 rad wide: the second order is below 1 %.
  EXPECT_NEAR(seen(scene, 64) / expected, 1.0, 0.012);

  // A wall beside the floor, across the way that its light comes, puts it in the shade; one on the
  // other side does not.
  const double turn = 2.0 * kPi * ((kColumn + 0.5) / kWidth - 0.5) - kPi / 6.0;
  const Vec3d towards{std::cos(turn), 0.0, std::sin(turn)};
  for (const double side : {1.0, -1.0}) {
    Scene shaded = scene;
    Mat4d place(1.0);
    const Vec3d across = glm::cross(Vec3d(0, 1, 0), towards);
    place[0] = Vec4d(across, 0.0);
    place[1] = Vec4d(0, 1, 0, 0);
    place[2] = Vec4d(glm::cross(across, Vec3d(0, 1, 0)), 0.0);
    place[3] = Vec4d(side * towards, 1.0);
    test::add_square(shaded, test::add(shaded, test::matte(Vec3f(0.0f))), 8.0, place);
    const double light = seen(shaded, 64) / expected;
    if (side > 0.0) {
      EXPECT_EQ(light, 0.0);
    } else {
      EXPECT_NEAR(light, 1.0, 0.012);
    }
  }
}

}  // namespace
}  // namespace abbe
