#include "image/metrics.h"

#include <algorithm>
#include <cmath>

#include "image/image_pair.h"

namespace abbe {
namespace {

// Keeps dark pixels from dominating the relative error.
constexpr double kRelativeFloor = 0.01;

ChannelMetrics metrics_of(const Image& image, std::size_t image_channel, const Image& reference,
                          std::size_t channel, double peak) {
  ChannelMetrics metrics;
  metrics.channel = reference.channels[channel];
  const std::size_t pixels = reference.pixels.size() / reference.channel_count();
  double squares = 0.0;
  double relative_squares = 0.0;
  std::size_t count = 0;
  for (std::size_t p = 0; p < pixels; ++p) {
    const double a = image.pixels[p * image.channel_count() + image_channel];
    const double b = reference.pixels[p * reference.channel_count() + channel];
    if (!std::isfinite(a) || !std::isfinite(b)) {
      const bool is_same = a == b || (std::isnan(a) && std::isnan(b));
      metrics.non_finite += is_same ? 0 : 1;
      continue;
    }
    const double difference = a - b;
    squares += difference * difference;
    relative_squares += difference * difference / (b * b + kRelativeFloor);
    metrics.max_abs = std::max(metrics.max_abs, std::abs(difference));
    ++count;
  }
  const auto n = static_cast<double>(std::max<std::size_t>(count, 1));
  metrics.rmse = std::sqrt(squares / n);
  metrics.relative_mse = relative_squares / n;
  metrics.psnr_db = 20.0 * std::log10(peak / metrics.rmse);
  return metrics;
}

}  // namespace

std::vector<ChannelMetrics> image_metrics(const Image& image, const Image& reference, double peak) {
  const std::vector<std::size_t> channels = matching_channels(image, reference);
  std::vector<ChannelMetrics> metrics;
  for (std::size_t c = 0; c < channels.size(); ++c) {
    metrics.push_back(metrics_of(image, channels[c], reference, c, peak));
  }
  return metrics;
}

}  // namespace abbe
