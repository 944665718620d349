#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "load/gltf_builder.h"

namespace abbe {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using Corners = std::array<std::uint32_t, 3>;

class GltfMesh : public GltfTest {
 protected:
  // Five vertices on a zigzag, no two of whose triangles are degenerate.
  void use_zigzag() {
    primitive()["attributes"]["POSITION"] =
        add_accessor(std::vector<float>{0, 0, 0, 0, 1, 0, 1, 0, 0, 1, 1, 0, 2, 0, 0}, "VEC3");
  }
};

TEST_F(GltfMesh, file_of_one_triangle_loads_without_a_note) {
  const Scene scene = load();
  ASSERT_EQ(scene.meshes.size(), 1u);
  EXPECT_THAT(scene.meshes[0].triangles, ElementsAre(Corners{0, 1, 2}));
  EXPECT_EQ(scene.meshes[0].positions[1], Vec3f(1, 0, 0));
  ASSERT_EQ(scene.instances.size(), 1u);
  ASSERT_EQ(scene.materials.size(), 1u);
  EXPECT_EQ(scene.materials[scene.meshes[0].material].roughness, 1.0f);
  EXPECT_EQ(notes_text(), "");
}

TEST_F(GltfMesh, glb_equals_gltf) {
  const Scene text = load();
  const Scene binary_file = load_glb();
  EXPECT_EQ(binary_file.meshes[0].positions, text.meshes[0].positions);
  EXPECT_EQ(binary_file.meshes[0].triangles, text.meshes[0].triangles);
}

TEST_F(GltfMesh, list_with_indices_of_each_width_gives_the_same_triangle) {
  const std::vector<std::uint8_t> bytes = {2, 0, 1};
  const std::vector<std::uint16_t> shorts = {2, 0, 1};
  const std::vector<std::uint32_t> longs = {2, 0, 1};
  for (const std::size_t accessor : {add_accessor(bytes, "SCALAR"), add_accessor(shorts, "SCALAR"),
                                     add_accessor(longs, "SCALAR")}) {
    primitive()["indices"] = accessor;
    document.erase("buffers");
    EXPECT_THAT(load().meshes[0].triangles, ElementsAre(Corners{2, 0, 1}));
  }
}

TEST_F(GltfMesh, strip_keeps_the_winding_of_its_first_triangle) {
  use_zigzag();
  primitive()["mode"] = 5;
  const Scene scene = load();
  EXPECT_THAT(scene.meshes[0].triangles,
              ElementsAre(Corners{0, 1, 2}, Corners{1, 3, 2}, Corners{2, 3, 4}));
  for (const Corners& t : scene.meshes[0].triangles) {
    const auto& p = scene.meshes[0].positions;
    EXPECT_LT(glm::cross(p[t[1]] - p[t[0]], p[t[2]] - p[t[0]]).z, 0.0f);
  }
}

TEST_F(GltfMesh, fan_turns_around_its_first_vertex) {
  primitive()["attributes"]["POSITION"] =
      add_accessor(std::vector<float>{0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0}, "VEC3");
  primitive()["mode"] = 6;
  EXPECT_THAT(load().meshes[0].triangles, ElementsAre(Corners{1, 2, 0}, Corners{2, 3, 0}));
}

TEST_F(GltfMesh, points_and_lines_are_skipped_with_a_note) {
  for (const int mode : {0, 1, 2, 3}) {
    primitive()["mode"] = mode;
    EXPECT_THAT(load().meshes, IsEmpty());
    const char* counts[] = {"3 points are not rendered", "1 lines are not rendered",
                            "3 lines are not rendered", "2 lines are not rendered"};
    EXPECT_THAT(notes_text(), HasSubstr(counts[mode]));
  }
}

TEST_F(GltfMesh, interleaved_attributes_are_read_with_their_stride) {
  const std::size_t view = add_view(std::vector<float>{0, 0, 0, 0, 0, 2, 1, 0, 0, 0, 0, 2,  //
                                                       0, 1, 0, 0, 0, 2});
  document["bufferViews"][view]["byteStride"] = 24;
  for (const int offset : {0, 12}) {
    document["accessors"].push_back({{"bufferView", view},
                                     {"byteOffset", offset},
                                     {"componentType", 5126},
                                     {"count", 3},
                                     {"type", "VEC3"}});
  }
  primitive()["attributes"] = {{"POSITION", 1}, {"NORMAL", 2}};
  const Scene scene = load();
  EXPECT_EQ(scene.meshes[0].positions[2], Vec3f(0, 1, 0));
  EXPECT_EQ(scene.meshes[0].normals[2], Vec3f(0, 0, 1));  // Made unit length.
}

TEST_F(GltfMesh, sparse_accessor_replaces_elements) {
  const std::size_t indices = add_view(std::vector<std::uint16_t>{1});
  const std::size_t values = add_view(std::vector<float>{7, 8, 9});
  document["accessors"][0]["sparse"] = {
      {"count", 1},
      {"indices", {{"bufferView", indices}, {"componentType", 5123}}},
      {"values", {{"bufferView", values}}}};
  EXPECT_EQ(load().meshes[0].positions[1], Vec3f(7, 8, 9));
}

TEST_F(GltfMesh, sparse_accessor_without_a_view_starts_from_zeros) {
  const std::size_t indices = add_view(std::vector<std::uint8_t>{0, 2});
  const std::size_t values = add_view(std::vector<float>{1, 0, 0, 0, 1, 0});
  document["accessors"][0].erase("bufferView");
  document["accessors"][0]["sparse"] = {
      {"count", 2},
      {"indices", {{"bufferView", indices}, {"componentType", 5121}}},
      {"values", {{"bufferView", values}}}};
  const Scene scene = load();
  EXPECT_THAT(scene.meshes[0].positions,
              ElementsAre(Vec3f(1, 0, 0), Vec3f(0, 0, 0), Vec3f(0, 1, 0)));
}

TEST_F(GltfMesh, normalized_integers_become_fractions) {
  primitive()["attributes"]["TEXCOORD_0"] =
      add_accessor(std::vector<std::uint16_t>{0, 65535, 32768, 0, 0, 0}, "VEC2", true);
  primitive()["attributes"]["COLOR_0"] = add_accessor(
      std::vector<std::uint8_t>{255, 0, 51, 255, 0, 0, 0, 255, 0, 0, 0, 0}, "VEC4", true);
  const Scene scene = load();
  EXPECT_EQ(scene.meshes[0].uv[0][0], Vec2f(0, 1));
  EXPECT_FLOAT_EQ(scene.meshes[0].uv[0][1].x, 32768.0f / 65535.0f);
  EXPECT_EQ(scene.meshes[0].colors_rec709[0], Vec4f(1, 0, 0.2f, 1));
}

TEST_F(GltfMesh, color_of_three_components_has_alpha_one) {
  primitive()["attributes"]["COLOR_0"] =
      add_accessor(std::vector<float>{1, 0, 0, 0, 1, 0, 0, 0, 1}, "VEC3");
  EXPECT_EQ(load().meshes[0].colors_rec709[1], Vec4f(0, 1, 0, 1));
}

TEST_F(GltfMesh, two_sets_of_texture_coordinates_and_tangents_are_kept) {
  primitive()["attributes"]["TEXCOORD_0"] =
      add_accessor(std::vector<float>{0, 0, 1, 0, 0, 1}, "VEC2");
  primitive()["attributes"]["TEXCOORD_1"] =
      add_accessor(std::vector<float>{5, 0, 1, 0, 0, 1}, "VEC2");
  primitive()["attributes"]["TANGENT"] =
      add_accessor(std::vector<float>{2, 0, 0, -1, 1, 0, 0, 1, 1, 0, 0, 1}, "VEC4");
  const Scene scene = load();
  EXPECT_EQ(scene.meshes[0].uv[1][0], Vec2f(5, 0));
  EXPECT_EQ(scene.meshes[0].tangents[0], Vec4f(1, 0, 0, -1));
}

TEST_F(GltfMesh, quantized_positions_need_the_extension) {
  primitive()["attributes"]["POSITION"] =
      add_accessor(std::vector<std::int16_t>{0, 0, 0, 100, 0, 0, 0, -100, 0}, "VEC3");
  document["bufferViews"].back()["byteStride"] = 8;
  document["bufferViews"].back()["byteLength"] = 24;
  binary.resize(binary.size() + 8);
  // Stride 8 with elements of 6 bytes: re-lay the data.
  const std::int16_t laid[12] = {0, 0, 0, 0, 100, 0, 0, 0, 0, -100, 0, 0};
  std::memcpy(binary.data() + document["bufferViews"].back()["byteOffset"].get<std::size_t>(), laid,
              sizeof(laid));
  EXPECT_THAT(error(), HasSubstr("KHR_mesh_quantization"));
  document["extensionsUsed"] = {"KHR_mesh_quantization"};
  document["extensionsRequired"] = {"KHR_mesh_quantization"};
  EXPECT_EQ(load().meshes[0].positions[2], Vec3f(0, -100, 0));
}

TEST_F(GltfMesh, normalized_signed_integers_end_at_minus_one) {
  document["extensionsUsed"] = {"KHR_mesh_quantization"};
  primitive()["attributes"]["NORMAL"] = add_accessor(
      std::vector<std::int8_t>{0, 0, -128, 0, 0, 127, 0, 0, 127, 0, 0, 0}, "VEC3", true);
  document["accessors"].back()["count"] = 3;
  const Scene scene = load();
  EXPECT_EQ(scene.meshes[0].normals[0], Vec3f(0, 0, -1));
  EXPECT_EQ(scene.meshes[0].normals[1], Vec3f(0, 0, 1));
}

TEST_F(GltfMesh, bad_corners_and_degenerate_triangles_are_dropped_and_counted) {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  primitive()["attributes"]["POSITION"] =
      add_accessor(std::vector<float>{0, 0, 0, 1, 0, 0, 0, 1, 0, nan, 0, 0, 2, 0, 0}, "VEC3");
  primitive()["indices"] =
      add_accessor(std::vector<std::uint8_t>{0, 1, 2, 0, 1, 3, 0, 1, 4, 1, 1, 2}, "SCALAR");
  const Scene scene = load();
  EXPECT_THAT(scene.meshes[0].triangles, ElementsAre(Corners{0, 1, 2}));
  EXPECT_EQ(scene.meshes[0].positions.size(), 3u);
  EXPECT_THAT(notes_text(), HasSubstr("1 triangles with a corner that is not finite"));
  EXPECT_THAT(notes_text(), HasSubstr("2 degenerate triangles"));
}

TEST_F(GltfMesh, unused_vertices_are_dropped_with_their_attributes) {
  primitive()["attributes"]["POSITION"] = add_accessor(
      std::vector<float>{9, 9, 9, 0, 0, 0, 1, 0, 0, 0, 1, 0, 9, 9, 9, 9, 9, 9, 9, 9, 9, 9, 9, 9},
      "VEC3");
  primitive()["attributes"]["TEXCOORD_0"] =
      add_accessor(std::vector<float>{9, 9, 1, 0, 2, 0, 3, 0, 9, 9, 9, 9, 9, 9, 9, 9}, "VEC2");
  primitive()["indices"] = add_accessor(std::vector<std::uint8_t>{3, 1, 2}, "SCALAR");
  const Scene scene = load();
  EXPECT_THAT(scene.meshes[0].positions,
              ElementsAre(Vec3f(0, 0, 0), Vec3f(1, 0, 0), Vec3f(0, 1, 0)));
  EXPECT_THAT(scene.meshes[0].uv[0], ElementsAre(Vec2f(1, 0), Vec2f(2, 0), Vec2f(3, 0)));
  EXPECT_THAT(scene.meshes[0].triangles, ElementsAre(Corners{2, 0, 1}));
}

TEST_F(GltfMesh, sparse_indices_without_a_view_start_from_zeros) {
  const std::size_t places = add_view(std::vector<std::uint8_t>{1, 2});
  const std::size_t values = add_view(std::vector<std::uint16_t>{2, 1});
  document["accessors"].push_back({{"componentType", 5123},
                                   {"count", 3},
                                   {"type", "SCALAR"},
                                   {"sparse",
                                    {{"count", 2},
                                     {"indices", {{"bufferView", places}, {"componentType", 5121}}},
                                     {"values", {{"bufferView", values}}}}}});
  primitive()["indices"] = document["accessors"].size() - 1;
  EXPECT_THAT(load().meshes[0].triangles, ElementsAre(Corners{0, 2, 1}));
}

TEST_F(GltfMesh, file_without_any_view_has_zeros_for_indices_and_positions) {
  document.erase("bufferViews");
  document["buffers"] = Json::array();
  document["accessors"] = {{{"componentType", 5126}, {"count", 3}, {"type", "VEC3"}},
                           {{"componentType", 5123}, {"count", 3}, {"type", "SCALAR"}}};
  primitive()["indices"] = 1;
  EXPECT_TRUE(load().meshes.empty());
  EXPECT_THAT(notes_text(), HasSubstr("1 degenerate triangles are dropped"));
}

TEST_F(GltfMesh, selected_vertices_of_a_sparse_accessor_are_the_replaced_ones) {
  std::vector<float> positions(60, 9.0f);
  primitive()["attributes"]["POSITION"] = add_accessor(positions, "VEC3");
  const std::size_t indices = add_view(std::vector<std::uint8_t>{4, 7, 11, 19});
  const std::size_t values = add_view(std::vector<float>{0, 0, 0, 1, 0, 0, 5, 5, 5, 0, 1, 0});
  document["accessors"].back()["sparse"] = {
      {"count", 4},
      {"indices", {{"bufferView", indices}, {"componentType", 5121}}},
      {"values", {{"bufferView", values}}}};
  primitive()["indices"] = add_accessor(std::vector<std::uint8_t>{4, 7, 19}, "SCALAR");
  EXPECT_THAT(load().meshes[0].positions,
              ElementsAre(Vec3f(0, 0, 0), Vec3f(1, 0, 0), Vec3f(0, 1, 0)));
}

TEST_F(GltfMesh, invalid_normal_is_replaced_by_its_triangles) {
  primitive()["attributes"]["NORMAL"] =
      add_accessor(std::vector<float>{0, 0, 1, 0, 0, 0, 0, 0, 1}, "VEC3");
  EXPECT_EQ(load().meshes[0].normals[1], Vec3f(0, 0, 1));
  EXPECT_THAT(notes_text(), HasSubstr("1 normals"));
}

TEST_F(GltfMesh, body_of_glass_inside_out_is_turned_with_one_line_that_names_it) {
  // A tetrahedron that faces inwards.
  primitive()["attributes"]["POSITION"] =
      add_accessor(std::vector<float>{0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1}, "VEC3");
  primitive()["indices"] =
      add_accessor(std::vector<std::uint16_t>{0, 1, 2, 0, 3, 1, 0, 2, 3, 1, 3, 2}, "SCALAR");
  document["meshes"][0]["name"] = "gem";
  // An opaque one has no inside that matters.
  EXPECT_THAT(load().meshes[0].triangles[0], Corners({0, 1, 2}));
  EXPECT_EQ(notes_text(), "");
  material()["extensions"]["KHR_materials_transmission"] = {{"transmissionFactor", 1.0}};
  material()["extensions"]["KHR_materials_volume"] = {{"thicknessFactor", 1.0}};
  document["extensionsUsed"] = {"KHR_materials_transmission", "KHR_materials_volume"};
  document.erase("buffers");
  EXPECT_THAT(load().meshes[0].triangles[0], Corners({0, 2, 1}));
  ASSERT_EQ(notes.all().size(), 1u);
  EXPECT_EQ(notes.all()[0].kind, NoteKind::Warning);
  EXPECT_THAT(notes.all()[0].where, HasSubstr("/meshes/0/primitives/0"));
  EXPECT_THAT(notes.all()[0].text, HasSubstr("mesh \"gem\" is inside out: 1 of its 1 closed"));
}

TEST_F(GltfMesh, primitives_of_one_glass_are_one_closed_body) {
  // A tetrahedron that faces inwards: three faces in one primitive, the fourth in another.
  primitive()["attributes"]["POSITION"] =
      add_accessor(std::vector<float>{0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1}, "VEC3");
  primitive()["indices"] =
      add_accessor(std::vector<std::uint16_t>{0, 1, 2, 0, 3, 1, 0, 2, 3}, "SCALAR");
  material();
  document["meshes"][0]["primitives"].push_back(primitive());
  document["meshes"][0]["primitives"][1]["indices"] =
      add_accessor(std::vector<std::uint16_t>{1, 3, 2}, "SCALAR");
  // Surfaces of something opaque are told apart by their primitives.
  EXPECT_EQ(load().meshes.size(), 2u);
  material()["extensions"]["KHR_materials_transmission"] = {{"transmissionFactor", 1.0}};
  material()["extensions"]["KHR_materials_volume"] = {{"thicknessFactor", 1.0}};
  document["extensionsUsed"] = {"KHR_materials_transmission", "KHR_materials_volume"};
  document.erase("buffers");
  const Scene scene = load();
  ASSERT_EQ(scene.meshes.size(), 1u);
  EXPECT_EQ(scene.instances.size(), 1u);
  EXPECT_EQ(scene.meshes[0].triangles.size(), 4u);
  EXPECT_THAT(notes_text(), HasSubstr("1 of its 1 closed"));
  // With another attribute they are no one mesh.
  document["meshes"][0]["primitives"][1]["attributes"]["NORMAL"] =
      add_accessor(std::vector<float>{0, 0, 1, 0, 0, 1, 0, 0, 1, 0, 0, 1}, "VEC3");
  document.erase("buffers");
  EXPECT_EQ(load().meshes.size(), 2u);
}

TEST_F(GltfMesh, attribute_of_another_length_is_an_error) {
  primitive()["attributes"]["NORMAL"] = add_accessor(std::vector<float>{0, 0, 1}, "VEC3");
  EXPECT_THAT(error(), HasSubstr("/meshes/0/primitives/0/attributes/NORMAL"));
}

TEST_F(GltfMesh, index_out_of_range_is_an_error_with_its_place) {
  primitive()["indices"] = add_accessor(std::vector<std::uint8_t>{0, 1, 3}, "SCALAR");
  EXPECT_THAT(error(), HasSubstr("index 3 at place 2"));
}

TEST_F(GltfMesh, primitives_keep_their_own_materials_and_nodes_share_meshes) {
  document["materials"] = {{{"name", "red"}}, {{"name", "blue"}}};
  document["meshes"][0]["primitives"] = {{{"attributes", {{"POSITION", 0}}}, {"material", 1}},
                                         {{"attributes", {{"POSITION", 0}}}}};
  document["nodes"] = {{{"mesh", 0}}, {{"mesh", 0}}};
  document["scenes"][0]["nodes"] = {0, 1};
  const Scene scene = load();
  ASSERT_EQ(scene.meshes.size(), 2u);
  EXPECT_EQ(scene.instances.size(), 4u);
  EXPECT_EQ(scene.materials[scene.meshes[0].material].name, "blue");
  EXPECT_EQ(scene.materials[scene.meshes[1].material].name, "default");
}

TEST_F(GltfMesh, small_file_that_unfolds_into_a_huge_scene_is_an_error) {
  std::vector<std::uint8_t> corners(300'000);
  for (std::size_t i = 0; i < corners.size(); ++i) corners[i] = static_cast<std::uint8_t>(i % 3);
  const std::size_t indices = add_accessor(corners, "SCALAR");
  Json primitives = Json::array();
  for (int i = 0; i < 1000; ++i) {
    primitives.push_back({{"attributes", {{"POSITION", 0}}}, {"indices", indices}});
  }
  document["meshes"][0]["primitives"] = primitives;
  EXPECT_THAT(error(), HasSubstr("in proportion to its files"));
}

TEST_F(GltfMesh, few_triangles_instanced_without_end_are_an_error) {
  std::vector<std::uint8_t> corners(3'000'000);
  for (std::size_t i = 0; i < corners.size(); ++i) corners[i] = static_cast<std::uint8_t>(i % 3);
  primitive()["indices"] = add_accessor(corners, "SCALAR");
  document["nodes"] = Json::array();
  document["scenes"][0]["nodes"] = Json::array();
  for (int i = 0; i < 1000; ++i) {
    document["nodes"].push_back({{"mesh", 0}});
    document["scenes"][0]["nodes"].push_back(i);
  }
  EXPECT_THAT(error(), HasSubstr("triangles in the scene"));
}

}  // namespace
}  // namespace abbe
