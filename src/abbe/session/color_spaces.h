/// The colour spaces that EXR files are kept in: their names and their chromaticities.
#pragma once

#include <array>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "abbe/display/display.h"
#include "abbe/image/exr/exr.h"
#include "abbe/image/image.h"

namespace abbe {

/// The space that rendered pixels are in.
inline constexpr const char* kRenderSpace = "Linear Rec.709 (sRGB)";

/// Primaries and white of a colour space known by name; red, green, blue, white.
std::optional<std::array<float, 8>> chromaticities_of(const std::string& space);
/// The name of the space with such primaries and white.
std::optional<std::string> space_of(const std::array<float, 8>& chromaticities);

/// What an EXR says about the colour space of its RGB, else that of a render.
/// Errors: an input Error for a broken file and for chromaticities of no known space.
std::string space_of_file(const std::filesystem::path& file);

/// Checks before any work that the configuration has the space, and that it is scene-linear.
/// Errors: a usage Error that lists such spaces, or as convert_space.
void check_color_space(const std::string& space, const DisplayOptions& options);

/// Every colour of an image from one space to another: R, G, B and the layers that have such
/// channels. Errors: as convert_space.
void convert_colors(Image& image, const std::string& from, const std::string& to,
                    const DisplayOptions& options);

/// Writes a rendered image into files, in another space, which `abbe:primaries` and, where
/// they can, their chromaticities name. `options` say which configuration knows the space.
/// Errors: as convert_space and write_exr.
void write_exrs_in(const std::string& space, const std::vector<std::filesystem::path>& files,
                   Image image, ExrOptions form, const DisplayOptions& options = {});

}  // namespace abbe
