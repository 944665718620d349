/// The part of a surface that a pixel sees.
#pragma once

#include <array>

#include "abbe/film/pixel_kernel.h"
#include "abbe/math/vec.h"

namespace abbe {

/// A part of a plane that light is averaged over: a pixel, as a camera projects it from a place
/// that a ray through it meets. A wavelength is lit or not at a place, so that the few samples of a
/// pixel would find a colour of a spectrum or miss it by chance; over the pixel it has a share, and
/// chance has none.
///
/// What is Δ pixels from the sample lies at place + (Δx·sides[0] + Δy·sides[1]) / (1 + Δ·closer): a
/// straight edge on the plane is one in the image.
struct PixelOnSurface {
  Vec2f offset_px{0.0f};                                 ///< Of the sample from the middle.
  std::array<Vec3f, 2> sides{Vec3f(0.0f), Vec3f(0.0f)};  ///< Of a pixel at the place.
  Vec2f closer{0.0f};                                    ///< How the plane comes up to the camera.
  float reach_m = 0.0f;                                  ///< From the place to its farthest corner.
  float radius_px = 0.0f;            ///< The kernel reaches so many times the sides to both sides.
  const float* cumulated = nullptr;  ///< PixelKernel::cumulated.

  /// Whether there is nothing to average over: a place is lit or not.
  bool is_point() const { return radius_px == 0.0f; }
};

}  // namespace abbe
