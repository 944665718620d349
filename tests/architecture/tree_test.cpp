/// The rules of the house, on the tree as it stands.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <map>
#include <memory>
#include <set>
#include <sstream>

#include "architecture/rules.h"

namespace abbe::architecture {
namespace {

namespace fs = std::filesystem;
using testing::IsEmpty;

const fs::path kRoot = ABBE_SOURCE_DIR;

std::string read_text(const fs::path& file) {
  std::ifstream stream(file, std::ios::binary);
  std::ostringstream text;
  text << stream.rdbuf();
  return text.str();
}

/// What builds and renders leave behind, as .gitignore names it.
bool is_product(const std::string& name) {
  return name == ".git" || name == "build" || name.starts_with("build-") || name == "out";
}

/// Files below a folder of the repository, relative to its root.
std::vector<std::string> files_below(const std::string& folder) {
  std::vector<std::string> files;
  for (const auto& entry : fs::recursive_directory_iterator(kRoot / folder))
    if (entry.is_regular_file()) files.push_back(fs::relative(entry.path(), kRoot).string());
  std::sort(files.begin(), files.end());
  return files;
}

std::vector<std::string> files_of_the_project() {
  std::vector<std::string> files;
  for (const auto& entry : fs::directory_iterator(kRoot)) {
    const std::string name = entry.path().filename();
    if (is_product(name)) continue;
    if (entry.is_regular_file()) files.push_back(name);
    if (entry.is_directory())
      for (const std::string& file : files_below(name)) files.push_back(file);
  }
  return files;
}

void append(std::vector<std::string>& all, const std::vector<std::string>& some) {
  all.insert(all.end(), some.begin(), some.end());
}

std::string one_per_line(const std::vector<std::string>& lines) {
  std::string text;
  for (const std::string& line : lines) text += "\n  " + line;
  return text;
}

/// All sources by path, relative to src/abbe/.
std::map<std::string, std::string> sources() {
  std::map<std::string, std::string> texts;
  for (const std::string& file : files_below("src/abbe"))
    if (file.ends_with(".h") || file.ends_with(".cpp"))
      texts[fs::path(file).lexically_relative("src/abbe").string()] = read_text(kRoot / file);
  return texts;
}

TEST(Tree, includes_point_down_and_third_parties_stay_behind_their_rim) {
  const std::map<std::string, std::string> texts = sources();
  ASSERT_FALSE(texts.empty());
  std::vector<std::string> violations = leak_violations(texts);
  for (const auto& [path, text] : texts) append(violations, include_violations(path, text));
  EXPECT_THAT(violations, IsEmpty()) << one_per_line(violations);
}

TEST(Tree, parts_of_a_module_include_each_other_one_way) {
  const std::vector<std::string> violations = part_violations(sources());
  EXPECT_THAT(violations, IsEmpty()) << one_per_line(violations);
}

TEST(Tree, folders_hold_few_enough_files_to_look_at) {
  const std::vector<std::string> violations = crowd_violations(sources());
  EXPECT_THAT(violations, IsEmpty()) << one_per_line(violations);
}

TEST(Tree, modules_link_only_lower_floors) {
  std::vector<std::string> violations;
  for (const auto& entry : fs::directory_iterator(kRoot / "src/abbe")) {
    if (!entry.is_directory() || fs::is_empty(entry)) continue;
    const fs::path lists = entry.path() / "CMakeLists.txt";
    append(violations, link_violations(fs::relative(lists, kRoot).string(), read_text(lists)));
  }
  EXPECT_THAT(violations, IsEmpty()) << one_per_line(violations);
}

TEST(Tree, top_level_holds_only_the_folders_of_the_house) {
  std::vector<std::string> folders;
  for (const auto& entry : fs::directory_iterator(kRoot))
    if (entry.is_directory() && !is_product(entry.path().filename()))
      folders.push_back(entry.path().filename());
  const std::vector<std::string> violations = top_level_violations(folders);
  EXPECT_THAT(violations, IsEmpty()) << one_per_line(violations);
}

TEST(Tree, texts_name_no_path_of_a_machine) {
  std::vector<std::string> violations;
  for (const std::string& file : files_of_the_project()) {
    const std::string text = read_text(kRoot / file);
    if (text.find('\0') != std::string::npos) continue;  // Pictures and buffers.
    append(violations, machine_path_violations(file, text));
  }
  EXPECT_THAT(violations, IsEmpty()) << one_per_line(violations);
}

TEST(Tree, names_say_what_a_file_is_about) {
  std::vector<std::string> violations;
  for (const std::string& file : files_of_the_project()) append(violations, name_violations(file));
  EXPECT_THAT(violations, IsEmpty()) << one_per_line(violations);
}

TEST(Tree, sources_are_formatted_as_clang_format_14_would) {
  ASSERT_EQ(std::system("clang-format-14 --version > /dev/null 2>&1"), 0) << "not installed";
  std::string command = "clang-format-14 --dry-run";
  for (const char* folder : {"src", "tests"})
    for (const std::string& file : files_below(folder))
      if (file.ends_with(".h") || file.ends_with(".cpp"))
        command += " '" + (kRoot / file).string() + "'";
  command += " 2>&1";
  std::unique_ptr<FILE, int (*)(FILE*)> output(popen(command.c_str(), "r"), pclose);
  ASSERT_TRUE(output);
  // `FILE:LINE:COLUMN: warning: code should be clang-formatted`, many to a file.
  std::set<std::string> unformatted;
  std::array<char, 4096> line{};
  while (std::fgets(line.data(), line.size(), output.get()) != nullptr) {
    const std::string text = line.data();
    if (text.find("-Wclang-format-violations") != std::string::npos)
      unformatted.insert(text.substr(0, text.find(':')));
  }
  EXPECT_THAT(unformatted, IsEmpty()) << "`make format` formats them";
}

}  // namespace
}  // namespace abbe::architecture
