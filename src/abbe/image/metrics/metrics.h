/// Differences of two images as numbers, channel by channel.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "abbe/image/image.h"

namespace abbe {

/// How far a channel of an image is from that of its reference.
struct ChannelMetrics {
  std::string channel;
  double rmse = 0.0;
  double max_abs = 0.0;
  int max_x = 0, max_y = 0;   ///< Where the largest difference is.
  double relative_mse = 0.0;  ///< Mean of (a − b)²/(b² + 0.01), b the reference.
  double psnr_db = 0.0;       ///< 20·log10(peak/rmse); infinite where rmse is 0.
  /// Pixels where one value is not finite and the other differs; not part of the means.
  std::size_t non_finite = 0;
  std::size_t count = 0;  ///< Pixels that the means are taken over.
};

/// Metrics of each channel of the reference, in its order.
/// Units:  those of the images; `peak` is the value of white.
/// Errors: input Error when the sizes differ or the image lacks a channel of the reference.
std::vector<ChannelMetrics> image_metrics(const Image& image, const Image& reference,
                                          double peak = 1.0);

/// The metrics of several channels as of one; `channel` is the name given.
ChannelMetrics combined_metrics(const std::vector<ChannelMetrics>& channels,
                                const std::string& name, double peak = 1.0);

/// Mean, 95th percentile and largest of the values of a map.
struct MapStatistics {
  double mean = 0.0, percentile_95 = 0.0, max = 0.0;
};
MapStatistics map_statistics(const std::vector<float>& map);

/// The CIEDE2000 difference of every pixel, white being D65 at 1.
/// Shape:  width × height values, row by row.
/// Units:  linear Rec.709 in R, G and B.
/// Errors: input Error when sizes differ or a channel R, G or B is missing.
std::vector<float> delta_e2000_map(const Image& rgb_rec709, const Image& reference_rgb_rec709);

/// The ΔE ITP difference of every pixel (ITU-R BT.2124); otherwise as delta_e2000_map.
std::vector<float> delta_e_itp_map(const Image& rgb_rec709, const Image& reference_rgb_rec709,
                                   double white_cd_per_m2 = 100.0);

/// The largest difference over the channels of every pixel, as in image_metrics; infinite where a
/// value is not finite and its partner is another.
std::vector<float> max_error_map(const Image& image, const Image& reference);

}  // namespace abbe
