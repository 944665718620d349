/// The frame of a PNG, JPEG or WebP held in memory, checked before a decoder sees it.
#pragma once

#include <cstdint>
#include <span>
#include <string>

namespace abbe {

/// The formats that glTF and EXT_texture_webp allow for textures, and all else.
enum class TextureFormat : std::uint8_t { Png, Jpeg, WebP, Other };

/// By the first bytes.
TextureFormat texture_format(std::span<const std::uint8_t> bytes);

/// What is wrong with the frame of a PNG (chunks, their check sums, the header's size) or a JPEG
/// (segments up to the scan, the mark at its end); empty if nothing. Truncated and damaged files
/// end here with a plain word: libpng prints its own errors, and libjpeg fills what is missing. A
/// size that no compression could have made of so few bytes ends here before it is allocated (a
/// WebP is bounded by its format: 16383 pixels a side).
/// Source: PNG specification, 2nd ed., 5; ITU-T T.81, annex B; RFC 9649, 2.
std::string texture_structure_error(std::span<const std::uint8_t> bytes);

}  // namespace abbe
