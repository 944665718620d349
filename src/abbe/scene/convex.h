/// Questions about convex bodies given by planes.
#pragma once

#include <vector>

#include "abbe/scene/scene.h"

namespace abbe {

/// The corners: where three planes meet and no other cuts the point off. Corners in which more than
/// three planes meet come several times; an empty body has none.
/// Units:  metres in the shape's space.
std::vector<Vec3d> corners_of(const ConvexShape& shape);

/// Whether the planes enclose a body of finite size.
bool is_bounded(const ConvexShape& shape);

}  // namespace abbe
