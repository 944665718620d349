/// The pixel that a camera sample belongs to, where its ray ends.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "abbe/caustics/flat/light/pixel_on_surface.h"
#include "abbe/integrate/integrator.h"

namespace abbe {

/// The pixel of a camera sample on the plane in which its ray ends. Units: metres.
/// Domain: unit normal.
inline PixelOnSurface pixel_on_surface(const CameraSample& sample, const PixelKernel& kernel,
                                       float distance_m, const Vec3f& normal) {
  PixelOnSurface pixel;
  if (!(kernel.radius_px > 0.0f)) return pixel;
  pixel.offset_px = sample.offset_px;
  pixel.radius_px = kernel.radius_px;
  pixel.cumulated = kernel.cumulated.data();
  // Where the plane is seen edge-on its pixels are cut short: they would be longer than what is
  // there of it.
  constexpr float kLeastFacing = 0.05f;
  const float facing = glm::dot(sample.direction, normal);
  const float divisor = std::copysign(std::max(std::abs(facing), kLeastFacing), facing);
  for (std::size_t k = 0; k < 2; ++k) {
    const Vec3f moved = sample.origin_per_px[k] + distance_m * sample.direction_per_px[k];
    const Vec3f on_plane = (facing * moved - glm::dot(moved, normal) * sample.direction) / divisor;
    pixel.shift -= sample.offset_px[static_cast<int>(k)] * on_plane;
    pixel.sides[k] = on_plane;
    pixel.reach_m += kernel.radius_px * glm::length(on_plane);
  }
  pixel.reach_m += glm::length(pixel.shift);
  return pixel;
}

}  // namespace abbe
