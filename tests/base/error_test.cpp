#include "abbe/base/error.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace abbe {
namespace {

TEST(error, message_states_place_found_expected_and_choices) {
  const Error error({ErrorKind::Input, "a.gltf: /x", "1", "2", {"b", "c"}});
  EXPECT_STREQ(error.what(), "a.gltf: /x: found 1, expected 2 (one of b, c)");
}

TEST(error, message_with_control_characters_stays_one_printable_line) {
  const Error error({ErrorKind::Input, "", std::string("a\n\x1b[31m\0b", 9), "text"});
  const std::string text = error.what();
  EXPECT_EQ(text.find('\n'), std::string::npos);
  EXPECT_EQ(text.find('\x1b'), std::string::npos);
}

TEST(nearest_names, misspelt_tail_finds_the_full_id) {
  const std::vector<std::string> names = {"glass/schott/F2", "glass/schott/N-BK7",
                                          "metal/Au-Johnson"};
  EXPECT_THAT(nearest_names("N-BK8", names, 1), testing::ElementsAre("glass/schott/N-BK7"));
}

}  // namespace
}  // namespace abbe
