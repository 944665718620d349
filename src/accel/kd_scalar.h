/// Queries of one ray in plain C++: the lowest level's traversal, and the one that counts.
#pragma once

#include "accel/kd_layout.h"
#include "accel/kd_tube.h"
#include "accel/query.h"

namespace abbe {

/// The nearest hit at t in (0, t_max); adds to `cost`.
Hit closest_hit_scalar(const KdView& view, const Ray& ray, VisibilityMask mask, QueryCost& cost);

/// Whether there is any hit at t in (0, t_max).
bool any_hit_scalar(const KdView& view, const Ray& ray, VisibilityMask mask);

}  // namespace abbe
