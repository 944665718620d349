// Single-sided surfaces are not there from behind: for the eye, in mirrors, and for light.

#include <gtest/gtest.h>

#include "support/scene_builder.h"

namespace abbe {
namespace {

Mat4d turned_over() {
  return test::rotation({1, 0, 0}, 180.0);
}

Mat4d mirrored() {
  Mat4d place(1.0);
  place[2][2] = -1.0;
  return place;
}

Material metal_mirror() {
  Material mirror = test::matte(Vec3f(1.0f));
  mirror.metallic = 1.0f;
  mirror.roughness = 0.0f;
  return mirror;
}

// A sheet about the origin that faces +Z, and a copy of it far away. With the parameter they share
// their triangles, in a tree of two levels.
class Sides : public testing::TestWithParam<bool> {
 protected:
  void add_sheet(const Material& material, const Mat4d& place = Mat4d(1.0)) {
    test::add_square(scene_, test::add(scene_, material), 1.0, place);
    Instance copy = scene_.instances.back();
    copy.to_world = test::translation({1000.0, 0.0, 0.0}) * place;
    scene_.instances.push_back(copy);
  }
  void add_floor(const Material& material) {
    test::add_square(scene_, test::add(scene_, material), 10.0, test::translation({0, 0, -5}));
  }
  // What a camera there sees that looks along an axis, in green.
  double seen_from(double z, double towards_z) {
    scene_.cameras = {test::orthographic_camera({0.1, 0.2, z}, {0.1, 0.2, towards_z}, 0.1, 0.1)};
    RenderSettings settings = test::small_settings();
    settings.mode = Mode::Rgb;
    WorldOptions options = world_options(settings);
    if (GetParam()) options.sharing = {.least_saved_triangles = 1, .least_triangles = 1};
    Notes notes;
    const LitWorld world =
        make_lit_world(scene_, options, caustic_options(settings), test::catalogue().observer(),
                       test::catalogue().illuminant("illuminant/D65"), notes);
    EXPECT_EQ(!world.geometry.places.empty(), GetParam() && may_share_);
    const test::Rendered result = test::render(world, scene_.cameras.front(), settings);
    return static_cast<double>(test::pixel(result.image, 4, 4, "G"));
  }

  Scene scene_;
  bool may_share_ = true;  // Whether the scene has copies that can.
};
INSTANTIATE_TEST_SUITE_P(FlatAndShared, Sides, testing::Bool());

TEST_P(Sides, eye_sees_the_front_alone) {
  Material shining = test::emitter(Vec3f(1.0f));
  for (const bool both : {false, true}) {
    shining.double_sided = both;
    scene_ = {};
    add_sheet(shining);
    EXPECT_NEAR(seen_from(1.0, 0.0), 1.0, 1e-5);
    EXPECT_NEAR(seen_from(-1.0, 0.0), both ? 1.0 : 0.0, 1e-5);
  }
}

TEST_P(Sides, mirror_image_has_its_front_on_the_other_side) {
  add_sheet(test::emitter(Vec3f(1.0f)), mirrored());
  EXPECT_NEAR(seen_from(1.0, 0.0), 0.0, 1e-5);
  EXPECT_NEAR(seen_from(-1.0, 0.0), 1.0, 1e-5);
}

TEST_P(Sides, mirror_shows_the_front_alone) {
  for (const bool turned : {false, true}) {
    scene_ = {};
    add_sheet(test::emitter(Vec3f(1.0f)), turned ? turned_over() : Mat4d(1.0));
    add_floor(metal_mirror());
    // The camera is between both, and has no body.
    EXPECT_NEAR(seen_from(-1.0, -5.0), turned ? 1.0 : 0.0, 1e-5);
  }
}

TEST_P(Sides, front_alone_stops_light) {
  scene_.lights = {test::directional_light({0, 0, -1}, kPi)};
  add_floor(test::matte(Vec3f(0.5f)));
  const Scene bare = scene_;
  Material sheet = test::matte(Vec3f(0.8f));
  for (const bool both : {false, true}) {
    sheet.double_sided = both;
    scene_ = bare;
    add_sheet(sheet);
    EXPECT_NEAR(seen_from(-1.0, -5.0), 0.0, 1e-5);
    scene_ = bare;
    add_sheet(sheet, turned_over());
    EXPECT_NEAR(seen_from(-1.0, -5.0), both ? 0.0 : 0.5, 1e-5);
  }
}

TEST_P(Sides, front_alone_stops_light_of_what_has_an_area) {
  add_floor(test::matte(Vec3f(0.5f)));
  Light lamp = test::point_light({0.1, 0.2, 5.0}, 100.0);
  lamp.shape = SphereLamp{0.05};
  Scene with_lamp = scene_, with_emitter = scene_;
  with_lamp.lights = {lamp};
  with_emitter.emissive_light = true;
  test::add_sphere(with_emitter, test::add(with_emitter, test::emitter(Vec3f(1e4f))),
                   {0.1, 0.2, 5.0}, 0.05);
  for (const Scene& lit : {with_lamp, with_emitter}) {
    scene_ = lit;
    may_share_ = false;  // Nothing to share without the sheets.
    const double open = seen_from(-1.0, -5.0);
    EXPECT_GT(open, 0.1);
    may_share_ = true;
    add_sheet(test::matte(Vec3f(0.8f)), turned_over());
    EXPECT_NEAR(seen_from(-1.0, -5.0) / open, 1.0, 1e-4);  // Single precision.
    scene_ = lit;
    add_sheet(test::matte(Vec3f(0.8f)));
    EXPECT_NEAR(seen_from(-1.0, -5.0), 0.0, 1e-6);
  }
}

TEST_P(Sides, coverage_does_not_change_the_rule) {
  scene_.lights = {test::directional_light({0, 0, -1}, kPi)};
  add_floor(test::matte(Vec3f(0.5f)));
  const Scene bare = scene_;
  Material veil = test::matte(Vec3f(0.8f));
  veil.alpha_mode = AlphaMode::Blend;
  veil.base_color_rec709.w = 0.25f;
  add_sheet(veil);
  EXPECT_NEAR(seen_from(-1.0, -5.0), 0.75 * 0.5, 1e-5);
  scene_ = bare;
  add_sheet(veil, turned_over());
  EXPECT_NEAR(seen_from(-1.0, -5.0), 0.5, 1e-5);
}

TEST_P(Sides, what_lets_light_through_is_there_from_both_sides) {
  Material pane = test::glass(1.5);
  pane.has_volume = false;
  for (const bool turned : {false, true}) {
    scene_ = {};
    scene_.lights = {test::directional_light({0, 0, -1}, kPi)};
    add_floor(test::matte(Vec3f(0.5f)));
    add_sheet(pane, turned ? turned_over() : Mat4d(1.0));
    EXPECT_NEAR(seen_from(-1.0, -5.0), 0.96 * 0.5, 1e-4) << turned;
  }
  scene_ = {};
  scene_.lights = {test::directional_light({0, 0, -1}, kPi)};
  Material paper = test::matte(Vec3f(0.8f));
  paper.diffuse_transmission = DiffuseTransmission{};
  paper.diffuse_transmission->factor = 0.5f;
  for (const double side : {1.0, -1.0}) {
    scene_.instances.clear();
    scene_.meshes.clear();
    add_sheet(paper, side < 0.0 ? turned_over() : Mat4d(1.0));
    EXPECT_NEAR(seen_from(-1.0, 0.0), 0.5, 1e-4) << side;
  }
}

TEST_P(Sides, closed_meshes_look_as_if_they_had_both) {
  test::Rendered seen[2];
  for (const bool both : {false, true}) {
    Scene scene;
    Material box = test::matte(Vec3f(0.7f));
    box.double_sided = both;
    test::add_box_mesh(scene, test::add(scene, box), {0.5, 0.3, 0.4},
                       test::rotation(glm::normalize(Vec3d(1, 2, 3)), 40.0));
    test::add_square(scene, test::add(scene, test::matte(Vec3f(0.5f))), 10.0,
                     test::translation({0, 0, -0.6}));
    scene.lights = {test::directional_light({0.5, 0.2, -1}, 3.0),
                    test::point_light({1.0, 1.0, 1.5}, 2.0)};
    scene.cameras = {test::perspective_camera({2, 1, 2}, {0, 0, 0}, 40)};
    RenderSettings settings = test::small_settings();
    settings.size = {32, 32};
    seen[both ? 1 : 0] = test::render(scene, settings);
  }
  EXPECT_EQ(seen[0].image.pixels, seen[1].image.pixels);
}

}  // namespace
}  // namespace abbe
