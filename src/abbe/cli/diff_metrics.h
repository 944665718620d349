/// The numbers of `abbe diff`, and the thresholds that its user sets.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "abbe/image/image.h"
#include "abbe/image/metrics/flip.h"
#include "abbe/image/metrics/metrics.h"

namespace abbe {

struct DiffOptions {
  double pixels_per_degree = kFlipPixelsPerDegree;
  double white_cd_per_m2 = 100.0;  ///< Luminance of 1, 1, 1, for ΔE ITP.
};

/// What the colours of two images differ by, pixel by pixel.
struct ColorMaps {
  std::vector<float> delta_e2000, delta_e_itp, flip;
};

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
ColorMaps color_maps(const Image& rgb_rec709, const Image& reference_rgb_rec709,
                     const DiffOptions& options);

/// A limit of the user: `rmse=0.01`, `max@Z=0`, `psnr@spectral=40`, `flip=0.05`.
struct Threshold {
  std::string metric;   ///< One of diff_metric_names().
  std::string channel;  ///< A channel, `color`, `spectral` or, empty, all.
  double limit = 0.0;
};

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
