#include "abbe/image/metrics/color_maps.h"

namespace abbe {

ColorMaps color_maps(const Image& rgb_rec709, const Image& reference_rgb_rec709,
                     const ColorViewing& options) {
  return {delta_e2000_map(rgb_rec709, reference_rgb_rec709),
          delta_e_itp_map(rgb_rec709, reference_rgb_rec709, options.white_cd_per_m2),
          flip_errors(rgb_rec709, reference_rgb_rec709, options.pixels_per_degree)};
}

}  // namespace abbe
