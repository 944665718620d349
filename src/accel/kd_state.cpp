#include "accel/kd_state.h"

#include "accel/solids.h"

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

std::uint32_t test_solid_lanes(const KdView& view, std::uint32_t primitive, PacketState& packet) {
  const std::uint32_t ellipsoid = primitive - view.triangle_count;
  std::uint32_t found = 0;
  for (int lane = 0; lane < kPacketLanes; ++lane) {
    if ((packet.active >> lane & 1u) == 0) continue;
    const Ray ray{
        {packet.origin[0][lane], packet.origin[1][lane], packet.origin[2][lane]},
        kInfinity,
        {packet.direction[0][lane], packet.direction[1][lane], packet.direction[2][lane]}};
    // The segment ends at the nearest hit; one at the same distance may still have a lower number.
    Hit hit{packet.hits.t[lane], packet.hits.primitive[lane], 0.0f, 0.0f};
    std::optional<SolidHit> h;
    if (ellipsoid < view.ellipsoid_count) {
      h = intersect_ellipsoid(ray, view.ellipsoids[ellipsoid]);
    } else {
      const ConvexPolyhedron& solid = view.polyhedra[ellipsoid - view.ellipsoid_count];
      h = intersect_polyhedron(ray, {view.planes + solid.first_plane, solid.plane_count});
    }
    if (!h) continue;
    const auto t = static_cast<float>(h->t);
    if (t < hit.t || (t == hit.t && hit.is_hit() && primitive < hit.primitive)) {
      packet.hits.t[lane] = t;
      packet.hits.primitive[lane] = primitive;
      packet.hits.u[lane] = static_cast<float>(h->face);
      packet.hits.v[lane] = 0.0f;
      found |= 1u << lane;
    }
  }
  return found;
}

}  // namespace abbe
