/// Packets of sixteen rays that go nearly the same way. The tree sees a packet as one wide tube; in
/// a leaf, triangles beside the tube are dropped sixteen at a time, and the rest is tested against
/// sixteen rays at a time. Compiled once for each instruction set level.

#if defined(ABBE_ACCEL_KD_PACKET_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef ABBE_ACCEL_KD_PACKET_INL_H_
#undef ABBE_ACCEL_KD_PACKET_INL_H_
#else
#define ABBE_ACCEL_KD_PACKET_INL_H_
#endif

#include <hwy/highway.h>

#include "accel/kd_lanes-inl.h"
#include "accel/kd_packet_start-inl.h"
#include "accel/kd_solids-inl.h"
#include "accel/kd_state.h"
#include "accel/kd_step-inl.h"

HWY_BEFORE_NAMESPACE();
namespace abbe {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

// The triangles of a block that the packet's rays may meet, one bit each.
HWY_INLINE std::uint32_t NearLine(const TriangleBlock& block, const PacketState& p) {
  const LaneF d;
  using V = hn::Vec<LaneF>;
  const float* const row_x = block.corners[p.axes.x];
  const float* const row_y = block.corners[p.axes.y];
  const float* const row_z = block.corners[p.axes.z];
  constexpr int kCorner = 3 * kBlockTriangles;
  const V lx = hn::Set(d, p.line_x), ly = hn::Set(d, p.line_y), lz = hn::Set(d, p.line_z);
  const V sx = hn::Set(d, p.line_shear_x), sy = hn::Set(d, p.line_shear_y);
  const float depth = p.farthest * p.longest_z + p.half_z;
  const V first_z = hn::Set(d, p.is_z_positive ? -p.half_z : -depth);
  const V last_z = hn::Set(d, p.is_z_positive ? depth : p.half_z);
  std::uint32_t bits = 0;
  for (std::size_t i = 0; i < static_cast<std::size_t>(kBlockTriangles); i += hn::Lanes(d)) {
    const V az = hn::Sub(hn::Load(d, row_z + i), lz);
    const V bz = hn::Sub(hn::Load(d, row_z + kCorner + i), lz);
    const V cz = hn::Sub(hn::Load(d, row_z + 2 * kCorner + i), lz);
    const V ax = hn::Sub(hn::Sub(hn::Load(d, row_x + i), lx), hn::Mul(sx, az));
    const V ay = hn::Sub(hn::Sub(hn::Load(d, row_y + i), ly), hn::Mul(sy, az));
    const V bx = hn::Sub(hn::Sub(hn::Load(d, row_x + kCorner + i), lx), hn::Mul(sx, bz));
    const V by = hn::Sub(hn::Sub(hn::Load(d, row_y + kCorner + i), ly), hn::Mul(sy, bz));
    const V cx = hn::Sub(hn::Sub(hn::Load(d, row_x + 2 * kCorner + i), lx), hn::Mul(sx, cz));
    const V cy = hn::Sub(hn::Sub(hn::Load(d, row_y + 2 * kCorner + i), ly), hn::Mul(sy, cz));
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
  return bits;
}

// All triangles of a block: unused lanes repeat the first's number.
HWY_INLINE std::uint32_t TrianglesOf(const TriangleBlock& block) {
  const LaneU d;
  const auto first = hn::Set(d, block.id[0] & kIdMask);
  std::uint32_t bits = 1;
  for (std::size_t i = 0; i < static_cast<std::size_t>(kBlockTriangles); i += hn::Lanes(d)) {
    bits |= BitsOf(d, hn::Ne(hn::Load(d, block.id + i), first), i);
  }
  return bits;
}

// One triangle against the lanes of a group; the same operations as for a single ray.
template <bool kAny>
HWY_INLINE std::uint32_t TestTriangle(const TriangleBlock& block, std::size_t triangle,
                                      const ShearGroup& group, PacketState& p) {
  const LaneF d;
  const LaneU du;
  using V = hn::Vec<LaneF>;
  const float* const c = &block.corners[0][triangle];
  constexpr int kRow = kBlockTriangles;
  const int x = group.axes.x, y = group.axes.y, z = group.axes.z;
  const std::uint32_t id = block.id[triangle] & kIdMask;
  std::uint32_t hit_lanes = 0;
  for (std::size_t i = 0; i < kPacketLanes; i += hn::Lanes(d)) {
    const V ox = hn::Load(d, p.origin[x] + i);
    const V oy = hn::Load(d, p.origin[y] + i);
    const V oz = hn::Load(d, p.origin[z] + i);
    const V sx = hn::Load(d, p.shear_x + i);
    const V sy = hn::Load(d, p.shear_y + i);
    const V az = hn::Sub(hn::Set(d, c[z * kRow]), oz);
    const V bz = hn::Sub(hn::Set(d, c[(3 + z) * kRow]), oz);
    const V cz = hn::Sub(hn::Set(d, c[(6 + z) * kRow]), oz);
    const V ax = hn::Sub(hn::Sub(hn::Set(d, c[x * kRow]), ox), hn::Mul(sx, az));
    const V ay = hn::Sub(hn::Sub(hn::Set(d, c[y * kRow]), oy), hn::Mul(sy, az));
    const V bx = hn::Sub(hn::Sub(hn::Set(d, c[(3 + x) * kRow]), ox), hn::Mul(sx, bz));
    const V by = hn::Sub(hn::Sub(hn::Set(d, c[(3 + y) * kRow]), oy), hn::Mul(sy, bz));
    const V cx = hn::Sub(hn::Sub(hn::Set(d, c[(6 + x) * kRow]), ox), hn::Mul(sx, cz));
    const V cy = hn::Sub(hn::Sub(hn::Set(d, c[(6 + y) * kRow]), oy), hn::Mul(sy, cz));
    const V u = hn::Sub(hn::Mul(cx, by), hn::Mul(cy, bx));
    const V v = hn::Sub(hn::Mul(ax, cy), hn::Mul(ay, cx));
    const V w = hn::Sub(hn::Mul(bx, ay), hn::Mul(by, ax));
    const V zero = hn::Zero(d);
    const V best = hn::Load(d, p.hits.t + i);
    const V determinant = hn::Add(hn::Add(u, v), w);
    const V weighted_z = hn::Add(hn::Add(hn::Mul(u, az), hn::Mul(v, bz)), hn::Mul(w, cz));
    const V scaled_t = hn::Mul(weighted_z, hn::Load(d, p.shear_z + i));
    const auto is_inside =
        hn::Or(hn::Ge(hn::Min(hn::Min(u, v), w), zero), hn::Le(hn::Max(hn::Max(u, v), w), zero));
    auto is_candidate = hn::And(is_inside, hn::Ne(determinant, zero));
    if (kAny) {
      // Most triangles near a shadow ray are the one it ends at: a first look without the division,
      // a little too generous, saves them. In the search for the closest they are mostly hits.
      const V forward = hn::CopySign(hn::Abs(scaled_t), hn::Xor(scaled_t, determinant));
      const V last = hn::Mul(hn::Abs(determinant), hn::Mul(best, hn::Set(d, 1.00001f)));
      is_candidate = hn::And(is_candidate, hn::And(hn::Ge(forward, zero), hn::Le(forward, last)));
    }
    if (hn::AllFalse(d, is_candidate)) continue;
    const V inverse = hn::Div(hn::Set(d, 1.0f), determinant);
    const V t = hn::Mul(scaled_t, inverse);
    const auto primitive = hn::Load(du, p.hits.primitive + i);
    const auto ids = hn::Set(du, id);
    // Of two primitives at the same distance the lower number wins; no primitive is the highest.
    const auto is_lower = hn::RebindMask(
        d, hn::And(hn::Lt(ids, primitive), hn::Ne(primitive, hn::Set(du, kNoPrimitive))));
    const auto is_nearer = hn::Or(hn::Lt(t, best), hn::And(hn::Eq(t, best), is_lower));
    const auto is_hit = hn::And(hn::And(is_candidate, MaskOf(d, group.lanes, i)),
                                hn::And(hn::Gt(t, zero), is_nearer));
    hit_lanes |= BitsOf(d, is_hit, i);
    hn::Store(hn::IfThenElse(is_hit, t, best), d, p.hits.t + i);
    hn::Store(hn::IfThenElse(is_hit, hn::Mul(v, inverse), hn::Load(d, p.hits.u + i)), d,
              p.hits.u + i);
    hn::Store(hn::IfThenElse(is_hit, hn::Mul(w, inverse), hn::Load(d, p.hits.v + i)), d,
              p.hits.v + i);
    hn::Store(hn::IfThenElse(hn::RebindMask(du, is_hit), ids, primitive), du, p.hits.primitive + i);
  }
  return hit_lanes;
}

// Lanes that need no further answer.
HWY_INLINE void Retire(PacketState& p, std::uint32_t lanes) {
  const LaneF d;
  p.active &= ~lanes;
  p.met |= lanes;
  for (std::size_t i = 0; i < kPacketLanes; i += hn::Lanes(d)) {
    hn::Store(
        hn::IfThenElse(MaskOf(d, lanes, i), hn::Set(d, -kInfinity), hn::Load(d, p.hits.t + i)), d,
        p.hits.t + i);
  }
}

// What a packet may cost before its rays go on alone: it pays only while it meets few more cells
// and triangles than one of its rays.
inline constexpr int kPacketBudget = 200;
inline constexpr int kBlockCost = 2;
// The same for a packet whose rays go too different ways for the test against their line.
inline constexpr int kScatteredBudget = 40;

template <bool kAny>
HWY_INLINE int TestPacketBlock(const KdView& view, const TriangleBlock& block, VisibilityMask mask,
                               PacketState& p) {
  std::uint32_t found = 0;
  int cost = kBlockCost;
  for (std::uint32_t near = p.has_line ? NearLine(block, p) : TrianglesOf(block); near != 0;
       near &= near - 1) {
    const auto triangle = static_cast<std::size_t>(hwy::Num0BitsBelowLS1Bit_Nonzero32(near));
    if (view.masks != nullptr && !view.is_visible(block.id[triangle] & kIdMask, mask)) continue;
    for (int g = 0; g < p.group_count; ++g) {
      found |= TestTriangle<kAny>(block, triangle, p.groups[g], p);
      ++cost;
    }
  }
  if (found == 0) return cost;
  if (kAny) Retire(p, found);
  p.farthest = LargestLane(p.hits.t);
  return cost;
}

template <bool kAny>
HWY_INLINE void TestPacketSolid(const KdView& view, std::uint32_t primitive, VisibilityMask mask,
                                PacketState& p) {
  if (!view.is_visible(primitive, mask)) return;
  const std::uint32_t found = TestSolidLanes(view, primitive, p);
  if (found == 0) return;
  if (kAny) Retire(p, found);
  p.farthest = LargestLane(p.hits.t);
}

// All of the leaf that the packet is in; what follows is in p.current.
template <bool kAny>
HWY_INLINE void TestPacketLeaf(const KdView& view, VisibilityMask mask, PacketState& p) {
  const std::uint32_t index = p.current & kIndexMask;
  if (HWY_LIKELY((p.current & kMixedBit) == 0)) {
    for (std::uint32_t b = index;; ++b) {
      const bool is_last = (view.blocks[b].id[0] & kMoreBlocksBit) == 0;
      if (!is_last) PrefetchBlock(view, b + 1);
      p.budget -= TestPacketBlock<kAny>(view, view.blocks[b], mask, p);
      if (is_last) break;
    }
  } else {
    const MixedLeaf& mixed = view.mixed_leaves[index];
    for (std::uint32_t b = 0; b < mixed.block_count; ++b) {
      TestPacketBlock<kAny>(view, view.blocks[mixed.first_block + b], mask, p);
    }
    for (std::uint32_t s = 0; s < mixed.solid_count; ++s) {
      TestPacketSolid<kAny>(view, view.solids[mixed.first_solid + s], mask, p);
    }
  }
  p.pop();
  if ((kAny && p.active == 0) || p.budget < 0) p.stop();
}

// Packets under way at a time: most of their time they wait for memory.
inline constexpr std::size_t kPacketsInterleaved = 6;

// Traces all packets with active lanes. sink.finish(p) takes one that is done, or that ran out of
// its budget.
template <bool kAny, class Sink>
HWY_INLINE void TracePackets(const KdView& view, const RayPacket* packets, std::size_t count,
                             VisibilityMask mask, Sink& sink) {
  PacketState states[kPacketsInterleaved];
  WorkLists<kPacketsInterleaved> lists;
  std::size_t next = 0;
  for (std::size_t s = 0; s < kPacketsInterleaved; ++s) {
    lists.slot[WorkList::kDone][s] = static_cast<std::uint8_t>(s);
    states[s].index = count;
  }
  lists.count[WorkList::kDone] = kPacketsInterleaved;
  while (true) {
    const std::size_t done = lists.count[WorkList::kDone];
    lists.count[WorkList::kDone] = 0;
    for (std::size_t i = 0; i < done; ++i) {
      const std::size_t s = lists.slot[WorkList::kDone][i];
      PacketState& p = states[s];
      if (p.index < count) sink.finish(packets[p.index], p);
      for (; next < count; ++next) {
        if ((packets[next].active & 0xffffu) == 0) continue;
        StartPacket(view, packets[next], p);
        break;
      }
      if (next == count) continue;
      p.index = next++;
      p.budget = p.has_line ? kPacketBudget : kScatteredBudget;
      p.stack.start(view.root, p.tube);
      p.pop();
      PrefetchAll(view, p.current);
      lists.add(p.current, s);
    }
    const std::size_t inner = lists.count[WorkList::kInner];
    const std::size_t leaves = lists.count[WorkList::kLeaf];
    if (inner >= leaves) {
      if (inner == 0) {
        if (lists.count[WorkList::kDone] == 0) break;
        continue;
      }
      lists.count[WorkList::kInner] = 0;
      for (std::size_t i = 0; i < inner; ++i) {
        const std::size_t s = lists.slot[WorkList::kInner][i];
        PacketState& p = states[s];
        --p.budget;
        PushChildren(view.nodes[p.current], p.tube, p.t_near, p.t_far, p.farthest, p.stack);
        p.pop();
        PrefetchAll(view, p.current);
        lists.add(p.current, s);
      }
    } else {
      lists.count[WorkList::kLeaf] = 0;
      for (std::size_t i = 0; i < leaves; ++i) {
        const std::size_t s = lists.slot[WorkList::kLeaf][i];
        TestPacketLeaf<kAny>(view, mask, states[s]);
        PrefetchAll(view, states[s].current);
        lists.add(states[s].current, s);
      }
    }
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace abbe
HWY_AFTER_NAMESPACE();

#endif
