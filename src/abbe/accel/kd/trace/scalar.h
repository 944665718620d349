/// Queries of one ray in plain C++, which count their work. They give the same bits as the kernels.
#pragma once

#include <span>

#include "abbe/accel/kd/layout.h"
#include "abbe/accel/leaf/visibility.h"
#include "abbe/accel/query.h"

namespace abbe {

/// The nearest hit at t in (0, t_max), or with `any` whether there is one: such a search stops
/// behind the first leaf where something is met. Adds to `cost`.
Hit search_nearest(const KdView& view, const Visibility& visibility, const Ray& ray, QueryMask mask,
                   bool any, QueryCost& cost);

/// All hits of each ray, as Accelerator::all_hits() has them, appended to `hits`.
void search_all(const KdView& view, const Visibility& visibility, std::span<const Ray> rays,
                QueryMask mask, VisibilityMask stops, HitLists& hits);

}  // namespace abbe
