/// What the builder moves around: a primitive and the box of its part inside the current cell.
#pragma once

#include <cstdint>

#include "abbe/accel/shapes.h"

namespace abbe {

/// A part of a primitive: its box, rounded outwards, and whose it is.
struct BuildPrimitive {
  float low[3];
  float high[3];
  std::uint32_t primitive;
};

/// The box of a whole primitive.
BuildPrimitive make_build_primitive(const ShapeSpans& shapes, std::uint32_t primitive);

/// Narrows `part` to the part of its primitive inside the cell, whose box it must overlap.
/// Triangles are clipped exactly, solids by their box. The box is rounded outwards but never leaves
/// the cell. Returns false when nothing of the primitive is inside.
bool clip_to_cell(const ShapeSpans& shapes, const Box3f& cell, BuildPrimitive& part);

}  // namespace abbe
