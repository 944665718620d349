/// Two images that are compared channel by channel.
#pragma once

#include <vector>

#include "image/image.h"

namespace abbe {

/// Index in `image` of each channel of the reference, by name.
/// Errors: input Error when the sizes differ or a channel is missing.
std::vector<std::size_t> matching_channels(const Image& image, const Image& reference);

}  // namespace abbe
