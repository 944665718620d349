/// The corners of a convex polyhedron that is given by its planes.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "accel/shapes.h"
#include "math/vec.h"

namespace abbe {

/// Corners of the intersection of half-spaces; none when it is empty, flat or unbounded.
/// Domain: unit normals; at most a few hundred planes (time grows with the fourth power).
std::optional<std::vector<Vec3d>> polyhedron_corners(std::span<const Plane> planes);

}  // namespace abbe
