/// The query of one ray in plain C++, which counts its work. It gives the same bits as the kernels.
#pragma once

#include "abbe/accel/kd/layout.h"
#include "abbe/accel/kd/trace/beam.h"
#include "abbe/accel/query.h"

namespace abbe {

/// The nearest hit at t in (0, t_max); adds to `cost`.
Hit closest_hit_scalar(const KdView& view, const Ray& ray, VisibilityMask mask, QueryCost& cost);

/// Whether a ray meets anything; stops behind the first leaf where it does.
bool any_hit_scalar(const KdView& view, const Ray& ray, VisibilityMask mask, QueryCost& cost);

}  // namespace abbe
