/// The triangles and solids of a leaf against a packet of rays, or two: those beside the packet are
/// dropped sixteen at a time, and the rest is tested against sixteen rays at a time. Compiled once
/// for each instruction set level.

#if defined(ABBE_ACCEL_KD_TRACE_PACKET_LEAF_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef ABBE_ACCEL_KD_TRACE_PACKET_LEAF_INL_H_
#undef ABBE_ACCEL_KD_TRACE_PACKET_LEAF_INL_H_
#else
#define ABBE_ACCEL_KD_TRACE_PACKET_LEAF_INL_H_
#endif

#include <hwy/highway.h>

#include "abbe/accel/kd/trace/beam-inl.h"
#include "abbe/accel/kd/trace/lanes-inl.h"
#include "abbe/accel/kd/trace/state.h"
#include "abbe/accel/leaf/solids-inl.h"
#include "abbe/accel/leaf/triangles-inl.h"

HWY_BEFORE_NAMESPACE();
namespace abbe {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

// The triangles near to the line of a packet.
template <bool kLoose, int kLanes>
HWY_INLINE void CullByLine(const TriangleBlock& block, const PacketState<kLanes>& p,
                           CulledBlock& culled) {
  const LaneF d;
  using V = hn::Vec<LaneF>;
  float* const moved[3] = {culled.vertices[p.axes.x], culled.vertices[p.axes.y],
                           culled.vertices[p.axes.z]};
  const Corners<kLoose> corners(
      block, p.axes, {p.line_x, p.line_y, p.line_z, p.line_shear_x, p.line_shear_y}, moved);
  const float depth = p.farthest * p.longest_z + p.half_z;
  const V first_z = hn::Set(d, p.is_z_positive ? -p.half_z : -depth);
  const V last_z = hn::Set(d, p.is_z_positive ? depth : p.half_z);
  std::uint32_t bits = 0;
  for (std::size_t i = 0; i < static_cast<std::size_t>(kBlockTriangles); i += hn::Lanes(d)) {
    V ax, ay, az, bx, by, bz, cx, cy, cz;
    corners.get(i, 0, ax, ay, az);
    corners.get(i, 1, bx, by, bz);
    corners.get(i, 2, cx, cy, cz);
    const V low_z = hn::Min(hn::Min(az, bz), cz), high_z = hn::Max(hn::Max(az, bz), cz);
    const V far = hn::Max(hn::Abs(low_z), hn::Abs(high_z));
    const V half_x = hn::Add(hn::Set(d, p.half_x), hn::Mul(hn::Set(d, p.spread_x), far));
    const V half_y = hn::Add(hn::Set(d, p.half_y), hn::Mul(hn::Set(d, p.spread_y), far));
    const auto z_near = hn::And(hn::Ge(high_z, first_z), hn::Le(low_z, last_z));
    const auto x_near = hn::And(hn::Le(hn::Min(hn::Min(ax, bx), cx), half_x),
                                hn::Ge(hn::Max(hn::Max(ax, bx), cx), hn::Neg(half_x)));
    const auto y_near = hn::And(hn::Le(hn::Min(hn::Min(ay, by), cy), half_y),
                                hn::Ge(hn::Max(hn::Max(ay, by), cy), hn::Neg(half_y)));
    // A ray between the lines of an edge's sides: the edge function of the line, give or take
    // what it changes by over the width of the packet. Rays that some edge has to their left and
    // some other to their right, all of them, pass the triangle.
    const V u = hn::Sub(hn::Mul(cx, by), hn::Mul(cy, bx));
    const V v = hn::Sub(hn::Mul(ax, cy), hn::Mul(ay, cx));
    const V w = hn::Sub(hn::Mul(bx, ay), hn::Mul(by, ax));
    const V du = hn::Add(hn::Mul(half_x, hn::Abs(hn::Sub(cy, by))),
                         hn::Mul(half_y, hn::Abs(hn::Sub(cx, bx))));
    const V dv = hn::Add(hn::Mul(half_x, hn::Abs(hn::Sub(ay, cy))),
                         hn::Mul(half_y, hn::Abs(hn::Sub(ax, cx))));
    const V dw = hn::Add(hn::Mul(half_x, hn::Abs(hn::Sub(by, ay))),
                         hn::Mul(half_y, hn::Abs(hn::Sub(bx, ax))));
    const V most = hn::Min(hn::Min(hn::Add(u, du), hn::Add(v, dv)), hn::Add(w, dw));
    const V least = hn::Max(hn::Max(hn::Sub(u, du), hn::Sub(v, dv)), hn::Sub(w, dw));
    const auto edge_near = hn::Or(hn::Ge(most, hn::Zero(d)), hn::Le(least, hn::Zero(d)));
    bits |= BitsOf(d, hn::And(hn::And(z_near, edge_near), hn::And(x_near, y_near)), i);
  }
  // Unused triangles are a vertex, which may well be near.
  culled.near = bits & ((1u << block.triangle_count) - 1);
}

// The same for a packet without a line: triangles whose bounds its beam meets.
template <bool kLoose, int kLanes>
HWY_INLINE void CullByBounds(const TriangleBlock& block, const PacketState<kLanes>& p,
                             CulledBlock& culled) {
  const LaneF d;
  using V = hn::Vec<LaneF>;
  if (p.common_origin) {
    for (int k = 0; k < 3; ++k) {
      const auto origin = hn::Set(d, p.origin[k][0]);
      const float* const row = block.row(k);
      const auto count = static_cast<std::size_t>(block.vertices_per_row());
      for (std::size_t i = 0; i < count; i += hn::Lanes(d)) {
        hn::Store(hn::Sub(hn::Load(d, row + i), origin), d, culled.vertices[k] + i);
      }
    }
  }
  const Corners<kLoose> corners(block, p.axes, {0.0f, 0.0f, 0.0f, 0.0f, 0.0f});
  const V least = hn::Set(d, -kInfinity), most = hn::Set(d, kInfinity);
  std::uint32_t bits = 0;
  for (std::size_t i = 0; i < static_cast<std::size_t>(kBlockTriangles); i += hn::Lanes(d)) {
    V a[3], b[3], c[3];
    corners.get(i, 0, a[0], a[1], a[2]);
    corners.get(i, 1, b[0], b[1], b[2]);
    corners.get(i, 2, c[0], c[1], c[2]);
    V enter = hn::Zero(d), leave = hn::Set(d, p.farthest);
    const auto clip = [&](int axis, const V& low, const V& high) HWY_ATTR {
      const V below = hn::Set(d, p.beam.reciprocal[axis]);
      const V above = hn::Set(d, p.beam.reciprocal[4 + axis]);
      const V t_below = hn::Mul(hn::Sub(high, hn::Set(d, p.beam.origin[axis])), below);
      const V t_above = hn::Mul(hn::Sub(low, hn::Set(d, p.beam.origin[4 + axis])), above);
      enter = hn::Max(enter, hn::Max(hn::IfNegativeThenElse(below, t_below, least),
                                     hn::IfNegativeThenElse(above, least, t_above)));
      leave = hn::Min(leave, hn::Min(hn::IfNegativeThenElse(below, most, t_below),
                                     hn::IfNegativeThenElse(above, t_above, most)));
    };
    const int axes[3] = {p.axes.x, p.axes.y, p.axes.z};
    for (int k = 0; k < 3; ++k) {
      clip(axes[k], hn::Min(hn::Min(a[k], b[k]), c[k]), hn::Max(hn::Max(a[k], b[k]), c[k]));
    }
    bits |= BitsOf(d, hn::Le(enter, leave), i);
  }
  culled.near = bits & ((1u << block.triangle_count) - 1);
}

template <int kLanes>
HWY_INLINE void CullBlock(const TriangleBlock& block, const PacketState<kLanes>& p,
                          CulledBlock& culled) {
  if (HWY_UNLIKELY(!p.has_line)) {
    if (block.is_loose == 0) {
      CullByBounds<false>(block, p, culled);
    } else {
      CullByBounds<true>(block, p, culled);
    }
  } else if (HWY_LIKELY(block.is_loose == 0)) {
    CullByLine<false>(block, p, culled);
  } else {
    CullByLine<true>(block, p, culled);
  }
}

// Lanes that need no further answer.
template <int kLanes>
HWY_INLINE void Retire(PacketState<kLanes>& p, std::uint32_t lanes) {
  const LaneF d;
  p.active &= ~lanes;
  p.met |= lanes;
  for (std::size_t i = 0; i < kLanes; i += hn::Lanes(d)) {
    hn::Store(
        hn::IfThenElse(MaskOf(d, lanes, i), hn::Set(d, -kInfinity), hn::Load(d, p.hits.t + i)), d,
        p.hits.t + i);
  }
}

// What follows from hits of some lanes.
template <bool kAny, int kLanes>
HWY_INLINE void Shorten(PacketState<kLanes>& p, std::uint32_t lanes) {
  if (kAny) Retire(p, lanes);
  p.farthest = LargestLane(p.hits.t);
  p.stack.drop_behind(p.farthest);
}

// What a block takes from the budget of a packet, in triangles.
inline constexpr int kBlockCost = 2;

// The triangles that culling left of a block, with what follows from hits.
template <bool kAny, int kLanes>
HWY_INLINE void TestPacketBlock(const KdView& view, const TriangleBlock& block, QueryMask mask,
                                CulledBlock& culled, PacketState<kLanes>& p,
                                Candidates<kLanes>& candidates) {
  if (HWY_UNLIKELY(view.masks != nullptr)) {
    for (std::uint32_t near = culled.near; near != 0; near &= near - 1) {
      const auto k = hwy::Num0BitsBelowLS1Bit_Nonzero32(near);
      if (!view.is_visible(block.id[k], mask)) culled.near &= ~(1u << k);
    }
  }
  p.budget -= kBlockCost + p.group_count * static_cast<int>(hwy::PopCount(culled.near));
  if (culled.near == 0) return;
  std::uint32_t found = 0;
  PacketRays<kLanes>& rays = p;
  for (int g = 0; g < p.group_count; ++g) {
    found |= p.common_origin
                 ? TestTriangles<kAny, true>(block, culled, p.groups[g], mask, rays, candidates)
                 : TestTriangles<kAny, false>(block, culled, p.groups[g], mask, rays, candidates);
  }
  if (found != 0) Shorten<kAny>(p, found);
}

template <bool kAny, int kLanes>
HWY_INLINE void TestPacketSolid(const KdView& view, std::uint32_t primitive, QueryMask mask,
                                PacketState<kLanes>& p) {
  if (!view.is_visible(primitive, mask)) return;
  if (!MeetsBox(p.beam, view.solids.bounds_of(primitive), p.farthest)) return;
  PacketRays<kLanes>& rays = p;
  const std::uint32_t found = TestSolidLanes(view.solids, primitive, rays);
  if (found != 0) Shorten<kAny>(p, found);
}

template <bool kAny, int kLanes>
HWY_INLINE void TestMixedPacketLeaf(const KdView& view, QueryMask mask, CulledBlock& culled,
                                    PacketState<kLanes>& p, Candidates<kLanes>& candidates) {
  const MixedLeaf& mixed = view.mixed_leaves[p.current & kIndexMask];
  for (KdChild leaf = mixed.triangles; leaf != kEmptyChild;) {
    const TriangleBlock& block = view.block(leaf);
    CullBlock(block, p, culled);
    TestPacketBlock<kAny>(view, block, mask, culled, p, candidates);
    leaf = next_block(block, leaf);
  }
  for (std::uint32_t s = 0; s < mixed.solid_count; ++s) {
    TestPacketSolid<kAny>(view, view.leaf_solids[mixed.first_solid + s], mask, p);
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace abbe
HWY_AFTER_NAMESPACE();

#endif
