/// The image files of a command: which format by which suffix.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "abbe/display/display.h"

namespace abbe {

enum class OutputKind { Exr, Raster };

/// Small, with their dots; that of EXR is the first.
const std::vector<std::string>& image_suffixes();

/// By the suffix: EXR, or PNG, JPEG and TIFF. Errors: a usage Error that lists the suffixes.
OutputKind output_kind(const std::filesystem::path& file);

/// Files by their kind, each in the order given.
struct Outputs {
  std::vector<std::filesystem::path> exrs, rasters;
};

/// Errors: as output_kind.
Outputs sorted_outputs(const std::vector<std::string>& files);

/// Checks before any work that every file can be written and no two are the same.
/// Errors: a usage Error for a suffix or a repeated file, an output Error for the rest.
void check_outputs(const std::vector<std::filesystem::path>& files);

/// A file and the option that names it.
struct NamedFile {
  std::string option;
  std::filesystem::path file;
};

/// Checks before any work that nothing written replaces what is read, or what else is written.
/// A file without a name is passed over.
/// Errors: a usage Error that names both.
void check_apart(const std::vector<NamedFile>& written, const std::vector<NamedFile>& read);

/// Checks before any work that the configuration has the display and the view.
/// Errors: as to_display.
void check_display(const DisplayOptions& options);

}  // namespace abbe
