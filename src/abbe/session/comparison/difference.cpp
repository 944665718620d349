#include "abbe/session/comparison/difference.h"

#include <cmath>

#include "abbe/image/channels.h"

namespace abbe {

Image exposed(const Image& image, double exposure_ev) {
  Image result = same_window(image, {"R", "G", "B"});
  result.pixels = picked_values(image, rgb_channels(image).value());
  const auto gain = static_cast<float>(std::exp2(exposure_ev));
  for (float& value : result.pixels) value *= gain;
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
