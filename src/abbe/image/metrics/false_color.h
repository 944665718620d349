/// Exposure as colours.
#pragma once

#include <array>
#include <cstddef>

#include "abbe/image/image.h"

namespace abbe {

/// Stops around middle grey that false colours tell apart: all below the first are one, all above
/// the last, too.
inline constexpr int kFalseColorLowest_ev = -8;
inline constexpr int kFalseColorHighest_ev = 7;
inline constexpr std::size_t kFalseColorZones = kFalseColorHighest_ev - kFalseColorLowest_ev + 1;

/// What false_color_image() makes.
struct FalseColorImage {
  Image picture;  ///< sRGB-encoded.
  /// Pixels of each zone, from the lowest: zone i is luminances around 0.18·2^(lowest + i).
  std::array<std::size_t, kFalseColorZones> pixels{};
};

/// The colour of a zone: heat_color from dark to bright, the zone of middle grey green.
Vec3f false_color(int ev);

/// Luminance in whole stops above and below 0.18.
/// Units:  linear Rec.709. What is black or not a number is in the lowest zone.
/// Errors: input Error when a channel R, G or B is missing.
FalseColorImage false_color_image(const Image& rgb_rec709);

}  // namespace abbe
