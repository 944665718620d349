#include "abbe/base/file.h"

#include <gtest/gtest.h>
#include <sys/stat.h>

#include <cstdlib>
#include <fstream>
#include <string>

#include "abbe/base/error.h"

namespace abbe {
namespace {

namespace fs = std::filesystem;

class FileTest : public testing::Test {
 protected:
  void SetUp() override {
    std::string name = (fs::temp_directory_path() / "abbe-file-XXXXXX").string();
    ASSERT_NE(mkdtemp(name.data()), nullptr);
    folder_ = name;
  }
  void TearDown() override { fs::remove_all(folder_); }

  fs::path write(const std::string& name, const std::string& content) const {
    std::ofstream(folder_ / name, std::ios::binary) << content;
    return folder_ / name;
  }
  static std::string content_of(const fs::path& file) {
    const auto bytes = read_file(file, "test", 1 << 20);
    return {bytes.begin(), bytes.end()};
  }
  std::size_t file_count() const {
    return static_cast<std::size_t>(
        std::distance(fs::directory_iterator(folder_), fs::directory_iterator()));
  }

  fs::path folder_;
};

TEST_F(FileTest, read_file_returns_all_bytes) {
  const std::string content("a\0b\xff", 4);
  EXPECT_EQ(content_of(write("a", content)), content);
  EXPECT_EQ(content_of(write("empty", "")), "");
}

TEST_F(FileTest, read_file_missing_names_place_and_file) {
  try {
    read_file(folder_ / "none.bin", "a.gltf: /buffers/0/uri", 10);
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(error.detail().kind, ErrorKind::Input);
    EXPECT_EQ(error.detail().where, "a.gltf: /buffers/0/uri");
    EXPECT_NE(error.detail().found.find("none.bin"), std::string::npos);
  }
}

TEST_F(FileTest, read_file_larger_than_allowed_is_an_error) {
  const fs::path file = write("a", "12345");
  EXPECT_THROW(read_file(file, "test", 4), Error);
  EXPECT_EQ(read_file(file, "test", 5).size(), 5u);
}

TEST_F(FileTest, read_file_of_pipe_device_or_folder_is_an_error_and_does_not_wait) {
  ASSERT_EQ(mkfifo((folder_ / "pipe").c_str(), 0600), 0);
  EXPECT_THROW(read_file(folder_ / "pipe", "test", 10), Error);
  EXPECT_THROW(read_file("/dev/zero", "test", 10), Error);
  EXPECT_THROW(read_file(folder_, "test", 10), Error);
}

TEST_F(FileTest, write_atomically_puts_a_whole_file_in_place) {
  const fs::path target = write("out.exr", "old");
  fs::path seen;
  write_atomically(target, [&](const fs::path& temporary) {
    seen = temporary;
    EXPECT_EQ(temporary.extension(), ".exr");
    EXPECT_EQ(temporary.parent_path(), folder_);
    std::ofstream(temporary) << "new";
    EXPECT_EQ(content_of(target), "old");
  });
  EXPECT_EQ(content_of(target), "new");
  EXPECT_FALSE(fs::exists(seen));
  EXPECT_EQ(file_count(), 1u);
}

TEST_F(FileTest, write_atomically_when_writer_throws_leaves_target_and_nothing_else) {
  const fs::path target = write("out.exr", "old");
  EXPECT_THROW(write_atomically(target,
                                [](const fs::path& temporary) {
                                  std::ofstream(temporary) << "half";
                                  throw std::runtime_error("stop");
                                }),
               std::runtime_error);
  EXPECT_EQ(content_of(target), "old");
  EXPECT_EQ(file_count(), 1u);
}

TEST_F(FileTest, write_atomically_through_a_link_keeps_the_link) {
  const fs::path target = write("real.png", "old");
  fs::create_symlink("real.png", folder_ / "link.png");
  write_atomically(folder_ / "link.png",
                   [](const fs::path& temporary) { std::ofstream(temporary) << "new"; });
  EXPECT_TRUE(fs::is_symlink(folder_ / "link.png"));
  EXPECT_EQ(content_of(target), "new");
}

TEST_F(FileTest, write_to_impossible_target_is_an_output_error) {
  const auto ignore = [](const fs::path&) { FAIL() << "nothing should be written"; };
  const fs::path file = write("file", "");
  for (const fs::path& target :
       {folder_ / "none/out.exr", folder_, file / "out.exr", fs::path("/dev/full")}) {
    for (const bool is_check : {true, false}) {
      try {
        is_check ? check_writable(target) : write_atomically(target, ignore);
        ADD_FAILURE() << target;
      } catch (const Error& error) {
        EXPECT_EQ(error.detail().kind, ErrorKind::Output) << error.what();
      }
    }
  }
}

TEST_F(FileTest, check_writable_leaves_nothing_behind) {
  check_writable(folder_ / "out.exr");
  EXPECT_EQ(file_count(), 0u);
}

TEST(hash_bytes, published_vectors_are_met) {
  // Source: the test vectors of the FNV reference, draft-eastlake-fnv.
  EXPECT_EQ(hash_bytes("", 0), 0xcbf29ce484222325ull);
  EXPECT_EQ(hash_bytes("a", 1), 0xaf63dc4c8601ec8cull);
  EXPECT_EQ(hash_bytes("foobar", 6), 0x85944171f73967e8ull);
}

TEST(hash_bytes, continued_equals_whole) {
  EXPECT_EQ(hash_bytes("bar", 3, hash_bytes("foo", 3)), hash_bytes("foobar", 6));
}

TEST(program_folder, holds_this_program) {
  EXPECT_TRUE(fs::is_directory(program_folder()));
}

}  // namespace
}  // namespace abbe
