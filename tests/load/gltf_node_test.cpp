#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "load/gltf_builder.h"

namespace abbe {
namespace {

using testing::HasSubstr;
using testing::IsEmpty;

class GltfNode : public GltfTest {
 protected:
  Vec3d placed(const Scene& scene, const Vec3d& point) const {
    return Vec3d(scene.instances.at(0).to_world * Vec4d(point, 1.0));
  }
};

void expect_near(const Vec3d& a, const Vec3d& b) {
  EXPECT_LT(glm::length(a - b), 1e-12) << a.x << " " << a.y << " " << a.z;  // A few roundings.
}

TEST_F(GltfNode, translation_rotation_scale_apply_from_right_to_left) {
  const double h = std::sqrt(0.5);
  node()["translation"] = {10, 20, 30};
  node()["rotation"] = {0, 0, h, h};  // 90° about z: x becomes y.
  node()["scale"] = {2, 3, 4};
  const Scene scene = load();
  expect_near(placed(scene, {1, 0, 0}), {10, 22, 30});
  expect_near(placed(scene, {0, 1, 0}), {7, 20, 30});
  expect_near(placed(scene, {0, 0, 1}), {10, 20, 34});
}

TEST_F(GltfNode, rotation_is_normalized) {
  node()["rotation"] = {0, 0, 5, 5};
  expect_near(placed(load(), {1, 0, 0}), {0, 1, 0});
}

TEST_F(GltfNode, matrix_is_column_major) {
  node()["matrix"] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 5, 6, 7, 1};
  expect_near(placed(load(), {1, 0, 0}), {6, 6, 7});
}

TEST_F(GltfNode, children_are_placed_by_their_parents) {
  document["nodes"] = {{{"children", {1}}, {"translation", {1, 0, 0}}},
                       {{"children", {2}}, {"scale", {2, 2, 2}}},
                       {{"mesh", 0}, {"translation", {0, 1, 0}}}};
  expect_near(placed(load(), {0, 0, 0}), {1, 2, 0});
}

TEST_F(GltfNode, mirrored_node_is_kept) {
  node()["scale"] = {-1, 1, 1};
  EXPECT_LT(glm::determinant(load().instances[0].to_world), 0.0);
  EXPECT_EQ(notes_text(), "");
}

TEST_F(GltfNode, scale_of_zero_hides_the_mesh_with_a_note) {
  node()["scale"] = {1, 0, 1};
  EXPECT_THAT(load().instances, IsEmpty());
  EXPECT_THAT(notes_text(), HasSubstr("flattens"));
}

TEST_F(GltfNode, mesh_carried_beyond_single_precision_is_left_out_with_a_note) {
  node()["translation"] = {1e30, 0, 0};
  EXPECT_THAT(load().instances, IsEmpty());
  EXPECT_THAT(notes_text(), HasSubstr("reaches beyond"));
}

TEST_F(GltfNode, transform_that_overflows_is_an_error) {
  document["nodes"] = {{{"children", {1}}, {"scale", {1e300, 1e300, 1e300}}},
                       {{"mesh", 0}, {"scale", {1e300, 1e300, 1e300}}}};
  EXPECT_THAT(error(), HasSubstr("/nodes/1"));
}

TEST_F(GltfNode, node_with_two_parents_is_an_error) {
  document["nodes"] = {{{"children", {2}}}, {{"children", {2}}}, {{"mesh", 0}}};
  document["scenes"][0]["nodes"] = {0, 1};
  EXPECT_THAT(error(), HasSubstr("already a child of node 0"));
}

TEST_F(GltfNode, cycle_is_an_error) {
  document["nodes"] = {{{"mesh", 0}}, {{"children", {2}}}, {{"children", {1}}}};
  EXPECT_THAT(error(), HasSubstr("its own ancestor"));
}

TEST_F(GltfNode, scene_root_below_another_stands_in_its_place_once) {
  document["nodes"] = {{{"children", {1}}, {"translation", {5, 0, 0}}}, {{"mesh", 0}}};
  document["scenes"][0]["nodes"] = {1, 0};
  const Scene scene = load();
  EXPECT_EQ(scene.instances.size(), 1u);
  expect_near(placed(scene, {0, 0, 0}), {5, 0, 0});
  EXPECT_THAT(notes_text(), HasSubstr("node 1, a child of node 0"));
}

TEST_F(GltfNode, scene_root_whose_parent_is_in_no_scene_stands_alone) {
  document["nodes"] = {{{"children", {1}}, {"translation", {5, 0, 0}}}, {{"mesh", 0}}};
  document["scenes"][0]["nodes"] = {1};
  expect_near(placed(load(), {0, 0, 0}), {0, 0, 0});
  EXPECT_THAT(notes_text(), HasSubstr("it stands without its parent"));
}

TEST_F(GltfNode, file_without_scenes_shows_all_its_nodes) {
  document.erase("scene");
  document.erase("scenes");
  document["nodes"] = {{{"children", {1}}}, {{"mesh", 0}}};
  EXPECT_EQ(load().instances.size(), 1u);
}

TEST_F(GltfNode, scene_is_chosen_by_name_or_by_the_file) {
  document["scenes"] = {{{"name", "empty"}}, {{"name", "full"}, {"nodes", {0}}}};
  document["scene"] = 1;
  EXPECT_EQ(load().name, "full");
  Notes ignored;
  const auto file = folder / "scene.gltf";
  EXPECT_THAT(load_gltf(file, Catalogue::standard(), {"empty"}, ignored).instances, IsEmpty());
  try {
    load_gltf(file, Catalogue::standard(), {"none"}, ignored);
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(error.detail().kind, ErrorKind::Usage);
    EXPECT_THAT(error.detail().choices, testing::ElementsAre("empty", "full"));
  }
}

TEST_F(GltfNode, cameras_are_read_in_scene_order_without_their_nodes_scale) {
  document["cameras"] = {
      {{"type", "orthographic"},
       {"orthographic", {{"xmag", 4}, {"ymag", 2}, {"znear", 0.1}, {"zfar", 9}}}},
      {{"type", "perspective"},
       {"name", "main"},
       {"perspective", {{"yfov", 0.5}, {"znear", 0.1}}}}};
  document["nodes"] = {{{"camera", 1}, {"translation", {1, 2, 3}}, {"scale", {5, 5, 5}}},
                       {{"camera", 0}, {"name", "side"}}};
  document["scenes"][0]["nodes"] = {1, 0};
  const Scene scene = load();
  ASSERT_EQ(scene.cameras.size(), 2u);
  EXPECT_EQ(scene.cameras[0].name, "side");
  EXPECT_EQ(scene.cameras[0].aspect_ratio, 2.0);
  EXPECT_EQ(std::get<OrthographicCamera>(scene.cameras[0].projection).ymag, 2.0);
  EXPECT_EQ(scene.cameras[1].name, "main");
  EXPECT_EQ(std::get<PerspectiveCamera>(scene.cameras[1].projection).yfov_rad, 0.5);
  EXPECT_EQ(scene.cameras[1].to_world[0], Vec4d(1, 0, 0, 0));
  EXPECT_EQ(scene.cameras[1].to_world[3], Vec4d(1, 2, 3, 1));
}

TEST_F(GltfNode, cameras_that_cannot_see_are_errors) {
  node()["camera"] = 0;
  for (const Json& camera :
       {Json{{"type", "perspective"}, {"perspective", {{"yfov", 0}}}},
        Json{{"type", "perspective"}, {"perspective", {{"yfov", 3.15}}}},
        Json{{"type", "orthographic"}, {"orthographic", {{"xmag", 0}, {"ymag", 1}}}},
        Json{{"type", "fisheye"}}, Json{{"type", "perspective"}}}) {
    document["cameras"] = Json::array({camera});
    EXPECT_THAT(error(), HasSubstr("/cameras/0")) << camera;
  }
}

TEST_F(GltfNode, lights_have_the_defaults_of_the_extension) {
  document["extensions"]["KHR_lights_punctual"]["lights"] = {
      {{"type", "point"}}, {{"type", "spot"}, {"spot", Json::object()}}};
  document["nodes"] = {{{"extensions", {{"KHR_lights_punctual", {{"light", 0}}}}}},
                       {{"extensions", {{"KHR_lights_punctual", {{"light", 1}}}}}}};
  document["scenes"][0]["nodes"] = {0, 1};
  const Scene scene = load();
  ASSERT_EQ(scene.lights.size(), 2u);
  EXPECT_EQ(scene.lights[0].intensity, 1.0);
  EXPECT_EQ(scene.lights[0].color_rec709, Vec3d(1.0));
  EXPECT_TRUE(std::isinf(scene.lights[0].range_m));
  EXPECT_EQ(scene.lights[1].inner_cone_rad, 0.0);
  EXPECT_DOUBLE_EQ(scene.lights[1].outer_cone_rad, std::atan(1.0));
}

TEST_F(GltfNode, light_turned_and_scaled_keeps_a_rigid_placement) {
  document["extensions"]["KHR_lights_punctual"]["lights"] = {
      {{"type", "directional"}, {"intensity", 3}, {"color", {1, 0.5, 0}}}};
  const double h = std::sqrt(0.5);
  node() = {{"rotation", {-h, 0, 0, h}},  // −90° about x: −Z becomes −Y.
            {"scale", {1, 2, -7}},
            {"extensions", {{"KHR_lights_punctual", {{"light", 0}}}}}};
  const Scene scene = load();
  const Mat4d& to_world = scene.lights.at(0).to_world;
  EXPECT_NEAR(glm::determinant(to_world), 1.0, 1e-12);  // A few roundings.
  // A mirrored axis turns the light round, as it turns the node's own −Z.
  expect_near(Vec3d(to_world * Vec4d(0, 0, -1, 0)), {0, 1, 0});
}

TEST_F(GltfNode, lights_that_mean_nothing_are_errors) {
  node()["extensions"]["KHR_lights_punctual"]["light"] = 0;
  for (const Json& light :
       {Json{{"type", "area"}}, Json{{"type", "point"}, {"intensity", -1}},
        Json{{"type", "point"}, {"range", -1}}, Json{{"intensity", 1}},
        Json{{"type", "spot"}, {"spot", {{"innerConeAngle", 1}, {"outerConeAngle", 0.5}}}}}) {
    document["extensions"]["KHR_lights_punctual"]["lights"] = Json::array({light});
    EXPECT_THAT(error(), HasSubstr("/extensions/KHR_lights_punctual/lights/0")) << light;
  }
}

class GltfInstancing : public GltfNode {
 protected:
  Json& attributes() { return node()["extensions"]["EXT_mesh_gpu_instancing"]["attributes"]; }
};

TEST_F(GltfInstancing, mesh_stands_at_every_place_and_is_shared) {
  const auto h = static_cast<float>(std::sqrt(0.5));
  attributes() = {{"TRANSLATION", add_accessor(std::vector<float>{1, 0, 0, 0, 5, 0}, "VEC3")},
                  {"ROTATION", add_accessor(std::vector<float>{0, 0, 0, 1, 0, 0, h, h}, "VEC4")},
                  {"SCALE", add_accessor(std::vector<float>{1, 1, 1, 2, 1, 1}, "VEC3")},
                  {"_ID", add_accessor(std::vector<float>{7, 8}, "SCALAR")}};
  node()["translation"] = {100, 0, 0};
  document["extensionsRequired"] = {"EXT_mesh_gpu_instancing"};
  const Scene scene = load();
  ASSERT_EQ(scene.instances.size(), 2u);
  EXPECT_EQ(scene.meshes.size(), 1u);
  const auto corner = [&](std::size_t i) {
    return Vec3d(scene.instances[i].to_world * Vec4d(1, 0, 0, 1));
  };
  expect_near(corner(0), {102, 0, 0});
  EXPECT_LT(glm::length(corner(1) - Vec3d(100, 7, 0)), 1e-6);  // Quaternions of single precision.
  EXPECT_EQ(scene.instances[1].name, "node 0 [1]");
}

TEST_F(GltfInstancing, attributes_of_several_lengths_are_an_error) {
  attributes() = {{"SCALE", add_accessor(std::vector<float>{1, 1, 1}, "VEC3")},
                  {"TRANSLATION", add_accessor(std::vector<float>{1, 0, 0, 0, 5, 0}, "VEC3")}};
  EXPECT_THAT(error(), HasSubstr("attributes/TRANSLATION: found 2 elements"));
}

TEST_F(GltfInstancing, no_place_is_a_fault) {
  attributes() = Json::object();
  EXPECT_THAT(error(), HasSubstr("attributes: found no place"));
}

TEST_F(GltfNode, hidden_node_and_all_below_it_are_left_out_but_for_cameras) {
  document["extensions"]["KHR_lights_punctual"]["lights"] = {{{"type", "point"}}};
  document["cameras"] = {{{"type", "perspective"}, {"perspective", {{"yfov", 1}}}}};
  const Json hidden = {{"KHR_node_visibility", {{"visible", false}}}};
  const Json shown = {{"KHR_node_visibility", {{"visible", true}}},
                      {"KHR_lights_punctual", {{"light", 0}}}};
  document["nodes"] = {{{"mesh", 0}},
                       {{"mesh", 0}, {"children", {2}}, {"extensions", hidden}},
                       {{"mesh", 0}, {"camera", 0}, {"extensions", shown}}};
  document["scenes"][0]["nodes"] = {0, 1};
  const Scene scene = load();
  EXPECT_EQ(scene.instances.size(), 1u);
  EXPECT_EQ(scene.lights.size(), 0u);
  EXPECT_EQ(scene.cameras.size(), 1u);
  EXPECT_THAT(notes_text(), HasSubstr("2 nodes are hidden by KHR_node_visibility"));
  document["nodes"][1]["extensions"]["KHR_node_visibility"]["visible"] = "no";
  EXPECT_THAT(error(), HasSubstr("/nodes/1/extensions/KHR_node_visibility/visible"));
}

}  // namespace
}  // namespace abbe
