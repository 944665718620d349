/// PNG as it is written: of RGB codes, with chunks that say what the codes mean.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace abbe {

/// The colour chunks of a PNG. Source: W3C, PNG Specification (Third Edition), 11.3.2.
struct PngTags {
  bool is_srgb = false;                  ///< sRGB, rendering intent relative colorimetric.
  std::optional<double> gamma;           ///< gAMA: the exponent that encodes, as in 1/2.2.
  std::array<double, 8> chromaticities;  ///< cHRM: white, red, green, blue xy.
  std::array<std::uint8_t, 4> cicp;  ///< cICP: primaries, transfer, matrix, range (ITU-T H.273).
};

/// The tags of images for a display of an ACES configuration by name; none for displays of no known
/// primaries.
std::optional<PngTags> png_tags_of_display(const std::string& display);

/// A whole PNG of width·height·3 codes, by libpng itself: the libraries behind OpenImageIO take
/// longer to load than a small picture takes to write. Errors: std::runtime_error.
std::vector<std::uint8_t> encode_png(int width, int height, std::span<const std::uint8_t> codes,
                                     const std::optional<PngTags>& tags);
std::vector<std::uint8_t> encode_png(int width, int height, std::span<const std::uint16_t> codes,
                                     const std::optional<PngTags>& tags);

/// The check sum of PNG and zlib. Source: ISO 3309, as in the PNG specification, annex D.
std::uint32_t png_crc(std::span<const std::uint8_t> bytes);

}  // namespace abbe
