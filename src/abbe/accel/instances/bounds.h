/// Bounds of meshes at their places.
#pragma once

#include <span>
#include <vector>

#include "abbe/accel/shapes.h"

namespace abbe {

/// Boxes in mesh space that hold parts of a mesh, all of it together: at most 64, so that bounds at
/// any place are nearly tight and cost little.
std::vector<Box3f> boxes_of_parts(std::span<const Vec3f> positions,
                                  std::span<const Triangle> triangles);

/// The box about boxes at linear·p + offset_m, rounded outwards.
Box3f bounds_at(std::span<const Box3f> boxes, const Mat3d& linear, const Vec3d& offset_m);

}  // namespace abbe
