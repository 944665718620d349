/// FLIP: what the eye sees when two images take turns on a screen.
#pragma once

#include <vector>

#include "abbe/image/image.h"

namespace abbe {

/// Pixels per degree of a screen 0.7 m wide of 3840 pixels, seen from 0.7 m: the default of FLIP.
inline constexpr double kFlipPixelsPerDegree =
    0.7 * (3840.0 / 0.7) * 3.14159265358979323846 / 180.0;

/// The error of every pixel, from 0 (none) to 1.
/// Shape:  width × height values, row by row.
/// Units:  linear Rec.709 in R, G and B, 1 the white of the screen; clamped to [0, 1].
/// Domain: pixels_per_degree from 1 to 1000.
/// Errors: input Error when sizes differ or a channel R, G or B is missing.
/// Source: Andersson, Nilsson, Akenine-Möller, Oskarsson, Åström & Fairchild, Proc. ACM Comput.
///         Graph. Interact. Tech. 3(2), 2020.
std::vector<float> flip_errors(const Image& rgb_rec709, const Image& reference_rgb_rec709,
                               double pixels_per_degree = kFlipPixelsPerDegree);

}  // namespace abbe
