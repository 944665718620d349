// Scenes made ready to trace: placement, winding, lanes, lights.

#include "abbe/world/world.h"

#include <gtest/gtest.h>

#include <cmath>

#include "abbe/base/constants.h"
#include "abbe/base/error.h"
#include "abbe/color/uplift/uplift.h"
#include "support/scene_builder.h"

namespace abbe {
namespace {

RenderSettings settings_of(Mode mode) {
  RenderSettings settings = test::small_settings();
  settings.mode = mode;
  return settings;
}

Vec3d face_normal(const World& world, std::size_t triangle) {
  const Triangle& t = world.geometry.triangles[triangle];
  const Vec3d a(world.geometry.positions[t[0]]);
  return glm::cross(Vec3d(world.geometry.positions[t[1]]) - a,
                    Vec3d(world.geometry.positions[t[2]]) - a);
}

TEST(make_world, mirrored_instance_keeps_its_outside) {
  Scene scene;
  const std::uint32_t white = test::add(scene, test::matte(Vec3f(1.0f)));
  Mat4d mirror(1.0);
  mirror[0][0] = -1.0;
  test::add_box_mesh(scene, white, Vec3d(1.0), mirror);
  const LitWorld world = test::make_world(scene, settings_of(Mode::Rgb));
  for (std::size_t i = 0; i < world.geometry.triangles.size(); ++i) {
    EXPECT_GT(glm::dot(face_normal(world, i),
                       Vec3d(world.geometry.positions[world.geometry.triangles[i][0]])),
              0.0);
  }
}

TEST(make_world, sphere_under_a_shear_lies_on_its_ellipsoid) {
  Scene scene;
  test::add_sphere(scene, test::add(scene, test::matte(Vec3f(1.0f))), {1, 2, 3}, 2.0);
  Mat4d shear(1.0);
  shear[1][0] = 0.5;
  scene.instances.front().to_world = shear * scene.instances.front().to_world;
  const LitWorld world = test::make_world(scene, settings_of(Mode::Rgb));
  ASSERT_EQ(world.geometry.ellipsoids.size(), 1u);
  const Ellipsoid& ellipsoid = world.geometry.ellipsoids.front();
  const Vec3d on_surface(shear * Vec4d(1.0, 4.0, 3.0, 1.0));
  EXPECT_NEAR(
      glm::length(ellipsoid.world_to_unit_linear * on_surface + ellipsoid.world_to_unit_offset),
      1.0, 1e-12);
  EXPECT_LE(ellipsoid.bounds.high.y, 4.0f + 1e-5f);
  EXPECT_GE(ellipsoid.bounds.high.y, 4.0f);
}

TEST(make_world, triangles_flattened_by_their_transform_are_dropped_and_counted) {
  Scene scene;
  Mat4d flat(1.0);
  flat[2][2] = 0.0;
  test::add_box_mesh(scene, test::add(scene, test::matte(Vec3f(1.0f))), Vec3d(1.0), flat);
  Notes notes;
  const Geometry geometry = flatten(scene, notes);
  // The four sides have no area left, front and back do.
  EXPECT_EQ(geometry.triangles.size(), 4u);
  ASSERT_EQ(notes.all().size(), 1u);
  EXPECT_NE(notes.all().front().text.find("dropped 8 triangles"), std::string::npos);
}

TEST(make_world, planes_that_bound_nothing_are_an_error) {
  Scene scene;
  test::add_box(scene, test::add(scene, test::matte(Vec3f(1.0f))), Vec3d(1.0), Mat4d(1.0));
  std::get<ConvexShape>(std::get<Shape>(scene.instances.front().what).geometry).planes.pop_back();
  EXPECT_THROW(test::make_world(scene, settings_of(Mode::Rgb)), Error);
}

TEST(LaneModel, index_of_glass_is_tabulated_per_mode) {
  Scene scene;
  test::add(scene, test::glass("glass/schott/N-BK7"));
  const LitWorld rgb = test::make_world(scene, settings_of(Mode::Rgb));
  const LitWorld rgb3 = test::make_world(scene, settings_of(Mode::Rgb3));
  const RowId row = rgb.materials.front().index;
  // N-BK7 by its Sellmeier formula at C, d and F, to single precision.
  EXPECT_NEAR(rgb.row(row, 0)[0], 1.516800f, 1e-6f);
  EXPECT_NEAR(rgb.row(row, 0)[2], 1.516800f, 1e-6f);
  EXPECT_NEAR(rgb3.row(row, 0)[0], 1.514322f, 1e-6f);
  EXPECT_NEAR(rgb3.row(row, 0)[1], 1.516800f, 1e-6f);
  EXPECT_NEAR(rgb3.row(row, 0)[2], 1.522376f, 1e-6f);
}

TEST(LaneModel, gltf_attenuation_is_the_colour_at_its_distance) {
  Scene scene;
  Material tinted = test::glass(1.5);
  tinted.attenuation_color_rec709 = {0.25, 0.5, 1.0};
  tinted.attenuation_distance_m = 2.0;
  test::add(scene, tinted);
  const LitWorld rgb = test::make_world(scene, settings_of(Mode::Rgb));
  const float* row = rgb.row(*rgb.materials.front().absorption_per_m, 0);
  EXPECT_NEAR(std::exp(-row[0] * 2.0f), 0.25f, 1e-6f);
  EXPECT_NEAR(std::exp(-row[1] * 2.0f), 0.5f, 1e-6f);
  EXPECT_NEAR(row[2], 0.0f, 1e-6f);
  const LitWorld spectral = test::make_world(scene, settings_of(Mode::Spectral));
  const SigmoidPolynomial color = uplift_rec709({0.25, 0.5, 1.0});
  const float* spectral_row = spectral.row(*spectral.materials.front().absorption_per_m, 7);
  const float nm = spectral.lanes.quadrature()->wavelengths_nm(7)[5];
  EXPECT_NEAR(std::exp(-spectral_row[5] * 2.0f),
              Spectrum::sigmoid(color).value(static_cast<double>(nm)), 1e-5);
}

TEST(LaneModel, luminance_weights_sum_to_one_over_every_set) {
  Scene scene;
  for (const Mode mode : {Mode::Spectral, Mode::Rgb, Mode::Rgb3}) {
    const LitWorld world = test::make_world(scene, settings_of(mode));
    for (int set = 0; set < world.lanes.set_count(); ++set) {
      double sum = 0.0;
      for (int lane = 0; lane < world.lanes.lane_stride(); ++lane) {
        const float value =
            world.luminance_weights[static_cast<std::size_t>(set) * world.lanes.lane_stride() +
                                    lane];
        EXPECT_GE(value, 0.0f);
        sum += static_cast<double>(value);
      }
      // Rounding of a few dozen floats.
      EXPECT_NEAR(sum, 1.0, 1e-5);
    }
  }
}

TEST(mode_from_name, unknown_mode_lists_the_modes) {
  EXPECT_EQ(mode_from_name("rgb3"), Mode::Rgb3);
  try {
    mode_from_name("cmyk");
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(error.detail().kind, ErrorKind::Usage);
    EXPECT_EQ(error.detail().choices, (std::vector<std::string>{"spectral", "rgb", "rgb3"}));
  }
}

}  // namespace
}  // namespace abbe
