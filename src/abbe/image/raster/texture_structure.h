/// The frame of a PNG or JPEG held in memory, checked before a decoder sees it.
#pragma once

#include <cstdint>
#include <span>
#include <string>

namespace abbe {

/// The formats that glTF allows for textures, and all else.
enum class TextureFormat : std::uint8_t { Png, Jpeg, Other };

/// By the first bytes.
TextureFormat texture_format(std::span<const std::uint8_t> bytes);

/// What is wrong with the frame of a PNG (chunks, their check sums, the header's size) or a JPEG
/// (segments up to the scan, the mark at its end); empty if nothing. Truncated and damaged files
/// end here with a plain word: libpng prints its own errors, and libjpeg fills what is missing. A
/// size that no compression could have made of so few bytes ends here before it is allocated.
/// Source: PNG specification, 2nd ed., 5; ITU-T T.81, annex B.
std::string texture_structure_error(std::span<const std::uint8_t> bytes);

}  // namespace abbe
