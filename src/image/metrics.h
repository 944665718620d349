/// Differences of two images as numbers, channel by channel.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "image/image.h"

namespace abbe {

struct ChannelMetrics {
  std::string channel;
  double rmse = 0.0;
  double max_abs = 0.0;
  double relative_mse = 0.0;  ///< Mean of (a − b)²/(b² + 0.01), b the reference.
  double psnr_db = 0.0;       ///< 20·log10(peak/rmse); infinite where rmse is 0.
  /// Pixels where one value is not finite and the other differs; not part of the means.
  std::size_t non_finite = 0;
};

/// Metrics of each channel of the reference, in its order.
/// Units:  those of the images; `peak` is the value of white.
/// Errors: input Error when the sizes differ or the image lacks a channel of the reference.
std::vector<ChannelMetrics> image_metrics(const Image& image, const Image& reference,
                                          double peak = 1.0);

}  // namespace abbe
