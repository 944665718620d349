/// The filter of a film along one axis, for light that is averaged over it in closed form.
#pragma once

#include <array>

namespace abbe {

/// A filter that is nowhere negative, by its integral.
struct PixelKernel {
  static constexpr int kCells = 64;
  float radius_px = 0.0f;  ///< 0: nothing is averaged.
  /// The integral of the filter from its left end, at equidistant places up to the right end: from
  /// 0 to 1, never falling.
  std::array<float, kCells + 1> cumulated{};
};

}  // namespace abbe
