/// The numbers of `abbe diff`, and the thresholds that its user sets.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "abbe/image/image.h"
#include "abbe/image/metrics/color_maps.h"

namespace abbe {

/// Two images in numbers.
struct Difference {
  std::vector<ChannelMetrics> channels;  ///< In the order of the reference.
  ChannelMetrics all;
  std::optional<ChannelMetrics> color;     ///< R, G and B together.
  std::optional<ChannelMetrics> spectral;  ///< All spectral channels together.
  std::optional<MapStatistics> delta_e2000, delta_e_itp, flip;
};

/// The images channel by channel, and their colours where there are linear Rec.709 versions.
/// Errors: input Error when sizes, crops or channels differ.
Difference difference_of(const Image& image, const Image& reference,
                         const std::optional<ColorMaps>& maps);

/// A limit of the user: `rmse=0.01`, `max@Z=0`, `psnr@spectral=40`, `flip=0.05`.
struct Threshold {
  std::string metric;   ///< One of diff_metric_names().
  std::string channel;  ///< A channel, `color`, `spectral` or, empty, all.
  double limit = 0.0;
};

/// What a threshold may be of: "rmse", "psnr", "de2000.max", ….
std::vector<std::string> diff_metric_names();

/// Errors: a usage Error that lists the metrics.
Threshold parse_threshold(const std::string& text);

/// The value that a threshold limits. Errors: a usage Error when the images have no such channel or
/// no colour.
double value_of(const Threshold& threshold, const Difference& difference);

/// Whether a value is past its limit: above it, for a signal-to-noise ratio below it. What is not a
/// number is past every limit.
bool is_exceeded(const Threshold& threshold, double value);

}  // namespace abbe
