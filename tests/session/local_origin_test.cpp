// A scene far from the origin of its numbers looks as it does there, and speaks of its places as
// its author does.

#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>

#include "abbe/scene/local_origin.h"
#include "abbe/session/prepare.h"
#include "support/scene_builder.h"

namespace abbe {
namespace {

const Vec3d kFar_m(1e6, -2e6, 3e6);

std::filesystem::path scene_file(const std::string& name) {
  return std::filesystem::path(ABBE_SOURCE_DIR) / "scenes" / name / (name + ".gltf");
}

/// A copy of a scene's folder, in which all of it is below one more node that moves it.
class MovedFile {
 public:
  MovedFile(const std::filesystem::path& source, const Vec3d& by)
      : folder_(std::filesystem::temp_directory_path() /
                (source.stem().string() + "-moved-" + std::to_string(getpid()))),
        file_(folder_ / source.filename()) {
    std::filesystem::copy(source.parent_path(), folder_,
                          std::filesystem::copy_options::recursive |
                              std::filesystem::copy_options::overwrite_existing);
    nlohmann::json document = nlohmann::json::parse(std::ifstream(source));
    nlohmann::json& scene = document["scenes"][document.value("scene", 0)];
    document["nodes"].push_back(
        {{"translation", {by.x, by.y, by.z}}, {"children", scene["nodes"]}});
    scene["nodes"] = {document["nodes"].size() - 1};
    std::ofstream(file_) << document;
  }
  MovedFile(const MovedFile&) = delete;
  MovedFile& operator=(const MovedFile&) = delete;
  ~MovedFile() { std::filesystem::remove_all(folder_); }

  const std::filesystem::path& path() const { return file_; }

 private:
  std::filesystem::path folder_, file_;
};

PreparedScene prepared(const std::filesystem::path& file) {
  Notes notes;
  return prepare_scene({.file = file}, test::catalogue(), notes);
}

Image picture_of(const PreparedScene& scene, const RenderSettings& settings) {
  const LitWorld world = test::make_world(scene.scene, settings);
  return test::render(world, scene.chosen_camera(), settings).image;
}

class FarScene : public testing::TestWithParam<const char*> {};

TEST_P(FarScene, looks_as_it_does_at_the_origin) {
  RenderSettings settings = test::small_settings();
  // Roundings decide which of the faintest paths over many reflections are kept.
  settings.inner_reflections = 1;
  settings.size = {48, 27};
  settings.samples_per_pixel = 2;
  const PreparedScene near = prepared(scene_file(GetParam()));
  const MovedFile moved(scene_file(GetParam()), kFar_m);
  const PreparedScene far = prepared(moved.path());
  // Its places are told as the file has them: to a last digit of 3e6 in double precision.
  EXPECT_EQ(near.scene.origin_m, Vec3d(0.0));
  const Vec3d by = kFar_m + near.scene.origin_m - far.scene.origin_m;
  EXPECT_LT(glm::distance(far.bounds.low, near.bounds.low + by), 2e-9);
  for (std::size_t i = 0; i < near.scene.instances.size(); ++i) {
    const Vec3d place(near.scene.instances[i].to_world[3]);
    EXPECT_LT(glm::distance(Vec3d(far.scene.instances[i].to_world[3]), place + by), 2e-9);
  }
  const Image a = picture_of(near, settings);
  const Image b = picture_of(far, settings);
  ASSERT_EQ(a.channels.size(), b.channels.size());
  // Nodes are half a nanometre off at 3e6 m, and the grid of numbers has moved: a tenth of a micron
  // at a metre, as at the origin. That turns a ray at an edge to its other side now and then, and
  // in a gem with them all that follow: of 1296 pixels at most a hundredth.
  int different = 0;
  double sum_a = 0.0, sum_b = 0.0;
  for (int y = 0; y < a.height; ++y) {
    for (int x = 0; x < a.width; ++x) {
      sum_a += static_cast<double>(test::pixel(a, x, y, "G"));
      sum_b += static_cast<double>(test::pixel(b, x, y, "G"));
    }
  }
  const double mean = sum_a / (a.width * a.height);
  for (int y = 0; y < a.height; ++y) {
    for (int x = 0; x < a.width; ++x) {
      const auto va = static_cast<double>(test::pixel(a, x, y, "G"));
      const auto vb = static_cast<double>(test::pixel(b, x, y, "G"));
      different += std::abs(va - vb) > 1e-3 * (std::abs(va) + mean) ? 1 : 0;
    }
  }
  RecordProperty("different", different);
  EXPECT_LE(different, 12);
  EXPECT_NEAR(sum_b, sum_a, 1e-4 * sum_a);
}

INSTANTIATE_TEST_SUITE_P(scenes, FarScene,
                         testing::Values("chart", "coloured-glass", "diamond", "metals", "metamers",
                                         "minimum-deviation", "newton", "newton-two", "prism",
                                         "soap", "whitted"),
                         [](const auto& test) {
                           std::string name = test.param;
                           std::replace(name.begin(), name.end(), '-', '_');
                           return name;
                         });

// 8 times the least of what is seen, about 8 m here, along each axis.
constexpr double kReach_m = 110.0;

// A glass box and a ball before a wall, all of whose places are whole 64ths.
Scene round_scene() {
  Scene scene;
  test::add_box_mesh(scene, test::add(scene, test::glass(1.5)), Vec3d(0.5),
                     test::translation({0.25, 0.5, 0}) * test::rotation({0, 1, 0}, 30.0));
  test::add_sphere(scene, test::add(scene, test::mirror("metal/Ag-Johnson")), {-1, 0.75, 0.5}, 0.5);
  test::add_square(scene, test::add(scene, test::matte(Vec3f(0.5f))), 4.0,
                   test::translation({0, 0, -2}));
  scene.lights.push_back(test::point_light({1, 3, 2.5}, 100.0));
  scene.cameras.push_back(test::perspective_camera({0, 1, 6}, {0, 0.5, 0}, 40.0));
  return scene;
}

Scene moved(Scene scene, const Vec3d& by) {
  const Mat4d move = test::translation(by);
  for (Instance& instance : scene.instances) instance.to_world = move * instance.to_world;
  for (Light& light : scene.lights) light.to_world = move * light.to_world;
  for (Camera& camera : scene.cameras) camera.to_world = move * camera.to_world;
  return scene;
}

TEST(LocalOrigin, scene_of_round_places_is_the_same_to_the_bit_a_million_metres_away) {
  // By whole steps of the grid of origins, of a size with the scene: the same numbers again.
  const Vec3d far_m(0x1p20, -0x1p21, 3 * 0x1p20);
  RenderSettings settings = test::small_settings();
  settings.size = {32, 24};
  settings.samples_per_pixel = 4;
  settings.aovs = {"Z", "N"};
  const Scene near = round_scene();
  Scene far = moved(near, far_m);
  place_about_local_origin(far, 0);
  EXPECT_EQ(far.origin_m.x, far_m.x);
  EXPECT_EQ(far.origin_m.y, far_m.y);
  EXPECT_EQ(far.origin_m.z, far_m.z);
  const Image a = test::render(near, settings).image;
  const Image b = test::render(far, settings).image;
  EXPECT_EQ(a.pixels, b.pixels);
}

TEST(LocalOrigin, positions_are_told_where_the_author_put_them) {
  RenderSettings settings = test::small_settings();
  settings.aovs = {"P"};
  const Scene near = round_scene();
  Scene far = moved(near, {4096, 0, -8192});
  place_about_local_origin(far, 0);
  EXPECT_EQ(far.origin_m.x, 4096.0);
  const Image a = test::render(near, settings).image;
  const Image b = test::render(far, settings).image;
  // The last digit of single precision at 8 km.
  EXPECT_NEAR(test::pixel(b, 4, 4, "P.X"), test::pixel(a, 4, 4, "P.X") + 4096.0f, 5e-4f);
  EXPECT_NEAR(test::pixel(b, 4, 4, "P.Z"), test::pixel(a, 4, 4, "P.Z") - 8192.0f, 1e-3f);
}

TEST(LocalOrigin, scene_near_its_origin_stays) {
  Scene scene = round_scene();
  place_about_local_origin(scene, 0);
  EXPECT_EQ(scene.origin_m, Vec3d(0.0));
  EXPECT_EQ(scene.instances[1].to_world, round_scene().instances[1].to_world);
}

TEST(LocalOrigin, is_near_the_camera_on_wide_ground_and_on_the_scene_that_is_seen_from_afar) {
  // A house at 300 km on a plain of 1000 km.
  Scene plain = moved(round_scene(), {3e5, 0, 1e5});
  test::add_square(plain, 1, 5e5, test::rotation({1, 0, 0}, -90.0));
  const Vec3d house(plain.instances.front().to_world[3]);
  place_about_local_origin(plain, 0);
  EXPECT_LT(glm::length(Vec3d(plain.instances.front().to_world[3])), kReach_m);
  EXPECT_EQ(Vec3d(plain.instances.front().to_world[3]) + plain.origin_m, house);
  // A camera on the Moon, as it were.
  Scene seen = moved(round_scene(), kFar_m);
  seen.cameras.front().to_world[3] += Vec4d(3.8e8, 0, 0, 0);
  place_about_local_origin(seen, 0);
  EXPECT_LT(glm::length(Vec3d(seen.instances.front().to_world[3])), kReach_m);
  // Nobody looks: the middle.
  Scene unseen = moved(round_scene(), kFar_m);
  unseen.cameras.clear();
  place_about_local_origin(unseen, std::nullopt);
  EXPECT_LT(glm::length(Vec3d(unseen.instances.front().to_world[3])), kReach_m);
}

}  // namespace
}  // namespace abbe
