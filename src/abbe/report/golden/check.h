/// Golden images made, and renders held against them.
#pragma once

#include <filesystem>
#include <string>

#include "abbe/base/parallel.h"
#include "abbe/report/golden/list.h"
#include "abbe/session/picture.h"

namespace abbe {

/// Where the image of a name lies.
std::filesystem::path golden_file(const std::filesystem::path& folder, const std::string& name);

/// How a reference was rendered, of whatever file its scene lies in.
/// Errors: an input Error for a file that does not say it, or that needs an observer's own file.
Recipe golden_recipe(const std::filesystem::path& reference);

/// Errors: a usage Error for what a reference cannot record: an observer's own file.
void check_golden_choice(const DevelopmentChoice& choice);

/// Renders a reference beside its file and puts it in its place. Returns by how much that changes
/// it, in a line.
/// Errors: as render_file; an output Error when interrupted.
std::string render_golden(const Recipe& recipe, const PreparedScene& prepared,
                          const Standards& standards, const std::filesystem::path& reference,
                          const CompareThresholds& thresholds, const CancelFlag* cancel = nullptr);

/// How golden images are checked.
struct GoldenCheck {
  std::filesystem::path folder;   ///< Of the references.
  std::filesystem::path results;  ///< For renders that fail.
  /// Instead of rendering, NAME.exr of this folder, by any renderer, is held against NAME.
  std::filesystem::path images = {};
  int threads = 0;
  const CancelFlag* cancel = nullptr;
};

/// Holds a render, or the image of another renderer, against a reference. A render that passes
/// leaves no file. Errors: none; the result says what went wrong.
GoldenResult check_golden(const GoldenImage& golden, const GoldenCheck& how);

}  // namespace abbe
