/// The image files of a command: which format by which suffix, and how each is written.
#pragma once

#include <array>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "abbe/display/display.h"
#include "abbe/image/image.h"

namespace abbe {

/// The space that rendered pixels are in.
inline constexpr const char* kRenderSpace = "Linear Rec.709 (sRGB)";

enum class OutputKind { Exr, Raster };

/// By the suffix: EXR, or PNG, JPEG and TIFF. Errors: a usage Error that lists the suffixes.
OutputKind output_kind(const std::filesystem::path& file);

/// Checks before any work that every file can be written and no two are the same.
/// Errors: a usage Error for a suffix or a repeated file, an output Error for the rest.
void check_outputs(const std::vector<std::filesystem::path>& files);

/// Checks before any work that the configuration has the display, the view and both spaces.
/// Errors: as to_display and convert_space.
void check_display(const DisplayOptions& options);
void check_color_space(const std::string& space, const DisplayOptions& options);

/// Every colour of an image from one space to another: R, G, B and the layers that have such
/// channels. Errors: as convert_space.
void convert_colors(Image& image, const std::string& from, const std::string& to,
                    const DisplayOptions& options);

/// Primaries and white of a colour space known by name; red, green, blue, white.
std::optional<std::array<float, 8>> chromaticities_of(const std::string& space);
/// The name of the space with such primaries and white.
std::optional<std::string> space_of(const std::array<float, 8>& chromaticities);

/// A whole text file, or none. Errors: an output Error.
void write_text(const std::filesystem::path& target, const std::string& text);

/// What an EXR says about the colour space of its RGB, else that of a render.
/// Errors: an input Error for a broken file and for chromaticities of no known space.
std::string space_of_file(const std::filesystem::path& file);

}  // namespace abbe
