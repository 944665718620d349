/// Hostile files through the real program: each case of the manifest, with a time limit.
#include <gmock/gmock.h>

#include "program.h"
#include "support/hostile_inputs.h"

namespace abbe::test {
namespace {

using testing::ElementsAre;
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

}  // namespace
}  // namespace abbe::test
