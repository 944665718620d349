/// EXR files by OpenEXR itself, so that the bytes are reproducible.
#pragma once

#include <array>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "image/image.h"

namespace abbe {

struct ExrOptions {
  /// Half instead of float for colour (R, G, B, A, albedo.*) and normals (N.*). Other channels stay
  /// float: ids and depths need the digits, spectral radiances lie below what half resolves.
  bool half = false;
  /// Red, green, blue, white xy, written as the standard `chromaticities` attribute.
  std::optional<std::array<float, 8>> chromaticities;
};

/// Writes beside the target and renames: what stands at the target is always whole.
/// Errors: output Error.
void write_exr(const std::filesystem::path& file, const Image& image, const ExrOptions& options);

/// Reads a scan-line or tiled, single-part EXR as floats with all its string, int, float and double
/// attributes. Channels come as R, G, B, A, then spectral ones by wavelength, then others by name.
/// Domain: sides up to 65536, 2^28 pixels, 4096 channels, 2^31 values; not deep, not subsampled.
/// Errors: input Error.
Image read_exr(const std::filesystem::path& file);

/// What the header of an EXR file says.
struct ExrHeader {
  /// A channel and how it is stored: "half", "float" or "uint".
  struct Channel {
    std::string name, type;
  };
  std::vector<Channel> channels;  ///< In the order of read_exr.
  int width = 0;
  int height = 0;
  Vec2i data_origin{0, 0};
  Vec2i full_size{0, 0};  ///< As in Image: 0, 0 when the image is whole.
  std::string compression;
  std::optional<std::array<float, 8>> chromaticities;
  std::map<std::string, Attribute> attributes;
};

/// The header alone, without decoding a pixel. Errors: as read_exr.
ExrHeader read_exr_header(const std::filesystem::path& file);

/// Name of the spectral channel of a band centre in the layout of Fichet et al.:
/// `S0.362,500000nm`, whatever the locale; and the wavelength in such a name.
/// Source: Fichet, Pacanowski & Wilkie, JCGT 10(3), 2021.
std::string spectral_channel_name(double wavelength_nm);
std::optional<double> spectral_channel_wavelength_nm(const std::string& channel);

}  // namespace abbe
