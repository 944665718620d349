/// The exact search for the best split of a cell with few references.
#pragma once

#include <span>

#include "abbe/accel/kd/build/sah.h"

namespace abbe {

/// Up to so many references it is faster to compare all with all than to sort.
inline constexpr std::size_t kFewReferences = 64;

/// Rates the planes at both sides of every reference, on all axes, as SahCell::rate() does in the
/// order of axes and planes: the same best on every instruction set level.
/// Domain: at most kFewReferences.
void search_few(std::span<const BuildReference> references, SahCell& cell);

}  // namespace abbe
