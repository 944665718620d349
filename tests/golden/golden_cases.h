/// The golden images of the project: which scene, how rendered, and where the reference lies.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "image/compare.h"
#include "image/image.h"

namespace abbe::golden {

struct Case {
  std::string name;   ///< "prism_spectral"; the reference is images/NAME.exr.
  std::string scene;  ///< Relative to the source folder.
  std::string options;

  std::filesystem::path reference() const;
};

/// All cases: the two showpieces in all three modes, the others in spectral mode.
std::vector<Case> cases();

/// Renders with the program itself, as a user would, with `more` options behind the case's own.
/// Errors: std::runtime_error when the program fails.
Image render(const Case& golden, const std::string& more = "");
/// The same into a file.
void render_to(const Case& golden, const std::filesystem::path& file, const std::string& more = "");

/// Where the results of failed comparisons are left to be looked at.
std::filesystem::path failure_folder();

}  // namespace abbe::golden
