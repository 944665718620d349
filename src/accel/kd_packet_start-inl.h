/// Makes a packet of sixteen rays ready to trace: its tube, its shears, the line it is near to.
/// Compiled once for each instruction set level.

#if defined(ABBE_ACCEL_KD_PACKET_START_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef ABBE_ACCEL_KD_PACKET_START_INL_H_
#undef ABBE_ACCEL_KD_PACKET_START_INL_H_
#else
#define ABBE_ACCEL_KD_PACKET_START_INL_H_
#endif

#include <hwy/highway.h>

#include "accel/kd_lanes-inl.h"
#include "accel/kd_state.h"

HWY_BEFORE_NAMESPACE();
namespace abbe {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

// Copies a row; lanes that are not active repeat one that is, so that they widen nothing.
HWY_INLINE void CopyRow(const float* from, std::uint32_t active, std::size_t first_active,
                        float* to) {
  const LaneF d;
  const auto fill = hn::Set(d, from[first_active]);
  for (std::size_t i = 0; i < kPacketLanes; i += hn::Lanes(d)) {
    hn::Store(hn::IfThenElse(MaskOf(d, active, i), hn::Load(d, from + i), fill), d, to + i);
  }
}

// Sorts the lanes by the longest component of their directions, and shears each along it.
HWY_INLINE void ShearLanes(PacketState& p) {
  const LaneF d;
  std::uint32_t x_longest = 0, y_longest = 0;
  for (std::size_t i = 0; i < kPacketLanes; i += hn::Lanes(d)) {
    const auto x = hn::Abs(hn::Load(d, p.direction[0] + i));
    const auto y = hn::Abs(hn::Load(d, p.direction[1] + i));
    const auto z = hn::Abs(hn::Load(d, p.direction[2] + i));
    const auto beyond_y = hn::Gt(x, y);
    x_longest |= BitsOf(d, hn::And(beyond_y, hn::Gt(x, z)), i);
    y_longest |= BitsOf(d, hn::AndNot(beyond_y, hn::Gt(y, z)), i);
  }
  const std::uint32_t of_axis[3] = {x_longest & p.active, y_longest & p.active,
                                    p.active & ~(x_longest | y_longest)};
  p.group_count = 0;
  for (int axis = 0; axis < 3; ++axis) {
    if (of_axis[axis] == 0) continue;
    ShearGroup& group = p.groups[p.group_count++];
    group.axes = ShearAxes(axis);
    group.lanes = of_axis[axis];
    for (std::size_t i = 0; i < kPacketLanes; i += hn::Lanes(d)) {
      const auto is_in = MaskOf(d, p.group_count == 1 ? 0xffffu : group.lanes, i);
      const auto z = hn::Div(hn::Set(d, 1.0f), hn::Load(d, p.direction[axis] + i));
      const auto x = hn::Mul(hn::Load(d, p.direction[group.axes.x] + i), z);
      const auto y = hn::Mul(hn::Load(d, p.direction[group.axes.y] + i), z);
      hn::Store(hn::IfThenElse(is_in, x, hn::Load(d, p.shear_x + i)), d, p.shear_x + i);
      hn::Store(hn::IfThenElse(is_in, y, hn::Load(d, p.shear_y + i)), d, p.shear_y + i);
      hn::Store(hn::IfThenElse(is_in, z, hn::Load(d, p.shear_z + i)), d, p.shear_z + i);
    }
  }
}

// Beyond this slope between rays of a packet the tube is too wide to be of use.
inline constexpr float kWidestSpread = 0.25f;

// A gap between the rays of a packet, in parts of its width, at which two packets are better.
inline constexpr float kWidestGap = 0.4f;
// With fewer triangles a packet that is too wide meets little more than its parts would.
inline constexpr std::uint32_t kFewTriangles = 1000;
// And the least slope between its rays for that to matter.
inline constexpr float kLeastSpread = 0.0005f;

// Where rays are compared when a packet is divided, in parts of the longest side of the scene.
inline constexpr float kSplitWay = 0.25f;

// The lanes on one side of a gap that parts the lanes of a row, none if it is not wide enough.
HWY_INLINE std::uint32_t BelowGap(const float* row, float low, float high) {
  const LaneF d;
  const auto middle = hn::Set(d, low + 0.5f * (high - low));
  auto below = hn::Set(d, low), above = hn::Set(d, high);
  std::uint32_t lanes = 0;
  for (std::size_t i = 0; i < kPacketLanes; i += hn::Lanes(d)) {
    const auto v = hn::Load(d, row + i);
    const auto is_below = hn::Lt(v, middle);
    below = hn::IfThenElse(is_below, hn::Max(below, v), below);
    above = hn::IfThenElse(is_below, above, hn::Min(above, v));
    lanes |= BitsOf(d, is_below, i);
  }
  const float gap = hn::GetLane(hn::MinOfLanes(d, above)) - hn::GetLane(hn::MaxOfLanes(d, below));
  return gap > kWidestGap * (high - low) ? lanes : 0;
}

// The line that all rays of the packet are near to. False when they are not near to any.
HWY_INLINE bool FindLine(PacketState& p, bool common_origin, float reach, bool may_part) {
  const LaneF d;
  const ShearAxes axes = p.groups[0].axes;
  p.axes = axes;
  p.apart = 0;
  const float* const dz = p.direction[axes.z];
  const float least_z = SmallestLane(dz), most_z = LargestLane(dz);
  if (!(least_z > 0.0f || most_z < 0.0f)) return false;
  p.is_z_positive = least_z > 0.0f;
  p.longest_z = p.is_z_positive ? most_z : -least_z;
  const float* shear_x = p.shear_x;
  const float* shear_y = p.shear_y;
  alignas(64) float x[kPacketLanes], y[kPacketLanes];
  if (p.group_count > 1) {
    for (std::size_t i = 0; i < kPacketLanes; i += hn::Lanes(d)) {
      const auto z = hn::Load(d, dz + i);
      hn::Store(hn::Div(hn::Load(d, p.direction[axes.x] + i), z), d, x + i);
      hn::Store(hn::Div(hn::Load(d, p.direction[axes.y] + i), z), d, y + i);
    }
    shear_x = x;
    shear_y = y;
  }
  const float low_x = SmallestLane(shear_x), high_x = LargestLane(shear_x);
  const float low_y = SmallestLane(shear_y), high_y = LargestLane(shear_y);
  p.line_shear_x = 0.5f * (low_x + high_x);
  p.line_shear_y = 0.5f * (low_y + high_y);
  p.spread_x = 0.5f * (high_x - low_x);
  p.spread_y = 0.5f * (high_y - low_y);
  if (may_part && (p.spread_x > kLeastSpread || p.spread_y > kLeastSpread)) {
    p.apart = p.spread_x > p.spread_y ? BelowGap(shear_x, low_x, high_x)
                                      : BelowGap(shear_y, low_y, high_y);
    p.apart &= p.active;
  }
  if (!(p.spread_x < kWidestSpread && p.spread_y < kWidestSpread)) return false;
  p.line_x = p.origin[axes.x][0];
  p.line_y = p.origin[axes.y][0];
  p.line_z = p.origin[axes.z][0];
  p.half_x = p.half_y = p.half_z = 0.0f;
  if (!common_origin) {
    alignas(64) float bx[kPacketLanes], by[kPacketLanes], bz[kPacketLanes];
    for (std::size_t i = 0; i < kPacketLanes; i += hn::Lanes(d)) {
      // Where the ray is at z = 0 of the line.
      const auto z = hn::Sub(hn::Load(d, p.origin[axes.z] + i), hn::Set(d, p.line_z));
      const auto ox = hn::Sub(hn::Load(d, p.origin[axes.x] + i), hn::Set(d, p.line_x));
      const auto oy = hn::Sub(hn::Load(d, p.origin[axes.y] + i), hn::Set(d, p.line_y));
      hn::Store(hn::Sub(ox, hn::Mul(z, hn::Load(d, shear_x + i))), d, bx + i);
      hn::Store(hn::Sub(oy, hn::Mul(z, hn::Load(d, shear_y + i))), d, by + i);
      hn::Store(hn::Abs(z), d, bz + i);
    }
    const float left = SmallestLane(bx), right = LargestLane(bx);
    const float bottom = SmallestLane(by), top = LargestLane(by);
    p.line_x += 0.5f * (left + right);
    p.line_y += 0.5f * (bottom + top);
    p.half_x = 0.5f * (right - left);
    p.half_y = 0.5f * (top - bottom);
    p.half_z = LargestLane(bz);
  }
  // The slack of the tube, four times for the roundings here.
  const float slack = 4.0f * kTubeSlack * reach;
  p.half_x += slack;
  p.half_y += slack;
  p.half_z += slack;
  return true;
}

// Divides lanes of a packet in two where they differ most: the lanes returned, and the rest. Either
// may be none when all are alike.
HWY_INLINE std::uint32_t SplitLanes(const KdView& view, const RayPacket& packet,
                                    std::uint32_t lanes) {
  const LaneF d;
  using V = hn::Vec<LaneF>;
  const auto first = static_cast<std::size_t>(hwy::Num0BitsBelowLS1Bit_Nonzero32(lanes));
  const float* const origins[3] = {packet.origin_x, packet.origin_y, packet.origin_z};
  const float* const directions[3] = {packet.direction_x, packet.direction_y, packet.direction_z};
  // Where the rays are after a part of the way through the scene, so that directions and origins
  // can be compared.
  alignas(64) float along[3][kPacketLanes];
  alignas(64) float at[3][kPacketLanes];
  const Vec3f size = view.bounds.high - view.bounds.low;
  const float longest =
      size.x > size.y ? (size.x > size.z ? size.x : size.z) : (size.y > size.z ? size.y : size.z);
  for (int k = 0; k < 3; ++k) {
    CopyRow(directions[k], lanes, first, along[k]);
    CopyRow(origins[k], lanes, first, at[k]);
  }
  for (std::size_t i = 0; i < kPacketLanes; i += hn::Lanes(d)) {
    const V x = hn::Load(d, along[0] + i), y = hn::Load(d, along[1] + i),
            z = hn::Load(d, along[2] + i);
    const V most = hn::Max(hn::Max(hn::Abs(x), hn::Abs(y)), hn::Abs(z));
    const V way = hn::Div(hn::Set(d, kSplitWay * longest), most);
    hn::Store(hn::Add(hn::Load(d, at[0] + i), hn::Mul(x, way)), d, at[0] + i);
    hn::Store(hn::Add(hn::Load(d, at[1] + i), hn::Mul(y, way)), d, at[1] + i);
    hn::Store(hn::Add(hn::Load(d, at[2] + i), hn::Mul(z, way)), d, at[2] + i);
  }
  int widest = 0;
  float width = -1.0f, middle = 0.0f;
  for (int k = 0; k < 3; ++k) {
    const float low = SmallestLane(at[k]), high = LargestLane(at[k]);
    if (high - low > width) {
      width = high - low;
      middle = low + 0.5f * width;
      widest = k;
    }
  }
  std::uint32_t below = 0;
  for (std::size_t i = 0; i < kPacketLanes; i += hn::Lanes(d)) {
    below |= BitsOf(d, hn::Lt(hn::Load(d, at[widest] + i), hn::Set(d, middle)), i);
  }
  return below & lanes;
}

// Makes some lanes of a packet ready to trace, with what they met before if that is given. Not when
// some of them are better traced apart: then only p.apart says so.
HWY_INLINE void StartPacket(const KdView& view, const RayPacket& packet, std::uint32_t lanes,
                            const HitPacket* found, PacketState& p) {
  const LaneF d;
  const LaneU du;
  p.active = lanes;
  p.met = 0;
  p.common_origin = packet.common_origin;
  const auto first = static_cast<std::size_t>(hwy::Num0BitsBelowLS1Bit_Nonzero32(p.active));
  CopyRow(packet.direction_x, p.active, first, p.direction[0]);
  CopyRow(packet.direction_y, p.active, first, p.direction[1]);
  CopyRow(packet.direction_z, p.active, first, p.direction[2]);
  CopyRow(packet.origin_x, p.active, first, p.origin[0]);
  CopyRow(packet.origin_y, p.active, first, p.origin[1]);
  CopyRow(packet.origin_z, p.active, first, p.origin[2]);
  ShearLanes(p);
  float low_o[3], high_o[3], low_d[3], high_d[3];
  float reach = 0.0f, longest = 0.0f;
  for (int k = 0; k < 3; ++k) {
    low_o[k] = high_o[k] = p.origin[k][0];
    if (!packet.common_origin) {
      low_o[k] = SmallestLane(p.origin[k]);
      high_o[k] = LargestLane(p.origin[k]);
    }
    low_d[k] = SmallestLane(p.direction[k]);
    high_d[k] = LargestLane(p.direction[k]);
    const float down = std::abs(view.bounds.low[k] - high_o[k]);
    const float up = std::abs(view.bounds.high[k] - low_o[k]);
    reach = reach > down ? reach : down;
    reach = reach > up ? reach : up;
    longest = longest > high_d[k] ? longest : high_d[k];
    longest = longest > -low_d[k] ? longest : -low_d[k];
  }
  p.has_line = FindLine(p, packet.common_origin, reach, view.triangle_count > kFewTriangles);
  if (HWY_UNLIKELY(p.is_parted())) return;
  for (int k = 0; k < 3; ++k) {
    set_tube_axis(p.tube, k, low_o[k], high_o[k], low_d[k], high_d[k], reach, longest);
  }
  const auto never = hn::Set(d, -kInfinity);
  const auto none = hn::Set(du, kNoPrimitive);
  for (std::size_t i = 0; i < kPacketLanes; i += hn::Lanes(d)) {
    auto t = hn::Load(d, packet.t_max + i);
    auto u = hn::Zero(d), v = hn::Zero(d);
    auto primitive = none;
    if (found != nullptr) {
      primitive = hn::Load(du, found->primitive + i);
      const auto is_met = hn::RebindMask(d, hn::Ne(primitive, none));
      t = hn::IfThenElse(is_met, hn::Load(d, found->t + i), t);
      u = hn::Load(d, found->u + i);
      v = hn::Load(d, found->v + i);
    }
    hn::Store(hn::IfThenElse(MaskOf(d, p.active, i), t, never), d, p.hits.t + i);
    hn::Store(primitive, du, p.hits.primitive + i);
    hn::Store(u, d, p.hits.u + i);
    hn::Store(v, d, p.hits.v + i);
  }
  p.farthest = LargestLane(p.hits.t);
  clip_tube(p.tube, view.bounds, p.farthest);
}

}  // namespace HWY_NAMESPACE
}  // namespace abbe
HWY_AFTER_NAMESPACE();

#endif
