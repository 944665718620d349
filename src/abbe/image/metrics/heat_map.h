/// Maps of one value per pixel as pictures.
#pragma once

#include <vector>

#include "abbe/image/image.h"

namespace abbe {

/// sRGB-encoded colour of a share: 0 is black, then blue, magenta, orange, and 1 a pale yellow.
/// Lightness rises evenly, so that the order shows without colour vision, too.
/// Domain: clamped to [0, 1]; what is not a number counts as 1.
Vec3f heat_color(double share);

/// A picture of a map, sRGB-encoded: heat_color(value / full_scale).
/// Domain: full_scale > 0; width × height values.
Image heat_map(const std::vector<float>& map, int width, int height, double full_scale);

}  // namespace abbe
