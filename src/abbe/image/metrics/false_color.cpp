#include "abbe/image/metrics/false_color.h"

#include <algorithm>
#include <cmath>

#include "abbe/image/channels.h"
#include "abbe/image/image_pair.h"
#include "abbe/image/metrics/heat_map.h"

namespace abbe {

Vec3f false_color(int ev) {
  if (ev == 0) return {0.20f, 0.62f, 0.26f};
  return heat_color(static_cast<double>(ev - kFalseColorLowest_ev) /
                    (kFalseColorHighest_ev - kFalseColorLowest_ev));
}

FalseColorImage false_color_image(const Image& rgb_rec709) {
  constexpr double kMiddleGrey = 0.18;
  const auto rgb = rgb_indices(rgb_rec709);
  FalseColorImage result;
  Image& picture = result.picture = same_window(rgb_rec709, {"R", "G", "B"});
  const std::size_t channels = rgb_rec709.channel_count();
  for (std::size_t p = 0; p < rgb_rec709.pixels.size() / channels; ++p) {
    const float* pixel = rgb_rec709.pixels.data() + p * channels;
    const double luminance =
        0.2126 * pixel[rgb[0]] + 0.7152 * pixel[rgb[1]] + 0.0722 * pixel[rgb[2]];  // ITU-R BT.709-6
    int ev = kFalseColorLowest_ev;
    if (luminance > 0.0) {
      ev =
          static_cast<int>(std::clamp(std::round(std::log2(luminance / kMiddleGrey)),
                                      double{kFalseColorLowest_ev}, double{kFalseColorHighest_ev}));
    }
    ++result.pixels[static_cast<std::size_t>(ev - kFalseColorLowest_ev)];
    const Vec3f color = false_color(ev);
    picture.pixels.insert(picture.pixels.end(), {color.x, color.y, color.z});
  }
  return result;
}

}  // namespace abbe
