/// Where the rays of a spread fan met surfaces: surface_point() for all lanes of one primitive at
/// once. Highway code, compiled once per instruction set.
///
/// Contract. The operations of surface/point.cpp in the same order, without fused multiply-add: a
/// lane gets the same bits as a ray alone, on every instruction set level.

#if defined(ABBE_INTEGRATE_SURFACE_POINT_LANES_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef ABBE_INTEGRATE_SURFACE_POINT_LANES_INL_H_
#undef ABBE_INTEGRATE_SURFACE_POINT_LANES_INL_H_
#else
#define ABBE_INTEGRATE_SURFACE_POINT_LANES_INL_H_
#endif

#include <hwy/highway.h>

#include "abbe/integrate/surface/point.h"
#include "abbe/math/lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace abbe {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

/// Hits of a fan's lanes and the rays that made them.
struct HitLanes {
  LaneArray3 origin, direction;
  LaneArray t, u, v;
  alignas(64) std::uint32_t primitive[kMaxLanes];
  /// Per lane, the number of what is there besides, or 0; null: nothing anywhere. Aligned as lanes.
  const std::uint32_t* contact = nullptr;
};

/// Geometry at the hits; lanes that are not filled keep what they had.
struct SurfaceLanes {
  LaneArray3 position;
  LaneArray3 outward;         ///< Geometric normal, out of the solid.
  LaneArray3 shading_normal;  ///< On the side of `outward`.
  LaneArray offset_m;
};

template <class D>
HWY_INLINE void BlendedStore3(D d, const Vec3Of<D>& v, hn::Mask<D> mask, LaneArray3& a, int i) {
  hn::BlendedStore(v.x, mask, d, a.x.v + i);
  hn::BlendedStore(v.y, mask, d, a.y.v + i);
  hn::BlendedStore(v.z, mask, d, a.z.v + i);
}

/// off_surface() for all lanes; `inside` are those whose rays go below the surface.
template <class D>
HWY_INLINE Vec3Of<D> OffSurface(D d, const Vec3Of<D>& position, const Vec3Of<D>& outward,
                                VecOf<D> offset_m, hn::Mask<D> inside) {
  const auto signed_offset = hn::IfThenElse(inside, hn::Neg(offset_m), offset_m);
  return Combine3(d, hn::Set(d, 1.0f), position, signed_offset, outward);
}

/// w·a + u·b + v·c per lane.
template <class D>
HWY_INLINE Vec3Of<D> Interpolated3(D d, VecOf<D> w, const Vec3f& a, VecOf<D> u, const Vec3f& b,
                                   VecOf<D> v, const Vec3f& c) {
  const auto component = [&](float of_a, float of_b, float of_c) {
    return hn::Add(hn::Add(hn::Mul(w, hn::Set(d, of_a)), hn::Mul(u, hn::Set(d, of_b))),
                   hn::Mul(v, hn::Set(d, of_c)));
  };
  return {component(a.x, b.x, c.x), component(a.y, b.y, c.y), component(a.z, b.z, c.z)};
}

/// Points of a triangle without attributes.
template <class D>
HWY_INLINE void FillTriangleLanes(D d, int stride, const World& world, const TriangleFrame& frame,
                                  const HitLanes& hits, const LaneMask& lanes, SurfaceLanes& out) {
  const Surface& surface = world.geometry.surfaces[frame.surface];
  const auto normal = Set3(d, frame.normal);
  const auto distance2 = [&](const Vec3Of<D>& p, const Vec3f& corner) {
    const Vec3Of<D> to{hn::Sub(hn::Set(d, corner.x), p.x), hn::Sub(hn::Set(d, corner.y), p.y),
                       hn::Sub(hn::Set(d, corner.z), p.z)};
    return Dot3(d, to, to);
  };
  const Vec3Of<D> abs_normal{hn::Abs(normal.x), hn::Abs(normal.y), hn::Abs(normal.z)};
  for (int i = 0; i < stride; i += static_cast<int>(hn::Lanes(d))) {
    const auto mask = LanesFrom(d, lanes, i);
    if (hn::AllFalse(d, mask)) continue;
    const auto u = hn::Load(d, hits.u.v + i);
    const auto v = hn::Load(d, hits.v.v + i);
    const auto w = hn::Sub(hn::Sub(hn::Set(d, 1.0f), u), v);
    const auto position = Interpolated3(d, w, frame.a, u, frame.b, v, frame.c);
    const auto abs_sum = [&](float a, float b, float c) {
      return hn::Add(
          hn::Add(hn::Abs(hn::Mul(w, hn::Set(d, a))), hn::Abs(hn::Mul(u, hn::Set(d, b)))),
          hn::Abs(hn::Mul(v, hn::Set(d, c))));
    };
    const Vec3Of<D> sums{abs_sum(frame.a.x, frame.b.x, frame.c.x),
                         abs_sum(frame.a.y, frame.b.y, frame.c.y),
                         abs_sum(frame.a.z, frame.b.z, frame.c.z)};
    const auto reach =
        hn::Sqrt(hn::Max(hn::Max(distance2(position, frame.a), distance2(position, frame.b)),
                         distance2(position, frame.c)));
    const auto offset =
        hn::Add(hn::Add(hn::Mul(hn::Set(d, rounding_bound(9)), Dot3(d, sums, abs_normal)),
                        hn::Mul(hn::Set(d, rounding_bound(12)), reach)),
                hn::Set(d, frame.added_offset_m));
    auto shading = normal;
    if (surface.normals_offset) {
      const auto mean =
          Interpolated3(d, w, frame.normals[0], u, frame.normals[1], v, frame.normals[2]);
      const auto length2 = Dot3(d, mean, mean);
      const auto usable =
          hn::And(hn::Gt(length2, hn::Zero(d)), hn::Lt(length2, hn::Set(d, kInfinity)));
      const auto length = hn::Sqrt(length2);
      shading = Select3(
          d, usable,
          Vec3Of<D>{hn::Div(mean.x, length), hn::Div(mean.y, length), hn::Div(mean.z, length)},
          normal);
      const auto turned = hn::Lt(Dot3(d, shading, normal), hn::Zero(d));
      shading =
          Select3(d, turned, Vec3Of<D>{hn::Neg(shading.x), hn::Neg(shading.y), hn::Neg(shading.z)},
                  shading);
    }
    BlendedStore3(d, position, mask, out.position, i);
    BlendedStore3(d, normal, mask, out.outward, i);
    BlendedStore3(d, shading, mask, out.shading_normal, i);
    hn::BlendedStore(offset, mask, d, out.offset_m.v + i);
  }
}

/// The double lanes that serve as many float lanes.
template <class D>
using DoubleLanes = hn::CappedTag<double, hn::MaxLanes(D()) < 8 ? hn::MaxLanes(D()) : 8>;

template <class DD>
struct DoubleVec3 {
  hn::Vec<DD> x, y, z;
};

template <class DD>
HWY_INLINE hn::Vec<DD> DotDouble(DD, const DoubleVec3<DD>& a, const DoubleVec3<DD>& b) {
  return hn::Add(hn::Add(hn::Mul(a.x, b.x), hn::Mul(a.y, b.y)), hn::Mul(a.z, b.z));
}

template <class DD>
HWY_INLINE DoubleVec3<DD> SetDouble(DD d, const Vec3d& v) {
  return {hn::Set(d, v.x), hn::Set(d, v.y), hn::Set(d, v.z)};
}

template <class DD>
HWY_INLINE DoubleVec3<DD> MatrixTimes(DD d, const Mat3d& m, const DoubleVec3<DD>& v) {
  return {DotDouble(d, SetDouble(d, {m[0][0], m[1][0], m[2][0]}), v),
          DotDouble(d, SetDouble(d, {m[0][1], m[1][1], m[2][1]}), v),
          DotDouble(d, SetDouble(d, {m[0][2], m[1][2], m[2][2]}), v)};
}

template <class DD>
HWY_INLINE DoubleVec3<DD> NormalizedDouble(DD d, const DoubleVec3<DD>& v) {
  const auto scale = hn::Div(hn::Set(d, 1.0), hn::Sqrt(DotDouble(d, v, v)));
  return {hn::Mul(v.x, scale), hn::Mul(v.y, scale), hn::Mul(v.z, scale)};
}

/// o + t·d in double, from lane i on.
template <class DD>
HWY_INLINE DoubleVec3<DD> PointOnRay(DD d, const HitLanes& hits, int i) {
  const hn::Rebind<float, DD> f;
  const auto t = hn::PromoteTo(d, hn::LoadU(f, hits.t.v + i));
  const auto component = [&](const LaneArray& origin, const LaneArray& direction) {
    return hn::Add(hn::PromoteTo(d, hn::LoadU(f, origin.v + i)),
                   hn::Mul(t, hn::PromoteTo(d, hn::LoadU(f, direction.v + i))));
  };
  return {component(hits.origin.x, hits.direction.x), component(hits.origin.y, hits.direction.y),
          component(hits.origin.z, hits.direction.z)};
}

/// Stores what a solid has in common with all others: no attributes, an offset from the position.
template <class DD>
HWY_INLINE void StoreSolidLanes(DD, const DoubleVec3<DD>& exact, const DoubleVec3<DD>& normal,
                                const LaneMask& lanes, int i, SurfaceLanes& out) {
  using F = hn::Rebind<float, DD>;
  const F f;
  const Vec3Of<F> position{hn::DemoteTo(f, exact.x), hn::DemoteTo(f, exact.y),
                           hn::DemoteTo(f, exact.z)};
  const Vec3Of<F> outward{hn::DemoteTo(f, normal.x), hn::DemoteTo(f, normal.y),
                          hn::DemoteTo(f, normal.z)};
  const Vec3Of<F> abs_position{hn::Abs(position.x), hn::Abs(position.y), hn::Abs(position.z)};
  const Vec3Of<F> abs_outward{hn::Abs(outward.x), hn::Abs(outward.y), hn::Abs(outward.z)};
  const auto mask = LanesFrom(f, lanes, i);
  BlendedStore3(f, position, mask, out.position, i);
  BlendedStore3(f, outward, mask, out.outward, i);
  BlendedStore3(f, outward, mask, out.shading_normal, i);
  hn::BlendedStore(hn::Mul(hn::Set(f, rounding_bound(5)), Dot3(f, abs_position, abs_outward)), mask,
                   f, out.offset_m.v + i);
}

template <class D>
HWY_INLINE void FillEllipsoidLanes(D, int stride, const World& world, std::size_t index,
                                   const HitLanes& hits, const LaneMask& lanes, SurfaceLanes& out) {
  const DoubleLanes<D> d;
  const Ellipsoid& ellipsoid = world.geometry.ellipsoids[index];
  const auto offset = SetDouble(d, ellipsoid.world_to_unit_offset);
  const Mat3d transposed = glm::transpose(ellipsoid.world_to_unit_linear);
  for (int i = 0; i < stride; i += static_cast<int>(hn::Lanes(d))) {
    auto q = MatrixTimes(d, ellipsoid.world_to_unit_linear, PointOnRay(d, hits, i));
    q = NormalizedDouble(d,
                         {hn::Add(q.x, offset.x), hn::Add(q.y, offset.y), hn::Add(q.z, offset.z)});
    const auto exact =
        MatrixTimes(d, world.geometry.ellipsoid_to_world[index],
                    {hn::Sub(q.x, offset.x), hn::Sub(q.y, offset.y), hn::Sub(q.z, offset.z)});
    const auto normal = NormalizedDouble(d, MatrixTimes(d, transposed, q));
    StoreSolidLanes(d, exact, normal, lanes, i, out);
  }
}

/// Points of one face of a polyhedron.
template <class D>
HWY_INLINE void FillFaceLanes(D, int stride, const Plane& plane, const HitLanes& hits,
                              const LaneMask& lanes, SurfaceLanes& out) {
  const DoubleLanes<D> d;
  const auto normal = SetDouble(d, plane.normal);
  for (int i = 0; i < stride; i += static_cast<int>(hn::Lanes(d))) {
    const auto on_ray = PointOnRay(d, hits, i);
    const auto above = hn::Sub(DotDouble(d, normal, on_ray), hn::Set(d, plane.distance));
    const DoubleVec3<DoubleLanes<D>> exact{hn::Sub(on_ray.x, hn::Mul(above, normal.x)),
                                           hn::Sub(on_ray.y, hn::Mul(above, normal.y)),
                                           hn::Sub(on_ray.z, hn::Mul(above, normal.z))};
    StoreSolidLanes(d, exact, normal, lanes, i, out);
  }
}

/// Geometry for the lanes that met what `leader` met, which must be free of attributes (see
/// has_attributes): returns those lanes out of `left`.
template <class D>
HWY_INLINE LaneMask FillSurfaceLanes(D d, int stride, const World& world, const HitLanes& hits,
                                     const LaneMask& left, int leader, SurfaceLanes& out) {
  const std::uint32_t primitive = hits.primitive[leader];
  LaneMask lanes = LanesWith(d, stride, hits.primitive, primitive, left);
  std::size_t index = primitive;
  if (world.geometry.is_triangle(primitive)) {
    FillTriangleLanes(d, stride, world, triangle_frame(world, primitive), hits, lanes, out);
    return lanes;
  }
  index -= world.geometry.triangles.size();
  if (index < world.geometry.ellipsoids.size()) {
    FillEllipsoidLanes(d, stride, world, index, hits, lanes, out);
    return lanes;
  }
  // The face number of a polyhedron comes as u.
  const ConvexPolyhedron& polyhedron =
      world.geometry.polyhedra[index - world.geometry.ellipsoids.size()];
  lanes = LanesWith(d, stride, hits.u.v, hits.u[leader], lanes);
  const auto face = static_cast<std::uint32_t>(hits.u[leader]);
  FillFaceLanes(d, stride, world.geometry.planes[polyhedron.first_plane + face], hits, lanes, out);
  return lanes;
}

}  // namespace HWY_NAMESPACE
}  // namespace abbe
HWY_AFTER_NAMESPACE();

#endif  // ABBE_INTEGRATE_SURFACE_POINT_LANES_INL_H_
