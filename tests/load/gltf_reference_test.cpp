// Every hostile and every analytic file of tests/reference, each loaded in this process.
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <string>

#include "abbe/base/error.h"
#include "abbe/load/gltf.h"
#include "abbe/scene/rigs.h"
#include "abbe/scene/validation.h"
#include "support/hostile_inputs.h"

namespace abbe {
namespace {

namespace fs = std::filesystem;

struct Outcome {
  std::optional<Scene> scene;
  Notes notes;
  std::string error;
};

Outcome load(const fs::path& file) {
  Outcome outcome;
  try {
    outcome.scene = load_gltf(file, Catalogue::standard(), {}, outcome.notes);
  } catch (const Error& error) {
    outcome.error = error.what();
    EXPECT_EQ(error.detail().kind, ErrorKind::Input) << outcome.error;
    EXPECT_FALSE(error.detail().found.empty() && error.detail().expected.empty());
  }
  return outcome;
}

std::string text_of(const Notes& notes) {
  std::string text;
  for (const Note& note : notes.all()) text += note.where + ": " + note.text + "\n";
  return text;
}

class HostileFile : public testing::TestWithParam<test::HostileInput> {};

TEST_P(HostileFile, load_meets_the_manifest) {
  const test::HostileInput& input = GetParam();
  const Outcome outcome = load(test::hostile_file(input));
  if (input.expected == 'E') {
    ASSERT_FALSE(outcome.scene) << input.what << ": loaded, but is an error";
    EXPECT_NE(outcome.error.find(input.name), std::string::npos) << outcome.error;
    EXPECT_EQ(outcome.error.find('\n'), std::string::npos) << outcome.error;
  } else if (input.expected == 'R') {
    EXPECT_TRUE(outcome.scene) << input.what << ": " << outcome.error;
  } else {
    EXPECT_TRUE(!outcome.scene || !outcome.notes.all().empty())
        << input.what << ": loaded without a word";
  }
  // Whatever loads is fit to be rendered, with a default camera and a rig if need be.
  if (outcome.scene) {
    Scene scene = *outcome.scene;
    add_default_camera(scene);
    add_rig(scene, Rig::Auto, 0, {"", Spectrum::constant(1.0)});
    EXPECT_NO_THROW(validate(scene, input.name));
    const Box3d box = bounds_of(scene);
    if (!box.is_empty()) {
      EXPECT_TRUE(std::isfinite(glm::distance(box.low, box.high)));
    }
  }
}

INSTANTIATE_TEST_SUITE_P(reference, HostileFile, testing::ValuesIn(test::hostile_inputs()),
                         [](const auto& tested) { return test::case_name(tested.param); });

TEST(gltf_reference, every_hostile_input_is_there) {
  ASSERT_GE(test::hostile_inputs().size(), 100u);
  for (const test::HostileInput& input : test::hostile_inputs()) {
    EXPECT_TRUE(fs::exists(test::hostile_file(input))) << input.name;
  }
}

TEST(gltf_reference, analytic_scenes_load_without_a_warning) {
  int scenes = 0;
  for (const auto& entry :
       fs::directory_iterator(fs::path(ABBE_SOURCE_DIR) / "tests/reference/analytic")) {
    if (entry.path().extension() != ".gltf") continue;
    const Outcome outcome = load(entry.path());
    ASSERT_TRUE(outcome.scene) << outcome.error;
    EXPECT_EQ(text_of(outcome.notes), "");
    EXPECT_EQ(outcome.scene->cameras.size(), 1u);
    ++scenes;
  }
  EXPECT_EQ(scenes, 14);
}

}  // namespace
}  // namespace abbe
