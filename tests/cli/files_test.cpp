/// Files that cannot be read or written: exit codes 3 and 4, one line, and nothing left behind.
#include <gmock/gmock.h>

#include "program.h"
#include "scenes.h"

namespace abbe::test {
namespace {

using testing::HasSubstr;
using testing::IsEmpty;

constexpr int kBadInput = 3;
constexpr int kOutputFailed = 4;

class FilesTest : public ProgramTest {
 protected:
  void expect_bad_input(const std::string& scene, const std::string& says) const {
    for (const Arguments& arguments :
         {Arguments{"render", scene, "-o", "a.exr", "-o", "a.png", "--stats", "a.json"},
          Arguments{"probe", scene, "--pixel", "0,0"}, Arguments{"inspect", scene}}) {
      const Outcome run = abbe(arguments);
      EXPECT_EQ(run.exit_code, kBadInput) << arguments.front();
      EXPECT_TRUE(is_one_error_line(run.err));
      EXPECT_THAT(run.err, HasSubstr(says));
      EXPECT_THAT(run.out, IsEmpty());
    }
    EXPECT_THAT(new_files(), IsEmpty());
  }

  void expect_output_failed(const Arguments& arguments, const std::string& says) const {
    const Outcome run = abbe(arguments);
    EXPECT_EQ(run.exit_code, kOutputFailed);
    EXPECT_TRUE(is_one_error_line(run.err));
    EXPECT_THAT(run.err, HasSubstr(says));
    EXPECT_THAT(new_files(), IsEmpty());
  }
};

TEST_F(FilesTest, missing_scene_is_bad_input) {
  expect_bad_input("none.gltf", "none.gltf");
}

TEST_F(FilesTest, folder_as_scene_is_bad_input) {
  expect_bad_input(".", "a folder");
}

TEST_F(FilesTest, truncated_scene_is_bad_input_with_its_place) {
  const std::string whole = small_scene();
  write("cut.gltf", whole.substr(0, whole.size() / 2));
  expect_bad_input("cut.gltf", "cut.gltf");
}

TEST_F(FilesTest, scene_that_is_no_json_is_bad_input) {
  write("text.gltf", "a scene with a prism, please");
  expect_bad_input("text.gltf", "text.gltf");
}

TEST_F(FilesTest, empty_scene_file_is_bad_input) {
  write("empty.glb", "");
  expect_bad_input("empty.glb", "empty.glb");
}

TEST_F(FilesTest, index_out_of_range_is_bad_input_with_its_pointer) {
  std::string text = small_scene();
  const std::string material = "\"material\": 1";
  text.replace(text.find(material), material.size(), "\"material\": 7");
  write("range.gltf", text);
  expect_bad_input("range.gltf", "/meshes/1/primitives/0/material");
}

TEST_F(FilesTest, uri_that_leaves_the_folder_is_bad_input) {
  std::string text = small_scene();
  const std::string asset = "\"asset\"";
  text.replace(text.find(asset), asset.size(),
               R"("images": [{"uri": "../../etc/passwd"}], "asset")");
  write("leaves.gltf", text);
  expect_bad_input("leaves.gltf", "/images/0/uri");
}

TEST_F(FilesTest, unknown_glass_is_bad_input_with_near_names) {
  std::string text = small_scene();
  const std::string glass = "N-SF11";
  text.replace(text.find(glass), glass.size(), "N-SF12");
  write("glass.gltf", text);
  expect_bad_input("glass.gltf", "N-SF11");
}

TEST_F(FilesTest, output_in_a_missing_folder_fails_before_work) {
  expect_output_failed({"render", "scene.gltf", "-o", "none/a.exr", "--spp", "100000"},
                       "none/a.exr");
}

TEST_F(FilesTest, one_bad_output_of_two_leaves_none) {
  expect_output_failed({"render", "scene.gltf", "-o", "a.exr", "-o", "none/a.png"}, "none/a.png");
}

TEST_F(FilesTest, folder_as_output_fails) {
  std::filesystem::create_directory(file("folder.exr"));
  const Outcome run = abbe({"render", "scene.gltf", "-o", "folder.exr"});
  EXPECT_EQ(run.exit_code, kOutputFailed);
  EXPECT_TRUE(is_one_error_line(run.err));
}

TEST_F(FilesTest, stats_in_a_missing_folder_fail_before_work) {
  expect_output_failed({"render", "scene.gltf", "-o", "a.exr", "--stats", "none/s.json"},
                       "none/s.json");
}

TEST_F(FilesTest, failed_render_leaves_the_old_file_as_it_was) {
  write("old.exr", "precious");
  const Outcome run = abbe({"render", "none.gltf", "-o", "old.exr"});
  EXPECT_EQ(run.exit_code, kBadInput);
  EXPECT_EQ(bytes("old.exr"), "precious");
}

TEST_F(FilesTest, missing_configuration_is_bad_input) {
  const Outcome run = abbe({"render", "scene.gltf", "-o", "a.png", "--config", "none.ocio"});
  EXPECT_EQ(run.exit_code, kBadInput);
  EXPECT_TRUE(is_one_error_line(run.err));
  EXPECT_THAT(run.err, HasSubstr("none.ocio"));
}

TEST_F(FilesTest, display_of_no_exr_is_bad_input) {
  const Outcome run = abbe({"display", "scene.gltf", "-o", "a.png"});
  EXPECT_EQ(run.exit_code, kBadInput);
  EXPECT_TRUE(is_one_error_line(run.err));
  EXPECT_THAT(new_files(), IsEmpty());
}

}  // namespace
}  // namespace abbe::test
