/// What an image differs by from the spectral one.
#pragma once

#include "abbe/image/image.h"
#include "abbe/image/metrics/color_maps.h"

namespace abbe {

/// An image against the spectral one.
struct ModeDifference {
  ColorMaps maps;
  double rmse = 0.0;  ///< Of linear R, G and B.
};

/// White is D65; 1, 1, 1 at `exposure_ev` is L* = 100. Differences are taken of linear Rec.709 as
/// the film has developed it, negative channels and all.
ModeDifference mode_difference(const Image& image, const Image& reference, double exposure_ev);

/// The linear R, G and B of an image, brightened.
Image exposed(const Image& image, double exposure_ev);

}  // namespace abbe
