/// The image files of a command: which format by which suffix.
#pragma once

#include <filesystem>
#include <vector>

#include "abbe/display/display.h"

namespace abbe {

enum class OutputKind { Exr, Raster };

/// By the suffix: EXR, or PNG, JPEG and TIFF. Errors: a usage Error that lists the suffixes.
OutputKind output_kind(const std::filesystem::path& file);

/// Checks before any work that every file can be written and no two are the same.
/// Errors: a usage Error for a suffix or a repeated file, an output Error for the rest.
void check_outputs(const std::vector<std::filesystem::path>& files);

/// Checks before any work that the configuration has the display and the view.
/// Errors: as to_display.
void check_display(const DisplayOptions& options);

}  // namespace abbe
