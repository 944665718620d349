// Files with a fault that viewers put up with, beside ones without it.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <limits>

#include "load/gltf_builder.h"

namespace abbe {
namespace {

Scene load_odd(const std::string& name, bool strict, Notes& notes) {
  LoadOptions options;
  options.strict = strict;
  return load_gltf(
      std::filesystem::path(ABBE_SOURCE_DIR) / "tests/reference/odd" / (name + ".gltf"),
      Catalogue::standard(), options, notes);
}

class OddFile : public testing::TestWithParam<const char*> {};

TEST_P(OddFile, good_mesh_is_there_and_one_warning_names_the_fault) {
  Notes notes, ignored;
  const Scene scene = load_odd(GetParam(), false, notes);
  const Scene good = load_odd("16_ref", false, ignored);
  ASSERT_EQ(scene.instances.size(), good.instances.size());
  EXPECT_EQ(scene.lights.size(), good.lights.size());
  EXPECT_FALSE(notes.all().empty());
  EXPECT_THROW(load_odd(GetParam(), true, ignored), Error);
}

INSTANTIATE_TEST_SUITE_P(field, OddFile,
                         testing::Values("16_count0", "16_stride0", "16_twice", "16_nonroot",
                                         "16_webpsource", "16_ior_half"));

TEST(OddFiles, inner_cone_a_rounding_above_the_outer_is_a_sharp_edge) {
  Notes notes;
  const Light light = load_odd("12_spot_above", false, notes).lights.front();
  EXPECT_LT(light.inner_cone_rad, light.outer_cone_rad);
  EXPECT_NEAR(light.inner_cone_rad, light.outer_cone_rad, 1e-5);  // Wider than single precision.
  EXPECT_EQ(notes.all().size(), 1u);
}

TEST(OddFiles, good_files_are_without_a_word_and_pass_as_strict) {
  for (const char* name : {"16_ref", "12_spot_ref"}) {
    Notes notes;
    load_odd(name, true, notes);
    EXPECT_TRUE(notes.all().empty()) << name;
  }
}

class OddDocument : public GltfTest {
 protected:
  /// Loads, expects one instance and one warning with such a part, and an error as a strict file.
  Scene expect_fault(const std::string& part) {
    Scene scene = load();
    EXPECT_EQ(scene.instances.size(), 1u);
    EXPECT_EQ(notes.all().size(), 1u) << notes_text();
    EXPECT_THAT(notes_text(), testing::HasSubstr(part));
    LoadOptions strict;
    strict.strict = true;
    Notes ignored;
    EXPECT_THROW(load_gltf(folder / "scene.gltf", Catalogue::standard(), strict, ignored), Error);
    return scene;
  }
};

TEST_F(OddDocument, what_is_limited_or_left_out_is_an_error_of_a_strict_file) {
  material()["pbrMetallicRoughness"] = {{"roughnessFactor", 1.5}};
  expect_fault("roughnessFactor: 1.5 is outside 0 to 1; limited");
  material().erase("pbrMetallicRoughness");
  document["extensionsUsed"] = {"EXT_future"};
  expect_fault("EXT_future");
  document.erase("extensionsUsed");
  Json lines = primitive();
  lines["mode"] = 1;
  document["meshes"][0]["primitives"].push_back(lines);
  expect_fault("/meshes/0/primitives");
  document["meshes"][0]["primitives"].erase(1);
  const float nan = std::numeric_limits<float>::quiet_NaN();
  for (const float x : {nan, 0.0f}) {
    primitive()["attributes"]["POSITION"] = add_accessor(
        std::vector<float>{0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, x, 0, 0}, "VEC3");
    document.erase("buffers");
    expect_fault(x == 0.0f ? "1 degenerate triangles" : "1 triangles with a corner");
  }
}

TEST_F(OddDocument, null_is_as_if_absent) {
  node()["name"] = nullptr;
  expect_fault("/nodes/0/name: null, expected a string; it is taken as absent");
  node().erase("name");
  document["accessors"][0]["min"] = {0, nullptr, 0};
  expect_fault("/accessors/0/min: null");
}

TEST_F(OddDocument, restart_index_begins_a_strip_anew) {
  const std::size_t positions =
      add_accessor(std::vector<float>{0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 1, 0}, "VEC3");
  primitive()["attributes"]["POSITION"] = positions;
  primitive()["indices"] =
      add_accessor(std::vector<std::uint16_t>{0, 1, 2, 0xffff, 3, 2, 1, 0}, "SCALAR");
  primitive()["mode"] = 5;
  const auto triangles = expect_fault("1 times 65535").meshes.at(0).triangles;
  using Corners = std::array<std::uint32_t, 3>;
  EXPECT_THAT(triangles,
              testing::ElementsAre(Corners{0, 1, 2}, Corners{3, 2, 1}, Corners{2, 0, 1}));
}

TEST_F(OddDocument, attenuation_distance_of_zero_absorbs_nothing) {
  material()["extensions"] = {
      {"KHR_materials_transmission", {{"transmissionFactor", 1}}},
      {"KHR_materials_volume", {{"thicknessFactor", 1}, {"attenuationDistance", 0}}}};
  const Scene scene = expect_fault("attenuationDistance: 0");
  EXPECT_TRUE(std::isinf(scene.materials[0].attenuation_distance_m));
}

TEST_F(OddDocument, mesh_without_primitives_is_left_out) {
  document["meshes"].push_back({{"primitives", Json::array()}});
  document["nodes"].push_back({{"mesh", 1}});
  document["scenes"][0]["nodes"] = {0, 1};
  expect_fault("/meshes/1/primitives: no primitive, expected one or more");
}

TEST_F(OddDocument, file_of_which_nothing_is_left_ends_with_its_fault) {
  document["meshes"][0]["primitives"] = Json::array();
  EXPECT_THAT(error(), testing::HasSubstr("/meshes/0/primitives: found no primitive"));
}

TEST_F(OddDocument, range_of_zero_is_none) {
  document["extensions"]["KHR_lights_punctual"]["lights"] = {{{"type", "point"}, {"range", 0}}};
  node()["extensions"]["KHR_lights_punctual"]["light"] = 0;
  EXPECT_TRUE(std::isinf(expect_fault("range: 0").lights.at(0).range_m));
}

TEST_F(OddDocument, missing_image_leaves_the_factor) {
  material()["pbrMetallicRoughness"]["baseColorTexture"]["index"] = 0;
  document["textures"] = {{{"source", 0}}};
  document["images"] = {{{"uri", "gone.png"}}};
  EXPECT_FALSE(expect_fault("\"gone.png\"").materials[0].base_color_texture);
}

TEST_F(OddDocument, optional_extension_may_be_required_others_are_errors) {
  document["extensionsUsed"] = {"KHR_materials_future"};
  document["extensionsRequired"] = {"KHR_materials_future"};
  expect_fault("the required extension KHR_materials_future");
  document["extensionsRequired"] = {"KHR_texture_basisu"};
  EXPECT_THAT(error(), testing::HasSubstr("KHR_texture_basisu"));
}

TEST_F(OddDocument, ktx2_alone_is_an_error_that_names_its_extension) {
  write("a.ktx2", "no image");
  material()["pbrMetallicRoughness"]["baseColorTexture"]["index"] = 0;
  document["images"] = {{{"uri", "a.ktx2"}}};
  document["textures"] = {{{"extensions", {{"KHR_texture_basisu", {{"source", 0}}}}}}};
  EXPECT_THAT(error(), testing::HasSubstr("/textures/0: found KHR_texture_basisu"));
}

}  // namespace
}  // namespace abbe
