#include "abbe/image/metrics/metrics.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "abbe/base/constants.h"
#include "abbe/base/parallel.h"
#include "abbe/color/color.h"
#include "abbe/color/itp.h"
#include "abbe/image/image_pair.h"

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
    if (std::abs(difference) > metrics.max_abs) {
      metrics.max_abs = std::abs(difference);
      metrics.max_x = static_cast<int>(p % static_cast<std::size_t>(reference.width));
      metrics.max_y = static_cast<int>(p / static_cast<std::size_t>(reference.width));
    }
    ++metrics.count;
  }
  const auto n = static_cast<double>(std::max<std::size_t>(metrics.count, 1));
  metrics.rmse = std::sqrt(squares / n);
  metrics.relative_mse = relative_squares / n;
  metrics.psnr_db = 20.0 * std::log10(peak / metrics.rmse);
  return metrics;
}

// Calls body(p, a, b) with the linear Rec.709 of both images for every pixel.
template <typename Body>
std::vector<float> color_map(const Image& image, const Image& reference, const Body& body) {
  check_same_size(image, reference);
  const auto channels = rgb_indices(image);
  const auto reference_channels = rgb_indices(reference);
  const auto color = [](const Image& from, const std::array<std::size_t, 3>& rgb, std::size_t p) {
    const float* pixel = from.pixels.data() + p * from.channel_count();
    return Vec3d(pixel[rgb[0]], pixel[rgb[1]], pixel[rgb[2]]);
  };
  std::vector<float> map(static_cast<std::size_t>(image.width) *
                         static_cast<std::size_t>(image.height));
  parallel_for(0, map.size(), 1024, [&](std::size_t p) {
    map[p] = static_cast<float>(
        body(color(image, channels, p), color(reference, reference_channels, p)));
  });
  return map;
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

ChannelMetrics combined_metrics(const std::vector<ChannelMetrics>& channels,
                                const std::string& name, double peak) {
  ChannelMetrics all;
  all.channel = name;
  double squares = 0.0;
  double relative_squares = 0.0;
  for (const ChannelMetrics& one : channels) {
    const auto n = static_cast<double>(one.count);
    squares += n * one.rmse * one.rmse;
    relative_squares += n * one.relative_mse;
    all.count += one.count;
    all.non_finite += one.non_finite;
    if (one.max_abs > all.max_abs) {
      all.max_abs = one.max_abs;
      all.max_x = one.max_x;
      all.max_y = one.max_y;
    }
  }
  const auto n = static_cast<double>(std::max<std::size_t>(all.count, 1));
  all.rmse = std::sqrt(squares / n);
  all.relative_mse = relative_squares / n;
  all.psnr_db = 20.0 * std::log10(peak / all.rmse);
  return all;
}

MapStatistics map_statistics(const std::vector<float>& map) {
  MapStatistics statistics;
  if (map.empty()) return statistics;
  double sum = 0.0;
  for (const float value : map) sum += static_cast<double>(value);
  statistics.mean = sum / static_cast<double>(map.size());
  std::vector<float> sorted = map;
  const auto rank =
      static_cast<std::ptrdiff_t>(std::ceil(0.95 * static_cast<double>(map.size())) - 1.0);
  std::nth_element(sorted.begin(), sorted.begin() + rank, sorted.end());
  statistics.percentile_95 = static_cast<double>(sorted[static_cast<std::size_t>(rank)]);
  statistics.max = static_cast<double>(*std::max_element(map.begin(), map.end()));
  return statistics;
}

std::vector<float> delta_e2000_map(const Image& rgb_rec709, const Image& reference_rgb_rec709) {
  const Mat3d to_xyz = rec709_to_xyz();
  const Vec3d white = xyz_of_xy(kD65_xy);
  return color_map(rgb_rec709, reference_rgb_rec709, [&](const Vec3d& a, const Vec3d& b) {
    return delta_e2000(lab_of_xyz(to_xyz * a, white), lab_of_xyz(to_xyz * b, white));
  });
}

std::vector<float> delta_e_itp_map(const Image& rgb_rec709, const Image& reference_rgb_rec709,
                                   double white_cd_per_m2) {
  const Mat3d to_xyz = rec709_to_xyz();
  return color_map(rgb_rec709, reference_rgb_rec709, [&](const Vec3d& a, const Vec3d& b) {
    return delta_e_itp(ictcp_of_xyz(white_cd_per_m2 * (to_xyz * a)),
                       ictcp_of_xyz(white_cd_per_m2 * (to_xyz * b)));
  });
}

std::vector<float> max_error_map(const Image& image, const Image& reference) {
  const std::vector<std::size_t> channels = matching_channels(image, reference);
  std::vector<float> map(static_cast<std::size_t>(image.width) *
                         static_cast<std::size_t>(image.height));
  parallel_for(0, map.size(), 1024, [&](std::size_t p) {
    for (std::size_t c = 0; c < channels.size(); ++c) {
      const float a = image.pixels[p * image.channel_count() + channels[c]];
      const float b = reference.pixels[p * reference.channel_count() + c];
      if (a == b || (std::isnan(a) && std::isnan(b))) continue;
      const float error = std::abs(a - b);
      map[p] = std::max(map[p], std::isfinite(error) ? error : kInfinity);
    }
  });
  return map;
}

}  // namespace abbe
