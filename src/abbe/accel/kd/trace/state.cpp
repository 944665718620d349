#include "abbe/accel/kd/trace/state.h"

#include "abbe/accel/leaf/solids.h"

namespace abbe {

void RayState::test_solid(std::uint32_t primitive, const KdView& view, VisibilityMask mask) {
  const std::uint32_t ellipsoid = primitive - view.triangle_count;
  if (ellipsoid < view.ellipsoid_count) {
    if (const auto h = intersect_ellipsoid(*ray, view.ellipsoids[ellipsoid])) {
      accept(static_cast<float>(h->t), primitive, 0.0f, 0.0f, view, mask);
    }
    return;
  }
  const ConvexPolyhedron& solid = view.polyhedra[ellipsoid - view.ellipsoid_count];
  if (const auto h =
          intersect_polyhedron(*ray, {view.planes + solid.first_plane, solid.plane_count})) {
    accept(static_cast<float>(h->t), primitive, static_cast<float>(h->face), 0.0f, view, mask);
  }
}

}  // namespace abbe
