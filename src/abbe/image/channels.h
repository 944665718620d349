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

/// One pixel of middle grey in R, G and B: what settings are tried on.
Image grey_pixel();

/// Values of channels by their places, interleaved in that order.
/// Domain: every place is below channel_count().
std::vector<float> picked_values(const Image& image, std::span<const std::size_t> channels);

/// The places of channels by their names, in that order.
/// Errors: an input Error at `where` that lists them when one is missing.
std::vector<std::size_t> channel_places(const Image& image, const std::vector<std::string>& names,
                                        const std::string& where = "");

/// The places of three channels that share the beginning of their names.
std::optional<std::array<std::size_t, 3>> channels_named(const Image& image,
                                                         const std::string& prefix,
                                                         const std::array<const char*, 3>& names);

/// The places of R, G and B.
std::optional<std::array<std::size_t, 3>> rgb_channels(const Image& image);

}  // namespace abbe
