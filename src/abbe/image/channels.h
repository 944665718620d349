/// Channels of an image, picked by name or place.
#pragma once

#include <array>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "abbe/image/image.h"

namespace abbe {

/// An image of the same pixels in the same window, with other channels and nothing else yet.
Image same_window(const Image& image, std::vector<std::string> channels);

/// Values of channels by their places, interleaved in that order.
/// Domain: every place is below channel_count().
std::vector<float> picked_values(const Image& image, std::span<const std::size_t> channels);

/// The places of three channels that share the beginning of their names.
std::optional<std::array<std::size_t, 3>> channels_named(const Image& image,
                                                         const std::string& prefix,
                                                         const std::array<const char*, 3>& names);

/// The places of R, G and B.
std::optional<std::array<std::size_t, 3>> rgb_channels(const Image& image);

}  // namespace abbe
