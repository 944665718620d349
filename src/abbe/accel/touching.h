/// Which primitives lie so close to those of other bodies that they may touch.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "abbe/accel/shapes.h"

namespace abbe {

/// Where a primitive may touch others.
struct Touching {
  float size_m = 0.0f;  ///< The largest coordinate of it and of them; 0: nowhere.
  Box3f zone;           ///< Holds all such places.

  bool is_any() const { return size_m > 0.0f; }

  /// Whether a ray that meets the primitive there may find another one next to it, as far along the
  /// ray as its rounding errors go that come from so far.
  bool holds(const Vec3f& place, float distance_m) const {
    const Vec3f slack_m(3e-4f * (size_m + distance_m));
    return is_any() && glm::all(glm::lessThanEqual(zone.low - slack_m, place)) &&
           glm::all(glm::lessThanEqual(place, zone.high + slack_m));
  }
};

/// Of every primitive that comes near those of other bodies, where one of the two is of a surface
/// that matters, where it does. Empty if there is none. The bodies of a surface are its pieces that
/// share no position of a vertex, of surfaces that do not matter all of it.
/// Shape: a surface per primitive; `matters` a value per surface.
/// Units: near is within `margin_m`.
std::vector<Touching> find_touching(const ShapeSpans& shapes,
                                    std::span<const std::uint32_t> primitive_surface,
                                    std::span<const std::uint8_t> matters, float margin_m);

}  // namespace abbe
