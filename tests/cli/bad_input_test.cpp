/// Hostile files through the real program: each case of the reference manifest, with a time limit.
#include <gmock/gmock.h>

#include <cctype>
#include <fstream>
#include <iterator>
#include <sstream>

#include "program.h"

namespace abbe::test {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

namespace fs = std::filesystem;

const fs::path kFolder = fs::path(ABBE_REFERENCE_DIR) / "bad";

struct BadInput {
  std::string file;
  std::string what;
  char expected = 'E';  ///< Error, warning or error, renders.
};

void PrintTo(const BadInput& input, std::ostream* stream) {
  *stream << input.what;
}

std::vector<BadInput> manifest() {
  std::vector<BadInput> inputs;
  std::ifstream stream(kFolder / "manifest.tsv");
  std::string line;
  std::getline(stream, line);  // The names of the columns.
  while (std::getline(stream, line)) {
    std::istringstream columns(line);
    std::string file, category, what, expected;
    std::getline(columns, file, '\t');
    std::getline(columns, category, '\t');
    std::getline(columns, what, '\t');
    std::getline(columns, expected, '\t');
    inputs.push_back({file, what, expected.empty() ? '?' : expected.front()});
  }
  return inputs;
}

std::string case_name(const testing::TestParamInfo<BadInput>& tested) {
  std::string name = tested.param.file;
  for (char& c : name) {
    if (std::isalnum(static_cast<unsigned char>(c)) == 0) c = '_';
  }
  return name;
}

// A case whose file is the well-formed control, byte for byte, renders like it, whatever its name
// announces (an empty URI: see the tests of load/).
char expectation(const BadInput& input) {
  const auto text_of = [](const fs::path& file) {
    std::ifstream stream(file, std::ios::binary);
    return std::string(std::istreambuf_iterator<char>(stream), {});
  };
  const bool is_control = text_of(kFolder / input.file) == text_of(kFolder / "00_control_ok.gltf");
  return is_control ? 'R' : input.expected;
}

class BadInputTest : public ProgramTest, public testing::WithParamInterface<BadInput> {};

TEST_P(BadInputTest, meets_the_manifest) {
  const BadInput& input = GetParam();
  constexpr double kTimeLimit_s = 60.0;  // For a loaded machine; the slowest takes about a second.
  const Outcome run = abbe({"render", (kFolder / input.file).string(), "-o", "a.exr", "--size",
                            "16x9", "--spp", "1", "--depth", "4"},
                           kTimeLimit_s);
  ASSERT_FALSE(run.timed_out);
  ASSERT_EQ(run.signal, 0) << "killed by a signal";
  if (run.exit_code == 0) {
    EXPECT_NE(expectation(input), 'E') << "rendered: " << run.err;
    EXPECT_THAT(new_files(), ElementsAre("a.exr"));
  } else {
    EXPECT_EQ(run.exit_code, 3);
    EXPECT_NE(expectation(input), 'R') << run.err;
    EXPECT_TRUE(is_one_error_line(run.err));
    EXPECT_THAT(new_files(), IsEmpty());
  }
}

INSTANTIATE_TEST_SUITE_P(reference, BadInputTest, testing::ValuesIn(manifest()), case_name);
GTEST_ALLOW_UNINSTANTIATED_PARAMETERIZED_TEST(BadInputTest);

TEST(bad_input, manifest_is_there_or_skipped_aloud) {
  if (!fs::exists(kFolder)) {
    GTEST_SKIP() << "skipped: the hostile inputs of " << kFolder << " are not on this machine";
  }
  EXPECT_GE(manifest().size(), 100u);
}

}  // namespace
}  // namespace abbe::test
