/// Lamps that have an extent, as places that they shine from.
#pragma once

#include <optional>

#include "abbe/math/vec.h"
#include "abbe/scene/scene.h"

namespace abbe {

/// The extent of a lamp in the world. Flat ones lie across the direction in which it shines.
struct LampExtent {
  LampShape shape;
  Vec3f x{1.0f, 0.0f, 0.0f}, y{0.0f, 1.0f, 0.0f};  ///< Unit vectors across that direction.

  bool is_flat() const {
    return std::holds_alternative<RectangleLamp>(shape) || std::holds_alternative<DiskLamp>(shape);
  }
};

/// A place on a lamp, drawn for one that it shines on.
struct LampSpot {
  Vec3f position{0.0f};
  Vec3f normal{0.0f};  ///< Of unit length, to the side that shines.
  float per_m2 = 0.0f;
  float radiance = 0.0f;  ///< Over the lamp's intensity, m⁻².
};

/// Draws by solid angle on rectangles and balls, by area on disks. Absent where the lamp does not
/// shine, behind a flat one or within a ball.
/// Domain: u in [0, 1)²; not a sky disc. `middle` and `direction` are the lamp's.
std::optional<LampSpot> spot_on_lamp(const LampExtent& extent, const Vec3f& middle,
                                     const Vec3f& direction, const Vec3f& from, const Vec2f& u);

/// A direction to a disc on the sky about `to_middle`, evenly by solid angle, and what arrives
/// across it, over the illuminance on what faces the middle: L·Ω = 2/(1 + cos α).
struct SkyDiscRay {
  Vec3f direction{0.0f};
  float irradiance = 0.0f;
};
SkyDiscRay direction_to_disc(const LampExtent& extent, const Vec3f& to_middle, const Vec2f& u);

}  // namespace abbe
