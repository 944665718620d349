/// What a PNG says about the meaning of its numbers.
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

/// A PNG with these colour chunks behind its header, and no others.
/// Domain: `png` is a whole, valid PNG.
std::vector<std::uint8_t> with_tags(std::span<const std::uint8_t> png, const PngTags& tags);

/// The check sum of PNG and zlib. Source: ISO 3309, as in the PNG specification, annex D.
std::uint32_t png_crc(std::span<const std::uint8_t> bytes);

}  // namespace abbe
