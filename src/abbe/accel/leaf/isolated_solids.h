/// Solids that stand alone: a ray inside meets nothing but their surface.
#pragma once

#include <cstdint>
#include <vector>

#include "abbe/accel/shapes.h"

namespace abbe {

/// 1 for every ellipsoid and polyhedron that no other primitive touches or reaches into, in the
/// order of their numbers. 0 where that is not certain, or would take too long to find out.
std::vector<std::uint8_t> find_isolated_solids(const ShapeSpans& shapes);

}  // namespace abbe
