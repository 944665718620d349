#include <gtest/gtest.h>

#include <cstdint>
#include <cstdlib>
#include <numeric>
#include <string>
#include <vector>

#include "abbe/base/error.h"
#include "abbe/base/paged.h"
#include "abbe/base/shared_values.h"

namespace abbe {
namespace {

TEST(PageStore, values_are_the_same_after_their_pages_were_forgotten) {
  const auto store = PageStore::open(0);
  std::vector<std::uint32_t> numbers(100000);
  std::iota(numbers.begin(), numbers.end(), 7u);
  const SharedValues<std::uint32_t> first(numbers, store);
  const SharedValues<std::uint32_t> second({1, 2, 3}, store);
  for (int round = 0; round < 3; ++round) {
    EXPECT_EQ(std::vector<std::uint32_t>(first.begin(), first.end()), numbers);
    EXPECT_EQ(std::vector<std::uint32_t>(second.begin(), second.end()),
              (std::vector<std::uint32_t>{1, 2, 3}));
    store->let_go();
    let_go_of_pages();
  }
  EXPECT_EQ(first.store(), store);
}

TEST(PageStore, values_outlive_their_store_and_change_in_memory) {
  auto store = PageStore::open(1 << 20);
  SharedValues<std::uint8_t> values({1, 2}, store);
  const SharedValues<std::uint8_t> copy = values;
  store.reset();
  values.push_back(3);
  EXPECT_EQ(values.store(), nullptr);
  EXPECT_EQ(std::vector<std::uint8_t>(values.begin(), values.end()),
            (std::vector<std::uint8_t>{1, 2, 3}));
  EXPECT_EQ(copy.size(), 2u);
  EXPECT_EQ(copy[1], 2);
}

TEST(PageStore, folder_that_takes_no_file_is_an_output_error) {
  const char* const before = std::getenv("TMPDIR");
  const std::string kept = before == nullptr ? "" : before;
  setenv("TMPDIR", "/nowhere/at/all", 1);
  try {
    (void)PageStore::open(0);
    ADD_FAILURE() << "no error";
  } catch (const Error& caught) {
    EXPECT_EQ(caught.detail().kind, ErrorKind::Output);
    EXPECT_EQ(caught.detail().where, "/nowhere/at/all");
  }
  if (before == nullptr) {
    unsetenv("TMPDIR");
  } else {
    setenv("TMPDIR", kept.c_str(), 1);
  }
}

}  // namespace
}  // namespace abbe
