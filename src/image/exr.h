/// EXR files by OpenEXR itself, so that the bytes are reproducible.
#pragma once

#include <array>
#include <filesystem>
#include <optional>
#include <string>

#include "image/image.h"

namespace abbe {

struct ExrOptions {
  bool half = false;             ///< Half instead of float, except depth, position and id channels.
  /// Red, green, blue, white xy, written as the standard `chromaticities` attribute.
  std::optional<std::array<float, 8>> chromaticities;
};

/// Writes beside the target and renames: what stands at the target is always whole.
/// Errors: output Error.
void write_exr(const std::filesystem::path& file, const Image& image, const ExrOptions& options);

/// Reads a scan-line or tiled, single-part EXR as floats with all its string, int, float and double
/// attributes. Errors: input Error.
Image read_exr(const std::filesystem::path& file);

/// Name of the spectral channel of a band centre in the layout of Fichet et al.:
/// `S0.362,500000nm`, whatever the locale; and the wavelength in such a name.
/// Source: Fichet, Pacanowski & Wilkie, JCGT 10(3), 2021.
std::string spectral_channel_name(double wavelength_nm);
std::optional<double> spectral_channel_wavelength_nm(const std::string& channel);

}  // namespace abbe
