/// The exact search for the best split of a cell with few primitives.
#pragma once

#include <span>

#include "abbe/accel/kd/build/sah.h"

namespace abbe {

/// Up to so many primitives it is faster to compare all with all than to sort.
inline constexpr std::size_t kFewPrimitives = 64;

/// Rates the planes at both sides of every primitive, on all axes, as SahCell::rate() does in the
/// order of axes and planes: the same best on every instruction set level.
/// Domain: at most kFewPrimitives.
void search_few(std::span<const BuildPrimitive> primitives, SahCell& cell);

}  // namespace abbe
