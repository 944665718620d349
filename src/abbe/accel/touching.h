/// Which primitives lie so close to those of other bodies that they may touch.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "abbe/accel/shapes.h"

namespace abbe {

/// For every primitive whose bounds come near those of primitives of other bodies, where one of the
/// two is of a surface that matters, the largest coordinate of it and them; 0 for others. Empty if
/// there is none. The bodies of a surface are its pieces that share no position of a vertex, of
/// surfaces that do not matter all of it.
/// Shape: a surface per primitive; `matters` a value per surface.
/// Units: near is within `margin_m`.
std::vector<float> find_touching(const ShapeSpans& shapes,
                                 std::span<const std::uint32_t> primitive_surface,
                                 std::span<const std::uint8_t> matters, float margin_m);

}  // namespace abbe
