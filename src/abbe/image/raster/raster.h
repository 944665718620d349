/// Display images and textures by OpenImageIO.
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "abbe/image/image.h"

namespace abbe {

/// Attribute of a display image that names the display it is encoded for.
inline constexpr const char* kDisplayAttribute = "abbe:display";

/// How write_raster() turns numbers into codes.
struct RasterOptions {
  int bits = 8;  ///< 8, or 16 for PNG and TIFF; JPEG has 8 always.
  /// Adds noise of a triangular density over two codes before rounding: bands in gradients become
  /// grain, means stay. A pixel's noise follows from its place alone.
  bool dither = false;
};

/// Writes display-referred RGB in [0, 1] (clamped) as PNG, JPEG or TIFF, by the file's suffix,
/// rounded to the nearest code; NaN is black. What display the codes are for is said by
/// kDisplayAttribute, sRGB without it: in PNG by the chunks cICP, sRGB, gAMA and cHRM. Without a
/// date, so that the same pixels give the same bytes. Written beside the target and renamed.
/// Domain: bits 8 or 16. Errors: output Error.
void write_raster(const std::filesystem::path& file, const Image& rgb_encoded,
                  const RasterOptions& options = {});

/// A decoded texture: codes of 8 bits, or of 16 where the file has more than 8.
struct DecodedTexture {
  int width = 0;
  int height = 0;
  std::vector<std::uint8_t> rgba8;    ///< width·height·4 values, or empty
  std::vector<std::uint16_t> rgba16;  ///< width·height·4 values, or empty
};

/// Decodes a PNG, JPEG or WebP held in memory (glTF allows no others); row 0 at the top, grey and
/// missing alpha filled in. The content decides the format, not its label. Domain: at most 2^28
/// pixels, checked on the header before any allocation. Errors: input Error at `where`.
DecodedTexture decode_texture(std::span<const std::uint8_t> bytes, const std::string& where);

/// Any image OpenImageIO reads, as floats; a Radiance file (.hdr) as its header says its rows lie
/// and divided by its EXPOSURE and COLORCORR. Errors: input Error; also for a Radiance file whose
/// pixels follow each other in columns.
Image read_raster(const std::filesystem::path& file);

/// Whether the pixels of such a file are whole numbers, as a rule display codes. Errors: as above.
bool raster_has_codes(const std::filesystem::path& file);

}  // namespace abbe
