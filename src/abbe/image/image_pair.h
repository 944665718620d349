/// Two images that are compared channel by channel.
#pragma once

#include <array>
#include <vector>

#include "abbe/image/image.h"

namespace abbe {

/// Errors: input Error when the sizes differ.
void check_same_size(const Image& image, const Image& reference);

/// Indices of R, G and B, `layer` in front of their names. Errors: input Error that lists the
/// channels there are.
std::array<std::size_t, 3> rgb_indices(const Image& image, const std::string& layer = "");

/// Index in `image` of each channel of the reference, by name.
/// Errors: input Error when the sizes differ or a channel is missing.
std::vector<std::size_t> matching_channels(const Image& image, const Image& reference);

}  // namespace abbe
