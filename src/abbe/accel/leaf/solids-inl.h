/// Solids against the sixteen rays of a packet, in double precision: the operations of solids.cpp
/// in the same order, so that a ray gets the same answer alone and in a packet. Compiled once for
/// each instruction set level.

#if defined(ABBE_ACCEL_LEAF_SOLIDS_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef ABBE_ACCEL_LEAF_SOLIDS_INL_H_
#undef ABBE_ACCEL_LEAF_SOLIDS_INL_H_
#else
#define ABBE_ACCEL_LEAF_SOLIDS_INL_H_
#endif

#include <hwy/highway.h>

#include <limits>
#include <span>

#include "abbe/accel/leaf/lanes-inl.h"
#include "abbe/accel/leaf/packet.h"
#include "abbe/accel/leaf/solids.h"

HWY_BEFORE_NAMESPACE();
namespace abbe {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

using WideD = hn::CappedTag<double, 8>;
using WideV = hn::Vec<WideD>;
using HalfF = hn::Rebind<float, WideD>;

struct WideVec3 {
  WideV x, y, z;
};

// The rays of a packet or of two, wherever they lie.
template <int kLanes>
struct LaneRays {
  const float* origin[3];
  const float* direction[3];
};

HWY_INLINE WideVec3 LoadVec3(const float* const rows[3], std::size_t i) {
  const WideD d;
  const HalfF f;
  return {hn::PromoteTo(d, hn::LoadU(f, rows[0] + i)), hn::PromoteTo(d, hn::LoadU(f, rows[1] + i)),
          hn::PromoteTo(d, hn::LoadU(f, rows[2] + i))};
}

HWY_INLINE WideV Dot(const WideVec3& a, const WideVec3& b) {
  return hn::Add(hn::Add(hn::Mul(a.x, b.x), hn::Mul(a.y, b.y)), hn::Mul(a.z, b.z));
}

HWY_INLINE WideV DotWith(const Vec3d& a, const WideVec3& b) {
  const WideD d;
  return hn::Add(hn::Add(hn::Mul(hn::Set(d, a.x), b.x), hn::Mul(hn::Set(d, a.y), b.y)),
                 hn::Mul(hn::Set(d, a.z), b.z));
}

HWY_INLINE WideVec3 Transform(const Mat3d& m, const WideVec3& v) {
  return {DotWith({m[0][0], m[1][0], m[2][0]}, v), DotWith({m[0][1], m[1][1], m[2][1]}, v),
          DotWith({m[0][2], m[1][2], m[2][2]}, v)};
}

// The first of two roots that a float has between 0 and infinity, else infinity.
HWY_INLINE hn::Vec<HalfF> FirstRoot(WideV first, WideV second) {
  const HalfF f;
  const auto zero = hn::Zero(f);
  const auto never = hn::Set(f, kInfinity);
  const auto one = hn::DemoteTo(f, first);
  const auto two = hn::DemoteTo(f, second);
  const auto is_two = hn::And(hn::Gt(two, zero), hn::Lt(two, never));
  const auto is_one = hn::And(hn::Gt(one, zero), hn::Lt(one, never));
  return hn::IfThenElse(is_one, one, hn::IfThenElse(is_two, two, never));
}

// Distances to an ellipsoid for the lanes of the packet; infinity where it is not met.
template <int kLanes>
HWY_INLINE void EllipsoidLanes(const Ellipsoid& ellipsoid, const LaneRays<kLanes>& p, float* t) {
  const WideD d;
  const HalfF f;
  const Vec3d& offset = ellipsoid.world_to_unit_offset;
  for (std::size_t i = 0; i < kLanes; i += hn::Lanes(d)) {
    WideVec3 o = Transform(ellipsoid.world_to_unit_linear, LoadVec3(p.origin, i));
    o = {hn::Add(o.x, hn::Set(d, offset.x)), hn::Add(o.y, hn::Set(d, offset.y)),
         hn::Add(o.z, hn::Set(d, offset.z))};
    const WideVec3 v = Transform(ellipsoid.world_to_unit_linear, LoadVec3(p.direction, i));
    const WideV one = hn::Set(d, 1.0);
    const WideV zero = hn::Zero(d);
    const WideV vv = Dot(v, v);
    const WideV closest = hn::Div(hn::Neg(Dot(o, v)), vv);
    const WideVec3 q = {hn::Add(o.x, hn::Mul(closest, v.x)), hn::Add(o.y, hn::Mul(closest, v.y)),
                        hn::Add(o.z, hn::Mul(closest, v.z))};
    const WideV inside = hn::Sub(one, Dot(q, q));
    const auto is_met = hn::Ge(inside, zero);
    if (hn::AllFalse(d, is_met)) {
      hn::StoreU(hn::Set(f, kInfinity), f, t + i);
      continue;
    }
    const WideV half_chord = hn::Sqrt(hn::Div(hn::Max(inside, zero), vv));
    const WideV c = hn::Sub(Dot(o, o), one);
    const WideV far = hn::IfThenElse(hn::Ge(closest, zero), hn::Add(closest, half_chord),
                                     hn::Sub(closest, half_chord));
    const WideV near = hn::IfThenElse(hn::Ne(far, zero), hn::Div(c, hn::Mul(vv, far)), zero);
    const WideV never = hn::Set(d, std::numeric_limits<double>::infinity());
    const WideV first = hn::IfThenElse(is_met, hn::Min(near, far), never);
    const WideV second = hn::IfThenElse(is_met, hn::Max(near, far), never);
    hn::StoreU(FirstRoot(first, second), f, t + i);
  }
}

// The same for a polyhedron, with the face that was met.
template <int kLanes>
HWY_INLINE void PolyhedronLanes(std::span<const Plane> planes, const LaneRays<kLanes>& p, float* t,
                                float* face) {
  const WideD d;
  const HalfF f;
  const WideV zero = hn::Zero(d);
  const WideV never = hn::Set(d, std::numeric_limits<double>::infinity());
  for (std::size_t i = 0; i < kLanes; i += hn::Lanes(d)) {
    const WideVec3 o = LoadVec3(p.origin, i);
    const WideVec3 v = LoadVec3(p.direction, i);
    // As intersect_polyhedron() has it.
    const WideV one = hn::Set(d, 1.0);
    WideV enter_distance = hn::Neg(one), enter_slope = zero;
    WideV leave_distance = one, leave_slope = zero;
    WideV enter_face = zero, leave_face = zero;
    auto is_outside = hn::Lt(zero, zero);
    double number = 0.0;
    for (const Plane& plane : planes) {
      const WideV index = hn::Set(d, number++);
      const WideV towards = DotWith(plane.normal, v);
      const WideV distance = hn::Sub(hn::Set(d, plane.distance), DotWith(plane.normal, o));
      const WideV behind = hn::Neg(distance), away = hn::Neg(towards);
      is_outside = hn::Or(is_outside, hn::And(hn::Lt(distance, zero), hn::Ge(towards, zero)));
      const auto enters = hn::And(hn::Lt(towards, zero), hn::Gt(hn::Mul(behind, enter_slope),
                                                                hn::Mul(enter_distance, away)));
      const auto leaves = hn::And(hn::Gt(towards, zero), hn::Lt(hn::Mul(distance, leave_slope),
                                                                hn::Mul(leave_distance, towards)));
      enter_distance = hn::IfThenElse(enters, behind, enter_distance);
      enter_slope = hn::IfThenElse(enters, away, enter_slope);
      enter_face = hn::IfThenElse(enters, index, enter_face);
      leave_distance = hn::IfThenElse(leaves, distance, leave_distance);
      leave_slope = hn::IfThenElse(leaves, towards, leave_slope);
      leave_face = hn::IfThenElse(leaves, index, leave_face);
    }
    const WideV enter = hn::Div(enter_distance, enter_slope);
    const WideV leave = hn::Div(leave_distance, leave_slope);
    const auto is_met = hn::AndNot(is_outside, hn::Le(enter, leave));
    const auto root = FirstRoot(hn::IfThenElse(is_met, enter, never), never);
    const auto from_inside = FirstRoot(hn::IfThenElse(is_met, leave, never), never);
    const auto is_inside = hn::Eq(root, hn::Set(f, kInfinity));
    hn::StoreU(hn::IfThenElse(is_inside, from_inside, root), f, t + i);
    hn::StoreU(hn::IfThenElse(is_inside, hn::DemoteTo(f, leave_face), hn::DemoteTo(f, enter_face)),
               f, face + i);
  }
}

// Whether every lane starts beyond a plane of the polyhedron and goes further away from it, as rays
// do that have just left it: not one is a hit, and no distance has to be found.
template <int kLanes>
HWY_INLINE bool LeavePolyhedron(std::span<const Plane> planes, const LaneRays<kLanes>& p) {
  const WideD d;
  const WideV zero = hn::Zero(d);
  for (std::size_t i = 0; i < kLanes; i += hn::Lanes(d)) {
    const WideVec3 o = LoadVec3(p.origin, i);
    const WideVec3 v = LoadVec3(p.direction, i);
    auto leaves = hn::Lt(zero, zero);
    for (const Plane& plane : planes) {
      if (hn::AllTrue(d, leaves)) break;
      const WideV towards = DotWith(plane.normal, v);
      const WideV distance = hn::Sub(hn::Set(d, plane.distance), DotWith(plane.normal, o));
      leaves = hn::Or(leaves, hn::And(hn::Lt(distance, zero), hn::Ge(towards, zero)));
    }
    if (!hn::AllTrue(d, leaves)) return false;
  }
  return true;
}

// Distances to a solid for all lanes, and the faces of a polyhedron.
template <int kLanes>
HWY_INLINE void SolidLanes(const SolidView& solids, std::uint32_t primitive,
                           const LaneRays<kLanes>& rays, float* t, float* face) {
  if (solids.is_ellipsoid(primitive)) {
    EllipsoidLanes(solids.ellipsoid(primitive), rays, t);
  } else {
    PolyhedronLanes(solids.planes_of(primitive), rays, t, face);
  }
}

// What rays inside a solid meet that nothing else reaches into: the solid. Returns false, with
// nothing written, when a lane does not meet it: its start was not inside after all.
HWY_INLINE bool LeaveIsolatedSolid(const SolidView& solids, const RayPacket& packet,
                                   HitPacket& hits) {
  alignas(64) float ts[kPacketLanes];
  alignas(64) float faces[kPacketLanes] = {};
  const LaneRays<kPacketLanes> rays{{packet.origin_x, packet.origin_y, packet.origin_z},
                                    {packet.direction_x, packet.direction_y, packet.direction_z}};
  SolidLanes(solids, packet.inside, rays, ts, faces);
  const LaneF d;
  const LaneU du;
  std::uint32_t met = 0;
  for (std::size_t i = 0; i < kPacketLanes; i += hn::Lanes(d)) {
    met |= BitsOf(d, hn::Lt(hn::Load(d, ts + i), hn::Load(d, packet.t_max + i)), i);
  }
  if ((packet.active & ~met & 0xffffu) != 0) return false;
  for (std::size_t i = 0; i < kPacketLanes; i += hn::Lanes(d)) {
    const auto is_in = MaskOf(d, packet.active, i);
    const auto is_in_u = hn::RebindMask(du, is_in);
    hn::Store(hn::IfThenElse(is_in, hn::Load(d, ts + i), hn::Set(d, kInfinity)), d, hits.t + i);
    hn::Store(hn::IfThenElseZero(is_in, hn::Load(d, faces + i)), d, hits.u + i);
    hn::Store(hn::Zero(d), d, hits.v + i);
    hn::Store(hn::IfThenElse(is_in_u, hn::Set(du, packet.inside), hn::Set(du, kNoPrimitive)), du,
              hits.primitive + i);
  }
  return true;
}

// Tests a solid against all lanes; returns those that it is the nearest hit of.
template <int kLanes>
HWY_INLINE std::uint32_t TestSolidLanes(const SolidView& solids, std::uint32_t primitive,
                                        PacketRays<kLanes>& p) {
  const LaneRays<kLanes> rays{{p.origin[0], p.origin[1], p.origin[2]},
                              {p.direction[0], p.direction[1], p.direction[2]}};
  if (!solids.is_ellipsoid(primitive) && LeavePolyhedron(solids.planes_of(primitive), rays)) {
    return 0;
  }
  alignas(64) float ts[kLanes];
  alignas(64) float faces[kLanes] = {};
  SolidLanes(solids, primitive, rays, ts, faces);
  const LaneF d;
  const LaneU du;
  const auto ids = hn::Set(du, primitive);
  std::uint32_t found = 0;
  for (std::size_t i = 0; i < kLanes; i += hn::Lanes(d)) {
    const auto t = hn::Load(d, ts + i);
    const auto best = hn::Load(d, p.hits.t + i);
    const auto held = hn::Load(du, p.hits.primitive + i);
    const auto is_hit = IsNearer(t, ids, best, held);
    found |= BitsOf(d, is_hit, i);
    hn::Store(hn::IfThenElse(is_hit, t, best), d, p.hits.t + i);
    hn::Store(hn::IfThenElse(is_hit, hn::Load(d, faces + i), hn::Load(d, p.hits.u + i)), d,
              p.hits.u + i);
    hn::Store(hn::IfThenZeroElse(is_hit, hn::Load(d, p.hits.v + i)), d, p.hits.v + i);
    hn::Store(hn::IfThenElse(hn::RebindMask(du, is_hit), ids, held), du, p.hits.primitive + i);
  }
  return found;
}

}  // namespace HWY_NAMESPACE
}  // namespace abbe
HWY_AFTER_NAMESPACE();

#endif
