/// How well the triangles of a scene share their vertices.
#pragma once

#include "abbe/accel/shapes.h"

namespace abbe {

/// The mean number of triangles that meet in a vertex: about 6 in a closed mesh, 1 where every
/// triangle is apart. Vertices are the same when their positions are equal, whatever their numbers.
/// Estimated from one position in 64, chosen by its bits; 6 where there are too few to tell.
double triangles_per_vertex(const ShapeSpans& shapes);

}  // namespace abbe
