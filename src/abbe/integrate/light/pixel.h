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
  Vec2f range_px(0.0f);  // From the sample to the kernel's end.
  for (int k = 0; k < 2; ++k) {
    const auto axis = static_cast<std::size_t>(k);
    const Vec3f turned = sample.direction_per_px[axis];
    const Vec3f moved = sample.origin_per_px[axis] + distance_m * turned;
    pixel.sides[axis] = (facing * moved - glm::dot(moved, normal) * sample.direction) / divisor;
    pixel.closer[k] = glm::dot(turned, normal) / divisor;
    range_px[k] = pixel.radius_px + std::abs(pixel.offset_px[k]);
    pixel.reach_m += range_px[k] * glm::length(pixel.sides[axis]);
  }
  // Nor does the plane's horizon come into the pixel.
  constexpr float kMostCloser = 0.5f;
  const float closer = glm::dot(glm::abs(pixel.closer), range_px);
  if (closer > kMostCloser) pixel.closer *= kMostCloser / closer;
  pixel.reach_m /= 1.0f - std::min(closer, kMostCloser);
  return pixel;
}

}  // namespace abbe
