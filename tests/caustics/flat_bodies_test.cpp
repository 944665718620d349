// Which bodies light is followed through exactly, and which are left to straight shadow rays.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "abbe/base/constants.h"
#include "abbe/caustics/flat/bodies.h"
#include "abbe/image/exr/exr.h"
#include "abbe/math/polygon.h"
#include "support/gems.h"
#include "support/scene_builder.h"

namespace abbe {
namespace {

using testing::HasSubstr;

// A box of glass as a mesh, and a lamp.
Scene box_scene() {
  Scene scene;
  scene.name = "test";
  test::add_box_mesh(scene, test::add(scene, test::glass(1.5)), {0.5, 0.5, 0.5}, Mat4d(1.0));
  scene.instances.back().name = "the box";
  scene.lights.push_back(test::point_light({0, 3, 0}, 1.0));
  return scene;
}

LitWorld world_of(const Scene& scene, Notes& notes, int inner_reflections = 1) {
  RenderSettings settings = test::small_settings();
  settings.wavelengths.exact_nm = {kLine_d_nm};
  settings.inner_reflections = inner_reflections;
  return make_lit_world(scene, world_options(settings), caustic_options(settings),
                        test::catalogue().observer(),
                        test::catalogue().illuminant("illuminant/D65"), notes);
}

// The world has left the named body to straight rays, and said so once.
void expect_fallback(const Scene& scene, const std::string& name, const std::string& why,
                     int inner_reflections = 1) {
  Notes notes;
  const LitWorld world = world_of(scene, notes, inner_reflections);
  ASSERT_EQ(world.caustics.report.fallbacks.size(), 1u);
  EXPECT_THAT(world.caustics.report.fallbacks[0], HasSubstr(name));
  EXPECT_THAT(world.caustics.report.fallbacks[0], HasSubstr(why));
  EXPECT_EQ(world.caustics.report.bodies, 0u);
  EXPECT_EQ(world.caustics.report.chains, 0u);
  for (const std::uint8_t is_exact : world.caustics.surface_is_exact) EXPECT_EQ(is_exact, 0);
  int warnings = 0;
  for (const Note& note : notes.all()) {
    if (note.kind == NoteKind::Warning && note.where == name) ++warnings;
  }
  EXPECT_EQ(warnings, 1);
}

TEST(FlatBodies, closed_box_of_triangles_is_a_body_of_six_faces) {
  Notes notes;
  const LitWorld world = world_of(box_scene(), notes, 16);
  EXPECT_TRUE(notes.all().empty());
  EXPECT_EQ(world.caustics.report.bodies, 1u);
  EXPECT_EQ(world.caustics.flat.faces.size(), 6u);
  EXPECT_EQ(world.caustics.surface_is_exact[0], 1);
  EXPECT_GT(world.caustics.point.chains.size(), 0u);
}

TEST(FlatBodies, open_mesh_is_left_to_straight_rays_with_one_warning) {
  Scene scene = box_scene();
  scene.meshes.front().triangles.pop_back();
  expect_fallback(scene, "the box", "open");
}

TEST(FlatBodies, box_that_an_export_has_smoothed_is_left_to_straight_rays_with_one_warning) {
  Scene scene = box_scene();
  for (const Vec3f& corner : scene.meshes[0].positions) {
    scene.meshes[0].normals.push_back(glm::normalize(corner));
  }
  expect_fallback(scene, "the box", "its normals make 6 flat faces look curved");
}

TEST(FlatBodies, mesh_that_meets_itself_is_left_to_straight_rays_with_one_warning) {
  // A second box in the same mesh, half inside the first.
  Scene scene = box_scene();
  Mesh& mesh = scene.meshes.front();
  const auto count = static_cast<std::uint32_t>(mesh.positions.size());
  const auto triangles = mesh.triangles;
  for (std::uint32_t i = 0; i < count; ++i) {
    mesh.positions.push_back(mesh.positions[i] + Vec3f(0.4f, 0.3f, 0.2f));
  }
  for (const auto& t : triangles) {
    mesh.triangles.push_back({t[0] + count, t[1] + count, t[2] + count});
  }
  expect_fallback(scene, "the box", "meets itself");
}

TEST(FlatBodies, mesh_of_too_many_facets_is_left_to_straight_rays_with_one_warning) {
  // A column of 520 sides.
  Scene scene = box_scene();
  Mesh& mesh = scene.meshes.front();
  mesh.positions.clear();
  mesh.triangles.clear();
  constexpr std::uint32_t kSides = 520;
  for (std::uint32_t i = 0; i < kSides; ++i) {
    const double angle = 2.0 * kPi * i / kSides;
    for (const float y : {0.0f, 1.0f}) {
      mesh.positions.push_back(
          {static_cast<float>(std::cos(angle)), y, static_cast<float>(std::sin(angle))});
    }
  }
  for (std::uint32_t i = 0; i < kSides; ++i) {
    const std::uint32_t a = 2 * i;
    const std::uint32_t b = 2 * ((i + 1) % kSides);
    mesh.triangles.push_back({a, a + 1, b});
    mesh.triangles.push_back({b, a + 1, b + 1});
    if (i > 0 && i + 1 < kSides) {
      mesh.triangles.push_back({0, a, b});
      mesh.triangles.push_back({1, b + 1, a + 1});
    }
  }
  expect_fallback(scene, "the box", "more than 512");
}

// A texture of two texels.
TextureUse add_texture(Scene& scene, std::vector<std::uint8_t> rgba) {
  TextureImage image;
  image.width = 2, image.height = 1;
  image.rgba8 = SharedValues<std::uint8_t>(std::move(rgba));
  scene.images.push_back(std::move(image));
  Texture texture;
  texture.image = static_cast<std::uint32_t>(scene.images.size() - 1);
  scene.textures.push_back(texture);
  TextureUse use;
  use.texture = static_cast<std::uint32_t>(scene.textures.size() - 1);
  return use;
}

// A box of a material, after `edit`.
template <typename Edit>
FlatBodies bodies_of(const Material& material, const Edit& edit) {
  Scene scene = box_scene();
  scene.materials.front() = material;
  edit(scene, scene.materials.front());
  Notes notes;
  return find_flat_bodies(scene, notes);
}

using Edit = std::function<void(Scene&, Material&)>;

TEST(FlatBodies, what_does_nothing_to_a_material_leaves_light_exact) {
  const std::vector<std::uint8_t> white(8, 255);
  const std::vector<std::uint8_t> sharp{255, 0, 255, 255, 255, 0, 255, 255};
  const std::vector<Edit> nothings{
      [](Scene&, Material& m) { m.alpha_mode = AlphaMode::Blend; },
      [](Scene&, Material& m) { m.alpha_mode = AlphaMode::Mask; },
      [](Scene&, Material& m) { m.clearcoat = Clearcoat{}; },
      [](Scene&, Material& m) { m.sheen = Sheen{}; },
      [](Scene&, Material& m) { m.anisotropy = Anisotropy{}; },
      [](Scene&, Material& m) { m.specular = SpecularPart{}; },
      [](Scene&, Material& m) { m.diffuse_transmission = DiffuseTransmission{}; },
      [&](Scene& s, Material& m) { m.base_color_texture = add_texture(s, white); },
      [&](Scene& s, Material& m) { m.transmission_texture = add_texture(s, white); },
      [&](Scene& s, Material& m) { m.metallic_roughness_texture = add_texture(s, sharp); },
      [&](Scene& s, Material& m) {
        m.roughness = 1.0f;
        m.metallic_roughness_texture = add_texture(s, sharp);
      },
      [](Scene& s, Material&) {
        s.meshes[0].colors_rec709.assign(s.meshes[0].positions.size(), Vec4f(1.0f));
      },
  };
  for (std::size_t i = 0; i < nothings.size(); ++i) {
    for (const Material& material : {test::glass(1.5), test::mirror("metal/Ag")}) {
      const FlatBodies flat = bodies_of(material, nothings[i]);
      EXPECT_EQ(flat.bodies.size(), 1u) << i;
      EXPECT_TRUE(flat.fallbacks.empty()) << i;
    }
  }
  const FlatBodies flat = bodies_of(test::mirror("metal/Ag"), [](Scene&, Material& m) {
    m.specular.emplace().factor = 0.5f;  // A metal has none.
  });
  EXPECT_EQ(flat.bodies.size(), 1u);
}

TEST(FlatBodies, what_paths_do_not_know_leaves_light_straight_and_is_named) {
  const std::vector<std::uint8_t> red{255, 0, 0, 255, 255, 255, 255, 255};
  const std::vector<std::uint8_t> holes{255, 255, 255, 0, 255, 255, 255, 255};
  struct Trouble {
    Edit edit;
    std::string why;
    bool is_of_mirrors = true;
  };
  const std::vector<Trouble> troubles{
      {[](Scene&, Material& m) {
         m.alpha_mode = AlphaMode::Blend;
         m.base_color_rec709.w = 0.5f;
       },
       "alpha"},
      {[&](Scene& s, Material& m) {
         m.alpha_mode = AlphaMode::Mask;
         m.base_color_texture = add_texture(s, holes);
       },
       "alpha"},
      {[](Scene& s, Material& m) {
         m.alpha_mode = AlphaMode::Blend;
         s.meshes[0].colors_rec709.assign(s.meshes[0].positions.size(), Vec4f(1, 1, 1, 0.5f));
       },
       "alpha"},
      {[&](Scene& s, Material& m) { m.base_color_texture = add_texture(s, red); }, "colours"},
      {[](Scene& s, Material&) {
         s.meshes[0].colors_rec709.assign(s.meshes[0].positions.size(), Vec4f(1, 0, 0, 1));
       },
       "vertices"},
      {[&](Scene& s, Material& m) { m.normal_texture = add_texture(s, red); }, "normal map"},
      {[&](Scene& s, Material& m) { m.film.emplace().thickness_texture = add_texture(s, red); },
       "film"},
      {[](Scene&, Material& m) { m.clearcoat.emplace().factor = 0.1f; }, "clearcoat"},
      {[](Scene&, Material& m) { m.sheen.emplace().color_rec709 = Vec3f(0.1f); }, "sheen"},
      {[](Scene&, Material& m) { m.anisotropy.emplace().strength = 0.5f; }, "rough along"},
      {[](Scene&, Material& m) { m.specular.emplace().factor = 0.5f; }, "specular", false},
      {[](Scene&, Material& m) { m.diffuse_transmission.emplace().factor = 0.1f; },
       "diffuse_transmission", false},
      {[](Scene&, Material& m) { m.metallic = 0.1f; }, "metallicFactor 0.1", false},
      {[](Scene&, Material& m) { m.transmission = 0.9f; }, "transmissionFactor 0.9", false},
      {[&](Scene& s, Material& m) {
         m.transmission_texture = add_texture(s, {0, 0, 0, 255, 255, 255, 255, 255});
       },
       "lets light through", false},
  };
  for (const Trouble& trouble : troubles) {
    for (const Material& material : {test::glass(1.5), test::mirror("metal/Ag")}) {
      if (material.conductor && !trouble.is_of_mirrors) continue;
      const FlatBodies flat = bodies_of(material, trouble.edit);
      EXPECT_TRUE(flat.bodies.empty()) << trouble.why;
      ASSERT_EQ(flat.fallbacks.size(), 1u) << trouble.why;
      EXPECT_THAT(flat.fallbacks[0], HasSubstr(trouble.why));
    }
  }
  // A metal by RGB, of which a part is none.
  Material partly = test::glass(1.5);
  partly.has_volume = false;
  partly.transmission = 0.0f;
  partly.metallic = 0.9f;
  const FlatBodies flat = bodies_of(partly, [](Scene&, Material&) {});
  ASSERT_EQ(flat.fallbacks.size(), 1u);
  EXPECT_THAT(flat.fallbacks[0], HasSubstr("metallicFactor 0.9"));
}

TEST(FlatBodies, triangle_that_is_there_twice_opens_no_mesh) {
  Scene scene = box_scene();
  auto& triangles = scene.meshes.front().triangles;
  const auto& t = triangles.front();
  triangles.push_back({t[1], t[2], t[0]});
  Notes notes;
  const LitWorld world = world_of(scene, notes, 16);
  EXPECT_TRUE(notes.all().empty());
  EXPECT_EQ(world.caustics.flat.faces.size(), 6u);
}

// Two boxes of glass, the second moved from the first.
FlatBodies two_boxes(const Vec3d& half, const Vec3d& shift, Notes& notes, int priority = 0) {
  Scene scene = box_scene();
  Material other = test::glass(1.333);
  other.priority = static_cast<std::int16_t>(priority);
  test::add_box(scene, test::add(scene, other), half, test::translation(shift));
  scene.instances.back().name = "second";
  return find_flat_bodies(scene, notes);
}

std::size_t facets_between(const FlatBodies& flat, std::uint32_t body, std::uint32_t beyond) {
  return static_cast<std::size_t>(std::count_if(
      flat.facets.begin(), flat.facets.end(),
      [&](const Facet& facet) { return facet.body == body && facet.beyond == beyond; }));
}

double area_between(const FlatBodies& flat, std::uint32_t body, std::uint32_t beyond) {
  double area = 0.0;
  for (const Facet& facet : flat.facets) {
    if (facet.body == body && facet.beyond == beyond) area += area_of(facet.corners);
  }
  return area;
}

TEST(FlatBodies, faces_in_contact_are_one_boundary) {
  Notes notes;
  const FlatBodies flat = two_boxes({0.5, 0.5, 0.5}, {1, 0, 0}, notes);
  ASSERT_EQ(flat.bodies.size(), 2u);
  EXPECT_EQ(flat.facets.size(), 11u);
  EXPECT_EQ(facets_between(flat, 0, 1), 1u);
  EXPECT_EQ(facets_between(flat, 1, 0), 0u);
  EXPECT_TRUE(notes.all().empty());
}

TEST(FlatBodies, face_on_a_part_of_a_face_cuts_it) {
  Notes notes;
  const FlatBodies flat = two_boxes({0.25, 0.125, 0.25}, {0.1, 0.625, 0.05}, notes);
  ASSERT_EQ(flat.bodies.size(), 2u);
  EXPECT_NEAR(area_between(flat, 0, 1), 0.25, 1e-12);
  double top = 0.0;
  for (const Facet& facet : flat.facets) {
    if (facet.body == 0 && facet.normal.y > 0.5) top += area_of(facet.corners);
  }
  EXPECT_NEAR(top, 1.0, 1e-12);
  EXPECT_EQ(flat.bodies[1].facet_count, 5u);
}

TEST(FlatBodies, gap_wider_than_rounding_is_air) {
  Notes notes;
  const FlatBodies flat = two_boxes({0.5, 0.5, 0.5}, {1.00001, 0, 0}, notes);
  EXPECT_EQ(flat.facets.size(), 12u);
  for (const Facet& facet : flat.facets) EXPECT_FALSE(facet.beyond.has_value());
}

TEST(FlatBodies, body_inside_another_has_that_before_it) {
  Notes notes;
  const FlatBodies flat = two_boxes({0.125, 0.125, 0.125}, {0.1, 0.2, 0}, notes);
  ASSERT_EQ(flat.facets.size(), 12u);
  EXPECT_EQ(facets_between(flat, 1, 0), 6u);
  EXPECT_TRUE(flat.bodies[0].has_inclusions);
}

TEST(FlatBodies, body_inside_one_of_higher_priority_is_not_there) {
  Notes notes;
  const FlatBodies flat = two_boxes({0.125, 0.125, 0.125}, {0.1, 0.2, 0}, notes, -1);
  ASSERT_EQ(flat.bodies.size(), 2u);
  EXPECT_EQ(flat.bodies[1].facet_count, 0u);
}

// Boxes of glass in one place, as triangles or exact ones, on a floor that shines.
Scene boxes_in_one_place(const std::vector<double>& indices, bool first_is_mesh = true) {
  Scene scene;
  scene.name = "test";
  test::add_square(scene, test::add(scene, test::matte(Vec3f(1.0f))), 20.0,
                   test::translation({0, -1, 0}) * test::rotation({1, 0, 0}, -90.0));
  for (std::size_t i = 0; i < indices.size(); ++i) {
    const std::uint32_t material = test::add(scene, test::glass(indices[i]));
    const auto add = (i == 0) == first_is_mesh ? test::add_box_mesh : test::add_box;
    add(scene, material, {0.5, 0.25, 0.5}, Mat4d(1.0));
  }
  scene.lights.push_back(test::directional_light({0, -1, 0}, 1000.0));
  return scene;
}

TEST(FlatBodies, of_equal_bodies_in_one_place_the_one_of_the_last_primitives_is_there) {
  // Exact shapes have their primitives after those of meshes.
  for (const bool first_is_mesh : {true, false}) {
    Notes notes;
    const LitWorld world = world_of(boxes_in_one_place({1.5, 1.7}, first_is_mesh), notes);
    ASSERT_EQ(world.caustics.flat.bodies.size(), 2u);
    EXPECT_EQ(world.caustics.flat.bodies[0].facet_count, first_is_mesh ? 0u : 6u);
    EXPECT_EQ(world.caustics.flat.bodies[1].facet_count, first_is_mesh ? 6u : 0u);
    EXPECT_EQ(world.caustics.surface_is_exact[1], 1);
    EXPECT_EQ(world.caustics.surface_is_exact[2], 1);
  }
}

TEST(FlatBodies, equal_bodies_in_one_place_are_one_for_light_and_for_the_eye) {
  RenderSettings settings = test::small_settings();
  settings.wavelengths.exact_nm = {kLine_d_nm};
  const auto brightness = [&](const std::vector<double>& indices, double eye_height_m) {
    Scene scene = boxes_in_one_place(indices);
    scene.cameras = {test::orthographic_camera({0, eye_height_m, 0}, {0, -1, 0}, 0.02, 0.02)};
    return test::pixel(test::render(scene, settings).image, 4, 4,
                       spectral_channel_name(kLine_d_nm));
  };
  for (const double eye_height_m : {-0.5, 0.5}) {  // Below the glass, and above it.
    const double alone = brightness({1.7}, eye_height_m);
    EXPECT_GT(alone, 0.0);
    // Single precision.
    EXPECT_NEAR(brightness({1.7, 1.7}, eye_height_m), alone, 1e-5 * alone);
    EXPECT_NEAR(brightness({1.5, 1.7}, eye_height_m), alone, 1e-5 * alone);
    EXPECT_NEAR(brightness({1.5, 1.7, 1.7}, eye_height_m), alone, 1e-5 * alone);
  }
}

TEST(FlatBodies, body_hidden_in_another_does_not_stop_its_light) {
  RenderSettings settings = test::small_settings();
  settings.wavelengths.exact_nm = {kLine_d_nm};
  const auto brightness = [&](bool has_hidden) {
    Scene scene = boxes_in_one_place({1.5});
    scene.cameras = {test::orthographic_camera({0, -0.5, 0}, {0, -1, 0}, 0.02, 0.02)};
    Material hidden = test::glass(1.8);
    hidden.priority = -1;
    if (has_hidden) {
      test::add_box_mesh(scene, test::add(scene, hidden), {0.25, 0.125, 0.25},
                         test::translation({0, 0.125, 0}));
    }
    return test::pixel(test::render(scene, settings).image, 4, 4,
                       spectral_channel_name(kLine_d_nm));
  };
  const double alone = brightness(false);
  EXPECT_NEAR(brightness(true), alone, 1e-5 * alone);  // Single precision.
}

// Panes 4 mm thick with something between them, and a body far from both.
FlatBodies panes_and_far_body(double gap_m, bool is_filled, double far_m) {
  Notes notes;
  Scene scene;
  const auto add = [&](const Vec3d& half, const Vec3d& at) {
    test::add_box_mesh(scene, test::add(scene, test::glass(1.5)), half, test::translation(at));
  };
  add({0.5, 0.002, 0.5}, {0, 0.002, 0});
  add({0.5, 0.002, 0.5}, {0, 0.006 + gap_m, 0});
  if (is_filled) add({0.5, 0.5 * gap_m, 0.5}, {0, 0.004 + 0.5 * gap_m, 0});
  add({0.5, 0.5, 0.5}, {far_m, 0.5, 0});
  return find_flat_bodies(scene, notes);
}

TEST(FlatBodies, far_body_does_not_change_what_is_in_contact) {
  for (const double far_m : {2.0, 3000.0, 1e5}) {
    EXPECT_EQ(panes_and_far_body(1e-3, false, far_m).facets.size(), 18u) << far_m;
    const FlatBodies glued = panes_and_far_body(1e-5, true, far_m);
    EXPECT_EQ(glued.facets.size(), 22u) << far_m;
    EXPECT_NEAR(area_between(glued, 0, 2), 1.0, 1e-6) << far_m;  // Float corners.
    EXPECT_NEAR(area_between(glued, 1, 2), 1.0, 1e-6) << far_m;
  }
}

TEST(FlatBodies, faces_narrower_than_rounding_stay_on_their_body) {
  // 5 µm at 100 m, where positions touch within 48 µm.
  Notes notes;
  Scene scene;
  for (const double height : {2.5e-6, 0.500005}) {
    test::add_box_mesh(scene, test::add(scene, test::glass(1.5)),
                       {0.5, height < 0.1 ? 2.5e-6 : 0.5, 0.5},
                       test::translation({100.0, height, 0}));
  }
  const FlatBodies flat = find_flat_bodies(scene, notes);
  ASSERT_EQ(flat.bodies.size(), 2u);
  std::size_t narrow = 0;
  for (const Facet& facet : flat.facets) narrow += area_of(facet.corners) < 1e-5 ? 1 : 0;
  EXPECT_EQ(narrow, 4u);
}

TEST(FlatBodies, bodies_that_go_through_each_other_are_left_to_straight_rays) {
  Notes notes;
  const FlatBodies flat = two_boxes({0.5, 0.5, 0.5}, {0.35, 0.3, 0.25}, notes);
  EXPECT_TRUE(flat.bodies.empty());
  ASSERT_EQ(flat.fallbacks.size(), 2u);
  EXPECT_THAT(flat.fallbacks[0], HasSubstr("go through those of"));
}

TEST(FlatBodies, many_bodies_left_to_straight_rays_get_one_warning) {
  Scene scene;
  const std::uint32_t material = test::add(scene, test::glass(1.5));
  for (int i = 0; i < 3; ++i) {
    for (const double x : {0.0, 0.35}) {
      test::add_box_mesh(scene, material, {0.5, 0.5, 0.5},
                         test::translation({x, 2.0 * i, 0.25 * x}));
      scene.instances.back().name = "box";
    }
  }
  Notes notes;
  const FlatBodies flat = find_flat_bodies(scene, notes);
  EXPECT_EQ(flat.fallbacks.size(), 6u);
  ASSERT_EQ(notes.all().size(), 1u);
  EXPECT_EQ(notes.all()[0].where, "6 bodies, e.g. box");
}

}  // namespace
}  // namespace abbe
