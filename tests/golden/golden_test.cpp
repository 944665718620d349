// Renders of the scenes against their golden images, by `abbe golden check` as anybody runs it, and
// proofs that wrong renders fail.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cctype>
#include <cstdlib>

#include "abbe/image/exr/exr.h"
#include "abbe/report/golden/list.h"
#include "cli/program.h"

namespace abbe {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

const fs::path kImages = fs::path(ABBE_SOURCE_DIR) / "tests/golden/images";
constexpr int kExceeded = 1;
constexpr int kUsage = 2;
constexpr int kBadInput = 3;

// Where the results of failed comparisons are left to be looked at, for each level of instructions
// by itself: they are checked side by side.
std::string results_of(const std::string& name) {
  const char* level = std::getenv("ABBE_ISA");
  return (fs::path(ABBE_PROGRAM).parent_path().parent_path() / "golden" /
          (name + (level != nullptr ? std::string("-") + level : "")))
      .string();
}

class Golden : public test::ProgramTest, public testing::WithParamInterface<std::string> {};

TEST_P(Golden, render_matches_its_golden_image) {
  const std::string results = results_of(GetParam());
  const test::Outcome outcome =
      abbe({"golden", "check", kImages.string(), "--only", GetParam(), "-o", results}, 600.0);
  EXPECT_EQ(outcome.exit_code, 0) << outcome.out << outcome.err << "see " << results
                                  << "/index.html";
  EXPECT_THAT(outcome.out, HasSubstr("pass " + GetParam()));
}

std::vector<std::string> names() {
  std::vector<std::string> result;
  for (const GoldenImage& image : read_golden_list(kImages)) result.push_back(image.name);
  return result;
}

std::string test_name(const testing::TestParamInfo<std::string>& test) {
  std::string name = test.param;
  std::replace_if(
      name.begin(), name.end(), [](unsigned char c) { return std::isalnum(c) == 0 && c != '_'; },
      '_');
  return name;
}

INSTANTIATE_TEST_SUITE_P(scenes, Golden, testing::ValuesIn(names()), test_name);

// A wrong render has to fail, or the comparison proves nothing. It comes as another renderer's
// images do.
class WrongRender : public test::ProgramTest,
                    public testing::WithParamInterface<std::vector<std::string>> {};

TEST_P(WrongRender, deliberately_wrong_render_fails_its_golden_image) {
  const std::string name = "prism_spectral";
  fs::create_directories(file("theirs"));
  test::Arguments render{"render", (fs::path(ABBE_SOURCE_DIR) / "scenes/prism/prism.gltf").string(),
                         "-o",     file("theirs/" + name + ".exr").string(),
                         "--size", "80x45",
                         "--spp",  "8",
                         "--quiet"};
  render.insert(render.end(), GetParam().begin(), GetParam().end());
  ASSERT_EQ(abbe(render, 600.0).exit_code, 0);
  const test::Outcome outcome = abbe(
      {"golden", "check", kImages.string(), "--only", name, "--images", "theirs", "-o", "out"});
  EXPECT_EQ(outcome.exit_code, kExceeded) << outcome.out;
  EXPECT_THAT(outcome.out, HasSubstr("FAIL prism_spectral"));
}

INSTANTIATE_TEST_SUITE_P(ways, WrongRender,
                         testing::Values(std::vector<std::string>{"--depth", "3"},
                                         std::vector<std::string>{"--wavelengths", "4"},
                                         std::vector<std::string>{"--seed", "2"},
                                         std::vector<std::string>{"--range", "400:640"},
                                         std::vector<std::string>{"--filter", "box"}));

class GoldenCommand : public test::ProgramTest {
 protected:
  // A folder of one small image, and the image as another program might have made it.
  void SetUp() override {
    ASSERT_EQ(abbe({"golden", "make", "scene.gltf", "-o", "golden", "--size", "16x9", "--spp", "1",
                    "--name", "ball"})
                  .exit_code,
              0);
    fs::create_directories(file("theirs"));
    fs::copy_file(file("golden/ball.exr"), file("theirs/ball.exr"));
  }
  // Brighter by a factor.
  void change_theirs(float factor) const {
    Image image = read_exr(file("theirs/ball.exr"));
    for (float& value : image.pixels) value *= factor;
    write_exr(file("theirs/ball.exr"), image, {});
  }
};

TEST_F(GoldenCommand, made_folder_passes_its_own_check) {
  const test::Outcome outcome = abbe({"golden", "check", "golden"});
  EXPECT_EQ(outcome.exit_code, 0) << outcome.out << outcome.err;
  EXPECT_TRUE(fs::exists(file("golden-check/index.html")));
  EXPECT_THAT(bytes("golden-check/junit.xml"), HasSubstr("tests=\"1\" failures=\"0\""));
  // It says how it was made, to people as well.
  EXPECT_THAT(bytes("golden/golden.json"),
              HasSubstr("abbe render scene.gltf -o OUT.exr --size 16x9"));
}

TEST_F(GoldenCommand, images_of_another_program_need_the_folder_alone) {
  fs::remove(file("scene.gltf"));
  EXPECT_EQ(abbe({"golden", "check", "golden", "--images", "theirs"}).exit_code, 0);
}

TEST_F(GoldenCommand, images_with_more_channels_are_judged_by_those_of_the_reference) {
  Image image = read_exr(file("theirs/ball.exr"));
  Image more = image;
  more.channels.push_back("A");
  more.pixels.clear();
  for (std::size_t p = 0; p < image.pixels.size() / 3; ++p) {
    more.pixels.insert(more.pixels.end(), image.pixels.begin() + 3 * p,
                       image.pixels.begin() + 3 * p + 3);
    more.pixels.push_back(1.0f);
  }
  write_exr(file("theirs/ball.exr"), more, {});
  EXPECT_EQ(abbe({"golden", "check", "golden", "--images", "theirs"}).exit_code, 0);
}

TEST_F(GoldenCommand, image_brighter_by_five_per_cent_fails_with_page_and_report) {
  change_theirs(1.05f);
  const test::Outcome outcome =
      abbe({"golden", "check", "golden", "--images", "theirs", "--junit", "report.xml"});
  EXPECT_EQ(outcome.exit_code, kExceeded);
  EXPECT_THAT(bytes("report.xml"), HasSubstr("<failure message="));
  const std::string page = bytes("golden-check/index.html");
  for (const char* picture : {"\"reference\": \"data:image/png", "\"result\": \"data:image/png",
                              "\"difference\": \"data:image/png"}) {
    EXPECT_THAT(page, HasSubstr(picture));
  }
}

TEST_F(GoldenCommand, missing_reference_fails) {
  fs::remove(file("golden/ball.exr"));
  EXPECT_EQ(abbe({"golden", "check", "golden", "--images", "theirs"}).exit_code, kExceeded);
  EXPECT_EQ(abbe({"golden", "check", "golden"}).exit_code, kExceeded);
}

TEST_F(GoldenCommand, missing_or_broken_image_fails) {
  fs::remove(file("theirs/ball.exr"));
  EXPECT_EQ(abbe({"golden", "check", "golden", "--images", "theirs"}).exit_code, kExceeded);
  write("theirs/ball.exr", "no image");
  EXPECT_EQ(abbe({"golden", "check", "golden", "--images", "theirs"}).exit_code, kExceeded);
}

TEST_F(GoldenCommand, renewing_says_what_has_changed) {
  fs::copy_file(file("golden/ball.exr"), file("before.exr"));
  const test::Outcome outcome = abbe({"golden", "renew", "golden"});
  EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_THAT(outcome.out, HasSubstr("ball: "));
  EXPECT_THAT(outcome.out, HasSubstr("max 0"));
  EXPECT_EQ(bytes("golden/ball.exr"), bytes("before.exr"));
}

TEST_F(GoldenCommand, list_that_leads_out_of_the_folder_is_refused) {
  std::string list = bytes("golden/golden.json");
  list.replace(list.find("\"ball\""), 6, "\"../ball\"");
  write("golden/golden.json", list);
  EXPECT_EQ(abbe({"golden", "check", "golden"}).exit_code, kBadInput);
}

TEST_F(GoldenCommand, observer_of_a_file_is_refused_before_anything_is_written) {
  const std::string before = bytes("golden/ball.exr");
  write("eye.csv", "nm,x,y,z\n400,0,0,1\n500,0,1,0\n600,1,0,0\n700,0,0,0\n");
  for (const char* folder : {"golden", "new"}) {
    const test::Outcome outcome = abbe({"golden", "make", "scene.gltf", "-o", folder, "--size",
                                        "16x9", "--name", "ball", "--observer", "eye.csv"});
    EXPECT_EQ(outcome.exit_code, kUsage);
    EXPECT_THAT(outcome.err, HasSubstr("--observer: found \"eye.csv\""));
  }
  EXPECT_EQ(bytes("golden/ball.exr"), before);
  EXPECT_FALSE(fs::exists(file("new")));
}

TEST_F(GoldenCommand, scene_that_has_changed_is_said_to_have) {
  std::string scene = bytes("scene.gltf");
  EXPECT_THAT(abbe({"golden", "check", "golden"}).out, testing::Not(HasSubstr("abbe:sceneHash")));
  write("scene.gltf", scene + "\n");
  const test::Outcome outcome = abbe({"golden", "check", "golden"});
  EXPECT_EQ(outcome.exit_code, 0);  // A blank shapes no pixel.
  EXPECT_THAT(outcome.out, HasSubstr("abbe:sceneHash differs"));
}

TEST_F(GoldenCommand, list_without_images_or_without_json_is_an_error) {
  write("golden/golden.json", "{\"images\": []}");
  EXPECT_EQ(abbe({"golden", "check", "golden"}).exit_code, kBadInput);
  EXPECT_EQ(abbe({"golden", "renew", "golden"}).exit_code, kBadInput);
  write("golden/golden.json", "{");
  const test::Outcome outcome = abbe({"golden", "check", "golden"});
  EXPECT_EQ(outcome.exit_code, kBadInput);
  EXPECT_THAT(outcome.err, HasSubstr("line 1, column 2"));
}

TEST_F(GoldenCommand, camera_named_default_is_found_again) {
  std::string scene = bytes("scene.gltf");
  for (std::size_t at = 0; (at = scene.find("\"eye\"", at)) != std::string::npos;) {
    scene.replace(at, 5, "\"default\"");
  }
  write("default.gltf", scene);
  ASSERT_EQ(abbe({"golden", "make", "default.gltf", "-o", "golden", "--size", "16x9", "--spp", "1",
                  "--camera", "default"})
                .exit_code,
            0);
  EXPECT_EQ(abbe({"golden", "check", "golden"}).exit_code, 0);
}

TEST_F(GoldenCommand, wrong_names_and_folders_are_errors) {
  EXPECT_EQ(abbe({"golden", "check", "golden", "--only", "bell"}).exit_code, kUsage);
  EXPECT_EQ(abbe({"golden", "check", "nowhere"}).exit_code, kBadInput);
  EXPECT_EQ(abbe({"golden", "make", "scene.gltf", "-o", "golden", "--name", "../x"}).exit_code,
            kUsage);
  EXPECT_EQ(abbe({"golden", "make", "scene.gltf", "-o", "golden", "--fail", "-1"}).exit_code,
            kUsage);
}

}  // namespace
}  // namespace abbe
