/// Hostile files through the real program: each case of the manifest, with a time limit.
#include <gmock/gmock.h>

#include "program.h"
#include "scenes.h"
#include "support/hostile_inputs.h"

namespace abbe::test {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

class BadInputTest : public ProgramTest, public testing::WithParamInterface<HostileInput> {};

TEST_P(BadInputTest, meets_the_manifest) {
  const HostileInput& input = GetParam();
  constexpr double kTimeLimit_s = 60.0;  // For a loaded machine; the slowest takes about a second.
  const Outcome run = abbe({"render", hostile_file(input).string(), "-o", "a.exr", "--size", "16x9",
                            "--spp", "1", "--depth", "4"},
                           kTimeLimit_s);
  ASSERT_FALSE(run.timed_out);
  ASSERT_EQ(run.signal, 0) << "killed by a signal";
  if (run.exit_code == 0) {
    EXPECT_NE(input.expected, 'E') << "rendered: " << run.err;
    EXPECT_THAT(new_files(), ElementsAre("a.exr"));
  } else {
    EXPECT_EQ(run.exit_code, 3);
    EXPECT_NE(input.expected, 'R') << run.err;
    EXPECT_TRUE(is_one_error_line(run.err));
    EXPECT_THAT(new_files(), IsEmpty());
  }
}

INSTANTIATE_TEST_SUITE_P(reference, BadInputTest, testing::ValuesIn(hostile_inputs()),
                         [](const auto& tested) { return case_name(tested.param); });

using OddInputTest = ProgramTest;

TEST_F(OddInputTest, is_a_warning_and_with_strict_an_error) {
  std::string text = small_scene();
  text.insert(text.find('{') + 1, "\"scene\": null, ");
  text.replace(text.rfind("\"scene\": 0,"), std::string("\"scene\": 0,").size(), "");
  write("odd.gltf", text);
  const Arguments arguments{"render", "odd.gltf", "-o", "a.exr", "--size", "8x4", "--spp", "1"};
  const Outcome lenient = abbe(arguments);
  EXPECT_EQ(lenient.exit_code, 0) << lenient.err;
  EXPECT_THAT(lenient.err, HasSubstr("warning: odd.gltf: /scene: null"));
  Arguments strict = arguments;
  strict.emplace_back("--strict");
  const Outcome run = abbe(strict);
  EXPECT_EQ(run.exit_code, 3);
  EXPECT_TRUE(is_one_error_line(run.err));
  EXPECT_THAT(run.err, HasSubstr("/scene: found null"));
  EXPECT_EQ(abbe({"inspect", "odd.gltf", "--strict"}).exit_code, 3);
}

}  // namespace
}  // namespace abbe::test
