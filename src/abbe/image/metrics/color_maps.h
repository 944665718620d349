/// Differences of colours as people see them, pixel by pixel.
#pragma once

#include <vector>

#include "abbe/image/image.h"
#include "abbe/image/metrics/flip.h"
#include "abbe/image/metrics/metrics.h"

namespace abbe {

/// How the images are looked at.
struct ColorViewing {
  double pixels_per_degree = kFlipPixelsPerDegree;
  double white_cd_per_m2 = 100.0;  ///< Luminance of 1, 1, 1, for ΔE ITP.
};

/// What the colours of two images differ by, pixel by pixel.
struct ColorMaps {
  std::vector<float> delta_e2000, delta_e_itp, flip;
};

/// Shape:  images with channels R, G, B, linear Rec.709, of one size; a value per pixel.
/// Errors: as the metrics.
ColorMaps color_maps(const Image& rgb_rec709, const Image& reference_rgb_rec709,
                     const ColorViewing& viewing = {});

}  // namespace abbe
