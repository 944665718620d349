/// Golden images that failed, as pictures.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "abbe/image/image.h"
#include "abbe/image/metrics/compare.h"

namespace abbe {

/// An image with exactly these channels, in this order.
/// Errors: an input Error at `where` when one is missing.
Image with_channels(const Image& image, const std::vector<std::string>& channels,
                    const std::string& where);

/// Data URIs of PNGs by caption: reference, result and difference, which is white-hot from the
/// threshold of a hard failure on. Nothing when the sizes differ.
std::vector<std::pair<std::string, std::string>> failure_pictures(
    const Image& reference, const Image& image, const CompareThresholds& thresholds);

}  // namespace abbe
