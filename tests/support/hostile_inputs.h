/// The hostile inputs of tests/reference/hostile.
#pragma once

#include <filesystem>
#include <ostream>
#include <string>
#include <vector>

namespace abbe::test {

/// A row of the manifest.
struct HostileInput {
  std::string name;  ///< Of the file.
  std::string what;  ///< What is wrong with it.
  char expected =
      'E';  ///< E: an error; W: an error or a warning; R: legal, loads without an error.

  friend void PrintTo(const HostileInput& input, std::ostream* out) { *out << input.what; }
};

/// All rows of the manifest; none where it cannot be read.
const std::vector<HostileInput>& hostile_inputs();

/// Where the file of an input lies. What a loop says better than megabytes is written into a
/// temporary folder, which goes when the test program ends.
std::filesystem::path hostile_file(const HostileInput& input);

/// The input's name as GoogleTest wants names of cases.
std::string case_name(const HostileInput& input);

}  // namespace abbe::test
