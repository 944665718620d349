// Animations, morph targets and skins against numbers worked out by hand.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "load/gltf_builder.h"

namespace abbe {
namespace {

using testing::HasSubstr;

using Floats = std::vector<float>;

constexpr double kDegree = std::numbers::pi / 180.0;

class GltfMotion : public GltfTest {
 protected:
  /// With the buffer as it is now.
  Scene load() {
    document.erase("buffers");
    return GltfTest::load();
  }
  Scene load_at(double time_s, const std::string& animation = "", bool strict = false) {
    load();
    LoadOptions options;
    options.time_s = time_s;
    options.animation = animation;
    options.strict = strict;
    notes = Notes();
    return load_gltf(folder / "scene.gltf", Catalogue::standard(), options, notes);
  }

  /// A vertex of the scene's first instance in the world, once loaded.
  static Vec3d vertex(const Scene& scene, std::size_t number, std::size_t instance = 0) {
    const Instance& placed = scene.instances.at(instance);
    const Mesh& mesh = scene.meshes.at(std::get<std::uint32_t>(placed.what));
    return Vec3d(placed.to_world * Vec4d(Vec3d(mesh.positions.at(number)), 1.0));
  }
  static Vec3d origin(const Scene& scene) { return Vec3d(scene.instances.at(0).to_world[3]); }

  /// Adds an animation of one property of a node.
  template <typename T>
  void animate(int node, const std::string& path, const Floats& times_s,
               const std::vector<T>& values, const std::string& type,
               const std::string& interpolation, const std::string& name = "") {
    const std::size_t input = add_accessor(times_s, "SCALAR");
    document["accessors"][input]["min"] = {times_s.front()};
    document["accessors"][input]["max"] = {times_s.back()};
    const std::size_t output = add_accessor(values, type, !std::is_same_v<T, float>);
    Json animation = {
        {"samplers", {{{"input", input}, {"output", output}, {"interpolation", interpolation}}}},
        {"channels", {{{"sampler", 0}, {"target", {{"node", node}, {"path", path}}}}}}};
    if (!name.empty()) animation["name"] = name;
    document["animations"].push_back(animation);
  }

  /// Morph targets of the triangle: positions of each.
  void add_targets(const std::vector<Floats>& targets) {
    for (const Floats& target : targets) {
      primitive()["targets"].push_back({{"POSITION", add_accessor(target, "VEC3")}});
    }
  }

  /// A skin of the triangle: joints as nodes from 1 on, each below the one before.
  void add_joints(const std::vector<Json>& joints, const Floats& inverse_binds = {}) {
    document["skins"] = {{{"joints", Json::array()}}};
    for (std::size_t i = 0; i < joints.size(); ++i) {
      document["nodes"].push_back(joints[i]);
      document["skins"][0]["joints"].push_back(i + 1);
      if (i > 0) document["nodes"][i]["children"] = {i + 1};
    }
    document["scenes"][0]["nodes"] = {0, 1};
    node()["skin"] = 0;
    if (inverse_binds.empty()) return;
    const std::size_t view = add_view(inverse_binds);
    document["accessors"].push_back({{"bufferView", view},
                                     {"componentType", 5126},
                                     {"count", inverse_binds.size() / 16},
                                     {"type", "MAT4"}});
    document["skins"][0]["inverseBindMatrices"] = document["accessors"].size() - 1;
  }
  void bind(const std::vector<std::uint8_t>& joints, const Floats& weights) {
    primitive()["attributes"]["JOINTS_0"] = add_accessor(joints, "VEC4");
    primitive()["attributes"]["WEIGHTS_0"] = add_accessor(weights, "VEC4");
  }
  void set_attribute(const std::string& name, const Floats& values, const std::string& type) {
    primitive()["attributes"][name] = add_accessor(values, type);
  }
};

// A few roundings of single precision at a size of 1.
constexpr double kRounding = 3e-7;

void expect_near(const Vec3d& a, const Vec3d& b, double tolerance = kRounding) {
  EXPECT_LT(glm::length(a - b), tolerance) << a.x << " " << a.y << " " << a.z;
}

const Floats kAllOnFirst{1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0};
const std::vector<std::uint8_t> kFirst(12, 0);

TEST_F(GltfMotion, cubic_spline_is_hermites_with_tangents_per_second) {
  const Floats values{9, 9, 9, 0, 0, 0, 1, 0, -1, -0.5, 2, 0, 4, 1, 0, 9, 9, 9};
  animate(0, "translation", {1, 3}, values, "VEC3", "CUBICSPLINE");
  // At a quarter: 27/32, 5/32, 2 s · 9/64, −2 s · 3/64; in the middle: 1/2, 1/2, 2 s/8, −2 s/8.
  expect_near(origin(load_at(1.5)), {0.953125, -0.03125, -0.28125});
  expect_near(origin(load_at(2.0)), {2.375, 0.0, -0.25});
  expect_near(origin(load_at(1.0)), {0, 0, 0});
  expect_near(origin(load_at(3.0)), {4, 1, 0});
}

TEST_F(GltfMotion, property_stays_before_its_first_key_and_after_its_last) {
  animate(0, "translation", {1, 2}, Floats{1, 0, 0, 5, 0, 0}, "VEC3", "LINEAR");
  expect_near(origin(load_at(-7)), {1, 0, 0});
  expect_near(origin(load_at(1.25)), {2, 0, 0});
  expect_near(origin(load_at(1e6)), {5, 0, 0});
  expect_near(origin(load()), {0, 0, 0});
}

TEST_F(GltfMotion, step_holds_until_the_next_key) {
  animate(0, "scale", {0, 1}, Floats{1, 1, 1, 3, 1, 1}, "VEC3", "STEP");
  expect_near(vertex(load_at(0.999), 1), {1, 0, 0});
  expect_near(vertex(load_at(1.0), 1), {3, 0, 0});
}

TEST_F(GltfMotion, rotation_turns_at_an_even_rate_the_shorter_way) {
  const auto half = [](double degrees) { return 0.5 * degrees * kDegree; };
  const auto z = static_cast<float>(std::sin(half(170))),
             w = static_cast<float>(std::cos(half(170)));
  for (const float sign : {1.0f, -1.0f}) {
    document.erase("animations");
    // Of length 2: rotations are normalised first.
    animate(0, "rotation", {0, 1}, Floats{0, 0, 0, 2, 0, 0, sign * z, sign * w}, "VEC4", "LINEAR");
    const double angle = 0.25 * 170 * kDegree;
    expect_near(vertex(load_at(0.25), 1), {std::cos(angle), std::sin(angle), 0});
  }
}

TEST_F(GltfMotion, rotation_along_a_spline_is_normalised) {
  const float h = std::sqrt(0.5f);
  const Floats values{0, 0, 0, 0, 0, 0, 0, 1, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, h, h, 0, 0, 0, 0};
  animate(0, "rotation", {0, 1}, values, "VEC4", "CUBICSPLINE");
  // Tangents of 0: in the middle the mean of both, of 45°.
  expect_near(vertex(load_at(0.5), 1), {std::sqrt(0.5), std::sqrt(0.5), 0});
}

TEST_F(GltfMotion, normalized_integers_are_shares_of_their_largest) {
  animate(0, "rotation", {0}, std::vector<std::int16_t>{0, 0, 23170, 23170}, "VEC4", "LINEAR");
  expect_near(vertex(load_at(0), 1), {0, 1, 0});  // Equal codes are 45° and 45° exactly.
  document.erase("animations");
  add_targets({{0, 0, 1, 0, 0, 0, 0, 0, 0}});
  animate(0, "weights", {0, 1}, std::vector<std::uint8_t>{0, 255}, "SCALAR", "LINEAR");
  expect_near(vertex(load_at(0.25), 0), {0, 0, 0.25});
}

TEST_F(GltfMotion, children_cameras_and_lights_move_along) {
  document["cameras"] = {{{"type", "perspective"}, {"perspective", {{"yfov", 1}, {"znear", 1}}}}};
  document["nodes"] = {{{"children", {1}}},
                       {{"mesh", 0}, {"camera", 0}, {"translation", {0, 1, 0}}}};
  animate(0, "translation", {0, 2}, Floats{0, 0, 0, 6, 0, 0}, "VEC3", "LINEAR");
  const Scene scene = load_at(1);
  expect_near(origin(scene), {3, 1, 0});
  expect_near(Vec3d(scene.cameras.at(0).to_world[3]), {3, 1, 0});
}

TEST_F(GltfMotion, animations_are_listed_and_one_is_chosen) {
  animate(0, "translation", {0, 2}, Floats{0, 0, 0, 6, 0, 0}, "VEC3", "LINEAR", "right");
  animate(0, "translation", {0, 3}, Floats{0, 0, 0, 0, 3, 0}, "VEC3", "LINEAR", "up");
  animate(0, "scale", {0}, Floats{2, 2, 2}, "VEC3", "LINEAR");
  const Scene scene = load_at(1);
  ASSERT_EQ(scene.animations.size(), 3u);
  EXPECT_EQ(scene.animations[1].name, "up");
  EXPECT_EQ(scene.animations[1].length_s, 3.0);
  EXPECT_EQ(scene.animations[2].name, "animation 2");
  // All at once, but of two that move the same only the first.
  expect_near(vertex(scene, 1), {5, 0, 0});
  EXPECT_THAT(notes_text(), HasSubstr("\"up\" moves what an animation before it moves"));
  expect_near(vertex(load_at(1, "up"), 1), {1, 1, 0});
  expect_near(vertex(load_at(1, "2"), 1), {2, 0, 0});
  EXPECT_EQ(notes_text(), "");
  try {
    load_at(1, "down");
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(error.detail().kind, ErrorKind::Usage);
    EXPECT_THAT(error.detail().choices, testing::ElementsAre("right", "up", "animation 2"));
  }
}

TEST_F(GltfMotion, animation_that_breaks_a_rule_moves_nothing_and_says_so) {
  animate(0, "translation", {2, 1}, Floats{1, 0, 0, 5, 0, 0}, "VEC3", "LINEAR");
  expect_near(origin(load_at(1)), {0, 0, 0});
  EXPECT_THAT(notes_text(), HasSubstr("/animations/0/samplers/0/input: times that fall"));
  EXPECT_THROW(load_at(1, "", true), Error);
  document.erase("animations");
  animate(0, "translation", {1, 2}, Floats{1, 0, 0, 5, 0, 0}, "VEC3", "CUBICSPLINE");
  load_at(1);
  EXPECT_THAT(notes_text(), HasSubstr("6 numbers, expected 18 for 2 keys with their tangents"));
  document.erase("animations");
  animate(0, "translation", {1}, Floats{1, 0, std::nanf("")}, "VEC3", "LINEAR");
  expect_near(origin(load_at(1)), {0, 0, 0});
  EXPECT_THAT(notes_text(), HasSubstr("a value that is not finite"));
  document.erase("animations");
  node()["matrix"] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 5, 6, 7, 1};
  animate(0, "translation", {1}, Floats{1, 0, 0}, "VEC3", "LINEAR");
  expect_near(origin(load_at(1)), {5, 6, 7});
  EXPECT_THAT(notes_text(), HasSubstr("node 0, which has a matrix"));
}

TEST_F(GltfMotion, channel_without_its_sampler_is_an_error) {
  animate(0, "translation", {1}, Floats{1, 0, 0}, "VEC3", "LINEAR");
  document["animations"][0]["channels"][0]["sampler"] = 1;
  EXPECT_THAT(error(), HasSubstr("/animations/0/channels/0/sampler: found 1"));
}

TEST_F(GltfMotion, channel_that_moves_no_node_is_skipped_and_keeps_its_number) {
  animate(0, "translation", {1}, Floats{1, 0, 0}, "VEC3", "LINEAR");
  const Json other = {{"sampler", 0}, {"target", {{"path", "pointer"}}}};
  Json& channels = document["animations"][0]["channels"];
  channels.insert(channels.begin(), other);
  expect_near(origin(load_at(1)), {1, 0, 0});
  channels[1]["sampler"] = 1;
  EXPECT_THAT(error(), HasSubstr("/animations/0/channels/1/sampler: found 1"));
}

TEST_F(GltfMotion, channel_of_a_pointer_is_told_of_whether_its_extension_is_named_or_not) {
  animate(0, "translation", {1}, Floats{1, 0, 0}, "VEC3", "LINEAR");
  const Json pointer = {{"sampler", 0}, {"target", {{"path", "pointer"}}}};
  document["animations"][0]["channels"].push_back(pointer);
  document["animations"][0]["channels"].push_back(pointer);
  const auto count = [&] {
    load();
    const std::string text = notes_text(),
                      line = "extension KHR_animation_pointer is not supported";
    std::size_t found = 0;
    for (std::size_t i = text.find(line); i != std::string::npos; i = text.find(line, i + 1))
      ++found;
    return found;
  };
  EXPECT_EQ(count(), 1u);
  document["extensionsUsed"] = {"KHR_animation_pointer"};
  EXPECT_EQ(count(), 1u);
}

TEST_F(GltfMotion, morph_targets_add_their_share_at_rest) {
  add_targets({{0, 0, 2, 0, 0, 0, 0, 0, 0}, {0, 0, 0, 1, 0, 0, 0, 0, 0}});
  document["meshes"][0]["weights"] = {0.5, 0};
  Scene scene = load();
  expect_near(vertex(scene, 0), {0, 0, 1});
  expect_near(vertex(scene, 1), {1, 0, 0});
  EXPECT_EQ(scene.meshes[0].morph_targets, 2u);
  // A node's own weights come first.
  node()["weights"] = {0.25, -1};
  scene = load();
  expect_near(vertex(scene, 0), {0, 0, 0.5});
  expect_near(vertex(scene, 1), {0, 0, 0});
}

TEST_F(GltfMotion, morph_targets_move_normals_tangents_coordinates_and_colours) {
  set_attribute("NORMAL", {0, 0, 1, 0, 0, 1, 0, 0, 1}, "VEC3");
  set_attribute("TANGENT", {1, 0, 0, -1, 1, 0, 0, -1, 1, 0, 0, -1}, "VEC4");
  set_attribute("TEXCOORD_0", {0, 0, 1, 0, 0, 1}, "VEC2");
  set_attribute("COLOR_0", {0.5, 0.5, 0.5, 0.5, 0.5, 0.5, 0.5, 0.5, 0.5}, "VEC3");
  const auto with_first = [](Floats first, std::size_t size) {
    first.resize(size, 0.0f);
    return first;
  };
  primitive()["targets"] = {{{"NORMAL", add_accessor(with_first({2, 0, -2}, 9), "VEC3")},
                             {"TANGENT", add_accessor(with_first({-2, 2, 0}, 9), "VEC3")},
                             {"TEXCOORD_0", add_accessor(with_first({4, -4}, 6), "VEC2")},
                             {"COLOR_0", add_accessor(with_first({0.5, -2, 0}, 9), "VEC3")}}};
  document["meshes"][0]["weights"] = {0.5};
  const Mesh mesh = load().meshes.at(0);
  expect_near(Vec3d(mesh.normals[0]), {1, 0, 0});
  expect_near(Vec3d(mesh.tangents[0]), {0, 1, 0});
  EXPECT_EQ(mesh.tangents[0].w, -1.0f);
  EXPECT_EQ(mesh.uv[0][0], Vec2f(2, -2));
  EXPECT_EQ(mesh.colors_rec709[0], Vec4f(0.75, 0, 0.5, 1));  // Limited, without a word.
  expect_near(Vec3d(mesh.normals[1]), {0, 0, 1});
  EXPECT_EQ(notes_text(), "");
}

TEST_F(GltfMotion, morphed_meshes_are_shared_where_weights_are_the_same) {
  add_targets({{0, 0, 2, 0, 0, 0, 0, 0, 0}});
  document["nodes"] = {{{"mesh", 0}},
                       {{"mesh", 0}, {"weights", {0}}},
                       {{"mesh", 0}, {"weights", {1}}},
                       {{"mesh", 0}, {"weights", {1}}}};
  document["scenes"][0]["nodes"] = {0, 1, 2, 3};
  const Scene scene = load();
  EXPECT_EQ(scene.meshes.size(), 2u);
  const auto mesh_of = [&](std::size_t i) {
    return std::get<std::uint32_t>(scene.instances.at(i).what);
  };
  EXPECT_EQ(mesh_of(0), mesh_of(1));
  EXPECT_EQ(mesh_of(2), mesh_of(3));
}

TEST_F(GltfMotion, weights_of_another_number_are_a_fault) {
  add_targets({{0, 0, 2, 0, 0, 0, 0, 0, 0}});
  document["meshes"][0]["weights"] = {1, 1};
  expect_near(vertex(load(), 0), {0, 0, 2});
  EXPECT_THAT(notes_text(), HasSubstr("/meshes/0/weights: 2 weights, expected one for each of 1"));
}

TEST_F(GltfMotion, arm_of_two_bones_bends_by_90_degrees) {
  // The elbow at x = 1, half of each bone; the hand at x = 2 and the shoulder.
  set_attribute("POSITION", {0, 0, 0, 1, 0.5, 0, 2, 0, 0}, "VEC3");
  set_attribute("NORMAL", {0, 1, 0, 0, 0, 1, 0, 1, 0}, "VEC3");
  const double h = std::sqrt(0.5);
  const Floats binds{1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0,  0, 0, 1,
                     1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, -1, 0, 0, 1};
  add_joints({Json::object(), {{"translation", {1, 0, 0}}, {"rotation", {0, 0, h, h}}}}, binds);
  bind({0, 0, 0, 0, 0, 1, 0, 0, 1, 0, 0, 0}, {1, 0, 0, 0, 0.5, 0.5, 0, 0, 1, 0, 0, 0});
  node()["translation"] = {100, 200, 300};  // Ignored: joints say where.
  const Scene scene = load();
  expect_near(vertex(scene, 0), {0, 0, 0});
  expect_near(vertex(scene, 1), {0.75, 0.25, 0});  // (1, 0.5) and (0.5, 0).
  expect_near(vertex(scene, 2), {1, 1, 0});
  expect_near(Vec3d(scene.meshes[0].normals[2]), {-1, 0, 0});
  expect_near(Vec3d(scene.meshes[0].normals[1]), {0, 0, 1});
  EXPECT_EQ(scene.meshes[0].joints, 2u);
  EXPECT_EQ(notes_text(), "");
  // The shoulder turns back by 90°: all but the fore arm.
  animate(1, "rotation", {0}, Floats{0, 0, static_cast<float>(-h), static_cast<float>(h)}, "VEC4",
          "LINEAR");
  expect_near(vertex(load_at(0), 2), {1, -1, 0});
}

TEST_F(GltfMotion, skin_and_morph_targets_work_together) {
  add_targets({{0, 0, 2, 0, 0, 0, 0, 0, 0}});
  document["meshes"][0]["weights"] = {0.5};
  add_joints({{{"scale", {1, 1, 3}}, {"translation", {0, 0, 1}}}});
  bind(kFirst, kAllOnFirst);
  expect_near(vertex(load(), 0), {0, 0, 4});
}

TEST_F(GltfMotion, normals_of_a_stretched_joint_stay_normal) {
  set_attribute("NORMAL", {1, 0, 1, 0, 0, 1, 0, 0, 1}, "VEC3");
  add_joints({{{"scale", {1, 1, 2}}}});
  bind(kFirst, kAllOnFirst);
  // The plane x + z = c becomes x + z/2 = c.
  expect_near(Vec3d(load().meshes[0].normals[0]), glm::normalize(Vec3d(1, 0, 0.5)));
}

TEST_F(GltfMotion, mirrored_joint_keeps_fronts_in_front) {
  set_attribute("NORMAL", {0, 0, 1, 0, 0, 1, 0, 0, 1}, "VEC3");
  set_attribute("TANGENT", {1, 0, 0, 1, 1, 0, 0, 1, 1, 0, 0, 1}, "VEC4");
  add_joints({{{"scale", {-1, 1, 1}}}});
  bind(kFirst, kAllOnFirst);
  const Mesh mesh = load().meshes.at(0);
  const auto [a, b, c] = mesh.triangles.at(0);
  const Vec3d front = glm::cross(Vec3d(mesh.positions[b] - mesh.positions[a]),
                                 Vec3d(mesh.positions[c] - mesh.positions[a]));
  expect_near(front, {0, 0, 1});
  expect_near(Vec3d(mesh.normals[0]), {0, 0, 1});
  EXPECT_EQ(mesh.tangents[0], Vec4f(-1, 0, 0, -1));
}

TEST_F(GltfMotion, second_set_of_joints_counts) {
  add_joints({{{"translation", {0, 0, 1}}},
              {{"translation", {0, 0, 1}}},
              {{"translation", {0, 0, 1}}},
              {{"translation", {0, 0, 1}}},
              {{"translation", {0, 0, 1}}}});
  const float w = 0.2f;
  bind({0, 1, 2, 3, 0, 1, 2, 3, 0, 1, 2, 3}, {w, w, w, w, w, w, w, w, w, w, w, w});
  primitive()["attributes"]["JOINTS_1"] =
      add_accessor(std::vector<std::uint16_t>{4, 0, 0, 0, 4, 0, 0, 0, 4, 0, 0, 0}, "VEC4");
  set_attribute("WEIGHTS_1", {w, 0, 0, 0, w, 0, 0, 0, w, 0, 0, 0}, "VEC4");
  // The mean of 1 to 5.
  expect_near(vertex(load(), 1), {1, 0, 3}, 1e-6);  // A few roundings at 5.
  EXPECT_EQ(notes_text(), "");
}

TEST_F(GltfMotion, weights_that_do_not_add_up_to_1_are_made_to) {
  add_joints({{{"translation", {0, 0, 1}}}, {{"translation", {0, 0, 2}}}});
  bind({0, 1, 0, 0, 1, 0, 0, 0, 0, 0, 0, 0}, {1, 1, 0, 0, 0, 0, 0, 0, 1, 0, 0, 0});
  const Scene scene = load();
  expect_near(vertex(scene, 0), {0, 0, 2});
  expect_near(vertex(scene, 1), {1, 0, 3});  // Of no weight: the first joint's.
  EXPECT_THAT(notes_text(), HasSubstr("2 vertices whose weights do not add up to 1"));
  EXPECT_THROW(load_at(0, "", true), Error);
}

TEST_F(GltfMotion, joint_that_is_not_there_is_an_error_where_it_has_a_weight) {
  add_joints({{{"translation", {0, 0, 1}}}});
  bind({0, 9, 0, 0, 0, 9, 0, 0, 0, 9, 0, 0}, kAllOnFirst);
  expect_near(vertex(load(), 1), {1, 0, 1});
  set_attribute("WEIGHTS_0", {1, 0, 0, 0, 0.5, 0.5, 0, 0, 1, 0, 0, 0}, "VEC4");
  document.erase("buffers");
  EXPECT_THAT(error(), HasSubstr("/attributes/JOINTS_0: found joint 9 at place 1"));
}

TEST_F(GltfMotion, skin_without_joints_in_the_mesh_is_a_fault) {
  add_joints({{{"translation", {0, 0, 1}}}});
  node()["translation"] = {5, 0, 0};
  expect_near(vertex(load(), 0), {5, 0, 0});
  EXPECT_THAT(notes_text(), HasSubstr("/nodes/0/skin: a skin for a mesh without JOINTS_0"));
}

TEST_F(GltfMotion, too_few_bind_matrices_are_an_error) {
  add_joints({Json::object(), Json::object()}, {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1});
  bind(kFirst, kAllOnFirst);
  EXPECT_THAT(error(), HasSubstr("/skins/0/inverseBindMatrices: found 1 matrices"));
}

TEST_F(GltfMotion, skinned_mesh_far_away_keeps_its_shape) {
  add_joints({{{"translation", {4e7, 0, 0}}}});
  bind(kFirst, kAllOnFirst);
  const Scene scene = load();
  expect_near(vertex(scene, 1) - vertex(scene, 0), {1, 0, 0});
  EXPECT_EQ(vertex(scene, 0).x, 4e7);
}

}  // namespace
}  // namespace abbe
