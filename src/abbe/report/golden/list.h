/// A folder of golden images: what is in it, and what came of a check.
#pragma once

#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "abbe/image/metrics/compare.h"

namespace abbe {

/// An image that renders are held against: NAME.exr of the folder, scene-linear.
struct GoldenImage {
  std::string name;
  std::string scene;    ///< Relative to the folder.
  std::string command;  ///< That makes it, for people: the file's own provenance says the same.
  CompareThresholds thresholds;
};

/// The file of a folder that lists its images.
inline constexpr const char* kGoldenList = "golden.json";

/// Errors: an input Error for a missing or broken list, and for names that lead out of the folder.
std::vector<GoldenImage> read_golden_list(const std::filesystem::path& folder);
/// Errors: an output Error.
void write_golden_list(const std::filesystem::path& folder, const std::vector<GoldenImage>& images);

/// Letters, digits, `_`, `-` and `.`, not first: safe as the name of a file.
bool is_golden_name(const std::string& name);

/// What came of the check of one image.
struct GoldenResult {
  std::string name;
  bool passed = false;
  std::string message;  ///< What was compared, or why nothing could be.
  double seconds = 0.0;
  std::string command = {};  ///< That makes the reference.
  /// Of a failure, what failure_pictures makes of it.
  std::vector<std::pair<std::string, std::string>> pictures = {};
};

/// "3 of 4 golden images passed."
std::string golden_summary(const std::vector<GoldenResult>& results);

/// The page of a check, failures first.
std::string golden_results_page(const std::vector<GoldenResult>& results);

/// A report in the form that continuous integration reads.
/// Source: the JUnit XML schema of Apache Ant, as Jenkins and GitLab take it.
std::string junit_xml(const std::string& suite, const std::vector<GoldenResult>& results);

}  // namespace abbe
