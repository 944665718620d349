#include "abbe/session/comparison/difference.h"

#include <cmath>

namespace abbe {

Image exposed(const Image& image, double exposure_ev) {
  Image result;
  result.width = image.width;
  result.height = image.height;
  result.channels = {"R", "G", "B"};
  const std::size_t channels = image.channel_count();
  const std::size_t r = *image.channel_index("R"), g = *image.channel_index("G"),
                    b = *image.channel_index("B");
  const auto gain = static_cast<float>(std::exp2(exposure_ev));
  const std::size_t pixels = image.pixels.size() / channels;
  result.pixels.reserve(3 * pixels);
  for (std::size_t p = 0; p < pixels; ++p) {
    const float* in = image.pixels.data() + p * channels;
    result.pixels.insert(result.pixels.end(), {gain * in[r], gain * in[g], gain * in[b]});
  }
  return result;
}

ModeDifference mode_difference(const Image& image, const Image& reference, double exposure_ev) {
  const Image here = exposed(image, exposure_ev), there = exposed(reference, exposure_ev);
  ModeDifference difference;
  difference.maps = color_maps(here, there);
  difference.rmse =
      combined_metrics(image_metrics(exposed(image, 0.0), exposed(reference, 0.0)), "color").rmse;
  return difference;
}

}  // namespace abbe
