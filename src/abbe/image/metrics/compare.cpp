#include "abbe/image/metrics/compare.h"

#include <fmt/format.h>

#include <cmath>
#include <limits>

#include "abbe/base/error.h"
#include "abbe/image/image_pair.h"

namespace abbe {
namespace {

double error_of(float a, float b) {
  if (a == b || (std::isnan(a) && std::isnan(b))) return 0.0;
  const double difference = std::abs(static_cast<double>(a) - static_cast<double>(b));
  return std::isfinite(difference) ? difference : std::numeric_limits<double>::infinity();
}

void check_alike(const Image& image, const Image& reference) {
  if (image.data_origin != reference.data_origin || image.full_size != reference.full_size) {
    throw_input_error("", "another crop", "the reference's position in the full image");
  }
  if (image.channel_count() != reference.channel_count()) {
    throw_input_error("", std::to_string(image.channel_count()) + " channels",
                      "the reference's channels", reference.channels);
  }
}

}  // namespace

Comparison compare_images(const Image& image, const Image& reference,
                          const CompareThresholds& thresholds) {
  const std::vector<std::size_t> channels = matching_channels(image, reference);
  check_alike(image, reference);
  Comparison result;
  double sum = 0.0;
  double squares = 0.0;
  for (int y = 0; y < reference.height; ++y) {
    for (int x = 0; x < reference.width; ++x) {
      double pixel_error = 0.0;
      for (std::size_t c = 0; c < channels.size(); ++c) {
        const float value = image.at(x, y, channels[c]);
        const float expected = reference.at(x, y, c);
        const double error = error_of(value, expected);
        sum += error;
        squares += error * error;
        pixel_error = std::max(pixel_error, error);
        if (error > result.max_error) {
          result.max_error = error;
          result.worst_x = x;
          result.worst_y = y;
          result.worst_channel = reference.channels[c];
          result.worst_value = value;
          result.worst_reference = expected;
        }
      }
      result.failed_pixels += pixel_error > thresholds.fail ? 1 : 0;
      result.hard_failed_pixels += pixel_error > thresholds.hard_fail ? 1 : 0;
    }
  }
  const double pixels = static_cast<double>(reference.width) * reference.height;
  const double values = pixels * static_cast<double>(channels.size());
  result.mean_error = sum / values;
  result.rms_error = std::sqrt(squares / values);
  result.failed_percent = 100.0 * static_cast<double>(result.failed_pixels) / pixels;
  result.passed =
      result.failed_percent <= thresholds.fail_percent && result.hard_failed_pixels == 0;
  return result;
}

std::string Comparison::summary(const CompareThresholds& thresholds) const {
  if (max_error == 0.0) return "identical";
  return fmt::format(
      "{} pixels ({:.4g} %) beyond {}, {} beyond {}, worst {:.4g} at {},{} {}: {} for {}",
      failed_pixels, failed_percent, thresholds.fail, hard_failed_pixels, thresholds.hard_fail,
      max_error, worst_x, worst_y, worst_channel, worst_value, worst_reference);
}

}  // namespace abbe
