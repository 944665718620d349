/// EXR files by OpenEXR itself, so that the bytes are reproducible.
#pragma once

#include <array>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "abbe/image/image.h"

namespace abbe {

/// How an EXR file is laid out.
struct ExrOptions {
  /// Half instead of float for colour (R, G, B, A and what ends in .R, .G, .B) and normals (N.*).
  /// Other channels stay float: depths need the digits, spectral radiances lie below what half
  /// resolves.
  bool half = false;
  std::string compression = "zip";  ///< One of exr_compressions().
  int tile_size = 0;                ///< Side of square tiles; 0: scan lines.
  /// A part for R, G, B, A, one for the spectral channels and one for each layer of the others.
  bool multi_part = false;
  /// Red, green, blue, white xy, written as the standard `chromaticities` attribute.
  std::optional<std::array<float, 8>> chromaticities = {};
};

/// "none", "rle", "zips", "zip", "piz", "pxr24", "b44", "b44a", "dwaa", "dwab".
std::vector<std::string> exr_compressions();

/// Checks options before any work. Errors: a usage Error for an unknown compression or a tile size
/// beyond 8 to 4096.
void check_exr_options(const ExrOptions& options);

/// Writes beside the target and renames: what stands at the target is always whole. Channels with
/// id names are stored as unsigned integers, their names in the standard `idManifest` attribute.
/// Errors: output Error; otherwise as check_exr_options.
void write_exr(const std::filesystem::path& file, const Image& image, const ExrOptions& options);

/// Reads an EXR of scan lines or tiles, of one or several parts, as floats with all its string,
/// int, float and double attributes and its id names. The parts of a file make one image; where two
/// have a channel of the same name, the later one gets the name of its part in front. Channels come
/// as R, G, B, A, then spectral ones by wavelength, then others by name.
/// Domain: sides up to 65536, 2^28 pixels, 4096 channels, 2^31 values; not deep, not subsampled,
///         all parts of one size.
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
  int tile_size = 0;  ///< Width of a tile; 0: scan lines.
  int part_count = 1;
  bool has_named_parts = false;  ///< As ExrOptions::multi_part makes them, even where one is all.
  std::optional<std::array<float, 8>> chromaticities;
  std::map<std::string, Attribute> attributes;
  std::vector<IdNames> id_names;
};

/// The header alone, without decoding a pixel. Errors: as read_exr.
ExrHeader read_exr_header(const std::filesystem::path& file);

/// Name of the spectral channel of a band centre in the layout of Fichet et al.:
/// `S0.362,500000nm`, whatever the locale; and the wavelength in such a name.
/// Source: Fichet, Pacanowski & Wilkie, JCGT 10(3), 2021.
std::string spectral_channel_name(double wavelength_nm);
std::optional<double> spectral_channel_wavelength_nm(const std::string& channel);

/// The same for the reflectance of a band: `T.362,500000nm`.
std::string reflective_channel_name(double wavelength_nm);
std::optional<double> reflective_channel_wavelength_nm(const std::string& channel);

}  // namespace abbe
