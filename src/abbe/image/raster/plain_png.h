/// The PNG files that most textures are, decoded by libpng itself.
#pragma once

#include <cstdint>
#include <optional>
#include <span>

#include "abbe/image/raster/raster.h"

namespace abbe {

/// A PNG of 8 bits a channel in one pass, without palette, transparent key and damage; none for all
/// others, which OpenImageIO knows to read or to find fault with.
/// Domain: texture_structure_error() has found nothing; at most `max_pixels` are decoded.
std::optional<DecodedTexture> decode_plain_png(std::span<const std::uint8_t> bytes,
                                               std::int64_t max_pixels);

}  // namespace abbe
