/// Makes a packet of sixteen rays, or two of them, ready to trace: its beam, its shears, the line
/// it is near to. Compiled once for each instruction set level.

#if defined(ABBE_ACCEL_KD_TRACE_PACKET_START_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef ABBE_ACCEL_KD_TRACE_PACKET_START_INL_H_
#undef ABBE_ACCEL_KD_TRACE_PACKET_START_INL_H_
#else
#define ABBE_ACCEL_KD_TRACE_PACKET_START_INL_H_
#endif

#include <hwy/highway.h>

#include <algorithm>
#include <cmath>

#include "abbe/accel/kd/trace/beam-inl.h"
#include "abbe/accel/kd/trace/lanes-inl.h"
#include "abbe/accel/kd/trace/state.h"

HWY_BEFORE_NAMESPACE();
namespace abbe {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

using PacketRow = float (RayPacket::*)[kPacketLanes];

// Where lane i of a row of a packet, or of two that lie behind each other, begins.
HWY_INLINE const float* LaneOf(const RayPacket* packet, PacketRow row, std::size_t i) {
  return packet[i / kPacketLanes].*row + i % kPacketLanes;
}

// A row with lanes that are not active repeating one that is, so that they widen nothing.
template <int kLanes>
HWY_INLINE Row<kLanes> FilledRow(const RayPacket* packet, PacketRow from, std::uint32_t active,
                                 std::size_t first_active) {
  const LaneF d;
  const auto fill = hn::Set(d, *LaneOf(packet, from, first_active));
  Row<kLanes> row;
  for (std::size_t i = 0; i < Row<kLanes>::kVectors; ++i) {
    const auto lanes = hn::Load(d, LaneOf(packet, from, i * hn::Lanes(d)));
    row.part[i] = hn::IfThenElse(MaskOf(d, active, i * hn::Lanes(d)), lanes, fill);
  }
  return row;
}

// Sorts the lanes by the longest component of their directions, and shears each along it.
template <int kLanes>
HWY_INLINE void ShearLanes(const Row<kLanes> (&direction)[3], Row<kLanes> (&shear)[2],
                           PacketState<kLanes>& p) {
  const LaneF d;
  std::uint32_t x_longest = 0, y_longest = 0;
  for (std::size_t i = 0; i < Row<kLanes>::kVectors; ++i) {
    const auto dx = direction[0].part[i], dy = direction[1].part[i], dz = direction[2].part[i];
    const auto x = hn::Abs(dx), y = hn::Abs(dy), z = hn::Abs(dz);
    const auto beyond_y = hn::Gt(x, y);
    const auto is_x = hn::And(beyond_y, hn::Gt(x, z));
    const auto is_y = hn::AndNot(beyond_y, hn::Gt(y, z));
    x_longest |= BitsOf(d, is_x, i * hn::Lanes(d));
    y_longest |= BitsOf(d, is_y, i * hn::Lanes(d));
    // As ShearAxes has them.
    const auto along = hn::IfThenElse(is_x, dx, hn::IfThenElse(is_y, dy, dz));
    const auto first = hn::IfThenElse(is_x, dy, hn::IfThenElse(is_y, dz, dx));
    const auto second = hn::IfThenElse(is_x, dz, hn::IfThenElse(is_y, dx, dy));
    const auto inverse = hn::Div(hn::Set(d, 1.0f), along);
    shear[0].part[i] = hn::Mul(first, inverse);
    shear[1].part[i] = hn::Mul(second, inverse);
    hn::Store(inverse, d, p.shear_z + i * hn::Lanes(d));
  }
  StoreRow(shear[0], p.shear_x);
  StoreRow(shear[1], p.shear_y);
  const std::uint32_t of_axis[3] = {x_longest & p.active, y_longest & p.active,
                                    p.active & ~(x_longest | y_longest)};
  p.group_count = 0;
  for (int axis = 0; axis < 3; ++axis) {
    if (of_axis[axis] == 0) continue;
    ShearGroup& group = p.groups[p.group_count++];
    group.axes = ShearAxes(axis);
    group.lanes = of_axis[axis];
  }
}

// Beyond this slope between rays of a packet the beam is too wide to be of use among many
// triangles, and beyond the next among few.
inline constexpr float kWidestSpread = 0.08f;
inline constexpr float kWidestSpreadOfFew = 0.25f;

// A gap between the rays of a packet, in parts of its width, at which two packets are better.
inline constexpr float kWidestGap = 0.2f;
// The same for rays that go too different ways for a line: their parts are seldom near to one
// either.
inline constexpr float kWidestIncoherentGap = 0.4f;
// With fewer triangles a packet that is too wide meets little more than its parts would.
inline constexpr std::uint32_t kFewTriangles = 1000;
// And the least slope between its rays for that to matter: a packet this many triangles wide, if
// the triangles of the scene were one surface as wide as it is far away.
inline constexpr float kLeastWidth = 6.0f;

// The same for two packets to be traced as one.
inline constexpr float kWidestPair = 12.0f;

// Where rays are compared when a packet is divided, in parts of the longest side of the scene.
inline constexpr float kSplitDistance = 0.25f;

// The lanes on one side of a gap that parts the lanes of a row, none if it is not wide enough.
template <int kLanes>
HWY_INLINE std::uint32_t BelowGap(const Row<kLanes>& row, float low, float high, float widest) {
  const LaneF d;
  const auto middle = hn::Set(d, low + 0.5f * (high - low));
  auto below = hn::Set(d, low), above = hn::Set(d, high);
  std::uint32_t lanes = 0;
  for (std::size_t i = 0; i < Row<kLanes>::kVectors; ++i) {
    const auto v = row.part[i];
    const auto is_below = hn::Lt(v, middle);
    below = hn::IfThenElse(is_below, hn::Max(below, v), below);
    above = hn::IfThenElse(is_below, above, hn::Min(above, v));
    lanes |= BitsOf(d, is_below, i * hn::Lanes(d));
  }
  const float gap = hn::GetLane(hn::MinOfLanes(d, above)) - hn::GetLane(hn::MaxOfLanes(d, below));
  return gap > widest * (high - low) ? lanes : 0;
}

// What the start of a packet depends on, found once for all packets.
struct StartScene {
  BeamMaker beams;
  bool has_few_triangles;
  float least_spread = kInfinity;  // Packets that spread less are not parted.
  float widest_spread = kWidestSpreadOfFew;
  float widest_pair = kWidestSpreadOfFew;

  explicit StartScene(const KdView& view)
      : beams(view.bounds), has_few_triangles(view.solids.triangle_count <= kFewTriangles) {
    if (has_few_triangles) return;
    widest_spread = kWidestSpread;
    const float triangle = 1.0f / std::sqrt(static_cast<float>(view.solids.triangle_count));
    least_spread = kLeastWidth * triangle;
    widest_pair = std::min(kWidestPair * triangle, kWidestSpread);
  }
};

// Whether the rays of the packet are near to one line, whose slopes are between the given bounds:
// sets the line's directions, and the lanes that are better traced apart.
template <int kLanes>
HWY_INLINE bool FindLine(const Row<kLanes> (&slope)[2], const float (&low)[2],
                         const float (&high)[2], float least_z, float most_z,
                         const StartScene& scene, PacketState<kLanes>& p) {
  p.apart = 0;
  if (!(least_z > 0.0f || most_z < 0.0f)) return false;
  p.is_z_positive = least_z > 0.0f;
  p.longest_z = p.is_z_positive ? most_z : -least_z;
  p.line_shear_x = 0.5f * (low[0] + high[0]);
  p.line_shear_y = 0.5f * (low[1] + high[1]);
  p.spread_x = 0.5f * (high[0] - low[0]);
  p.spread_y = 0.5f * (high[1] - low[1]);
  const bool is_narrow = p.spread_x < scene.widest_spread && p.spread_y < scene.widest_spread;
  if (p.spread_x > scene.least_spread || p.spread_y > scene.least_spread) {
    const int wider = p.spread_x > p.spread_y ? 0 : 1;
    const float widest = is_narrow ? kWidestGap : kWidestIncoherentGap;
    p.apart = BelowGap(slope[wider], low[wider], high[wider], widest) & p.active;
  }
  return is_narrow;
}

// Divides lanes of a packet in two where they differ most: the lanes returned, and the rest. Either
// may be none when all are alike.
HWY_INLINE std::uint32_t SplitLanes(const KdView& view, const RayPacket& packet,
                                    std::uint32_t lanes) {
  const LaneF d;
  using V = hn::Vec<LaneF>;
  const auto first = static_cast<std::size_t>(hwy::Num0BitsBelowLS1Bit_Nonzero32(lanes));
  const Row<kPacketLanes> along[3] = {
      FilledRow<kPacketLanes>(&packet, &RayPacket::direction_x, lanes, first),
      FilledRow<kPacketLanes>(&packet, &RayPacket::direction_y, lanes, first),
      FilledRow<kPacketLanes>(&packet, &RayPacket::direction_z, lanes, first)};
  // Where the rays are after a part of the way through the scene, so that directions and origins
  // can be compared.
  Row<kPacketLanes> at[3] = {FilledRow<kPacketLanes>(&packet, &RayPacket::origin_x, lanes, first),
                             FilledRow<kPacketLanes>(&packet, &RayPacket::origin_y, lanes, first),
                             FilledRow<kPacketLanes>(&packet, &RayPacket::origin_z, lanes, first)};
  const Vec3f size = view.bounds.high - view.bounds.low;
  const float longest = std::max({size.x, size.y, size.z});
  for (std::size_t i = 0; i < Row<kPacketLanes>::kVectors; ++i) {
    const V x = along[0].part[i], y = along[1].part[i], z = along[2].part[i];
    const V most = hn::Max(hn::Max(hn::Abs(x), hn::Abs(y)), hn::Abs(z));
    const V distance = hn::Div(hn::Set(d, kSplitDistance * longest), most);
    for (int k = 0; k < 3; ++k) {
      at[k].part[i] = hn::Add(at[k].part[i], hn::Mul(along[k].part[i], distance));
    }
  }
  const RowBounds bounds = BoundsOf(at[0], at[1], at[2], at[2]);
  int widest = 0;
  float width = -1.0f;
  for (int k = 0; k < 3; ++k) {
    if (bounds.high[k] - bounds.low[k] > width) {
      width = bounds.high[k] - bounds.low[k];
      widest = k;
    }
  }
  const V middle = hn::Set(d, bounds.low[widest] + 0.5f * width);
  std::uint32_t below = 0;
  for (std::size_t i = 0; i < Row<kPacketLanes>::kVectors; ++i) {
    below |= BitsOf(d, hn::Lt(at[widest].part[i], middle), i * hn::Lanes(d));
  }
  return below & lanes;
}

// Whether a second packet starts where the first does, given the bounds of both.
HWY_INLINE bool IsSameOrigin(const RayPacket& second, const RowBounds& origins) {
  return second.common_origin && origins.low[0] == origins.high[0] &&
         origins.low[1] == origins.high[1] && origins.low[2] == origins.high[2];
}

// The directions of all lanes in parts of their z, where lanes are sheared along different axes.
template <int kLanes>
HWY_INLINE void FindSlopes(const PacketState<kLanes>& p, Row<kLanes> (&slope)[2]) {
  const LaneF d;
  for (std::size_t i = 0; i < Row<kLanes>::kVectors; ++i) {
    const std::size_t lane = i * hn::Lanes(d);
    const auto z = hn::Load(d, p.direction[p.axes.z] + lane);
    slope[0].part[i] = hn::Div(hn::Load(d, p.direction[p.axes.x] + lane), z);
    slope[1].part[i] = hn::Div(hn::Load(d, p.direction[p.axes.y] + lane), z);
  }
}

// Sets what the lanes have met before, if that is given; returns where each ends.
template <int kLanes>
HWY_INLINE Row<kLanes> StartHits(const RayPacket* packet, std::uint32_t lanes,
                                 const HitPacket* found, PacketState<kLanes>& p) {
  const LaneF d;
  const LaneU du;
  const auto none = hn::Set(du, kNoPrimitive);
  Row<kLanes> ends;
  for (std::size_t i = 0; i < Row<kLanes>::kVectors; ++i) {
    const std::size_t lane = i * hn::Lanes(d);
    auto t = hn::Load(d, LaneOf(packet, &RayPacket::t_max, lane));
    auto u = hn::Zero(d), v = hn::Zero(d);
    auto primitive = none;
    if (found != nullptr) {
      primitive = hn::Load(du, found->primitive + lane);
      const auto is_met = hn::RebindMask(d, hn::Ne(primitive, none));
      t = hn::IfThenElse(is_met, hn::Load(d, found->t + lane), t);
      u = hn::Load(d, found->u + lane);
      v = hn::Load(d, found->v + lane);
    }
    ends.part[i] = hn::IfThenElse(MaskOf(d, lanes, lane), t, hn::Set(d, -kInfinity));
    hn::Store(primitive, du, p.hits.primitive + lane);
    hn::Store(u, d, p.hits.u + lane);
    hn::Store(v, d, p.hits.v + lane);
  }
  StoreRow(ends, p.hits.t);
  return ends;
}

// Where the line of the packet begins, how far the rays are from it there, and where the last ends.
template <int kLanes>
HWY_INLINE void PlaceLine(const Row<kLanes> (&slope)[2], const Row<kLanes>& ends,
                          PacketState<kLanes>& p) {
  const LaneF d;
  const ShearAxes axes = p.axes;
  p.line_x = p.origin[axes.x][0];
  p.line_y = p.origin[axes.y][0];
  p.line_z = p.origin[axes.z][0];
  p.half_x = p.half_y = p.half_z = 0.0f;
  if (p.common_origin || !p.has_line) {
    p.farthest = LargestLane(p.hits.t);
    return;
  }
  // Where the rays are at z = 0 of the line.
  Row<kLanes> at_x, at_y, away;
  for (std::size_t i = 0; i < Row<kLanes>::kVectors; ++i) {
    const std::size_t lane = i * hn::Lanes(d);
    const auto z = hn::Sub(hn::Load(d, p.origin[axes.z] + lane), hn::Set(d, p.line_z));
    const auto x = hn::Sub(hn::Load(d, p.origin[axes.x] + lane), hn::Set(d, p.line_x));
    const auto y = hn::Sub(hn::Load(d, p.origin[axes.y] + lane), hn::Set(d, p.line_y));
    at_x.part[i] = hn::Sub(x, hn::Mul(z, slope[0].part[i]));
    at_y.part[i] = hn::Sub(y, hn::Mul(z, slope[1].part[i]));
    away.part[i] = hn::Abs(z);
  }
  const RowBounds bounds = BoundsOf(at_x, at_y, away, ends);
  p.line_x += 0.5f * (bounds.low[0] + bounds.high[0]);
  p.line_y += 0.5f * (bounds.low[1] + bounds.high[1]);
  p.half_x = 0.5f * (bounds.high[0] - bounds.low[0]);
  p.half_y = 0.5f * (bounds.high[1] - bounds.low[1]);
  p.half_z = bounds.high[2];
  p.farthest = bounds.high[3];
}

// Makes some lanes of a packet ready to trace, with what they met before if that is given. Returns
// false when they are better traced apart: in two parts if p.apart says which, else divided anyhow;
// two packets as two. Lanes of the second packet follow those of the first.
template <int kLanes>
HWY_INLINE bool StartPacket(const StartScene& scene, const RayPacket* packet, std::uint32_t lanes,
                            const HitPacket* found, PacketState<kLanes>& p) {
  p.active = lanes;
  p.met = 0;
  const auto first = static_cast<std::size_t>(hwy::Num0BitsBelowLS1Bit_Nonzero32(p.active));
  const Row<kLanes> direction[3] = {
      FilledRow<kLanes>(packet, &RayPacket::direction_x, lanes, first),
      FilledRow<kLanes>(packet, &RayPacket::direction_y, lanes, first),
      FilledRow<kLanes>(packet, &RayPacket::direction_z, lanes, first)};
  const Row<kLanes> origin[3] = {FilledRow<kLanes>(packet, &RayPacket::origin_x, lanes, first),
                                 FilledRow<kLanes>(packet, &RayPacket::origin_y, lanes, first),
                                 FilledRow<kLanes>(packet, &RayPacket::origin_z, lanes, first)};
  for (int k = 0; k < 3; ++k) {
    StoreRow(direction[k], p.direction[k]);
    StoreRow(origin[k], p.origin[k]);
  }
  Row<kLanes> slope[2];
  ShearLanes(direction, slope, p);
  p.axes = p.groups[0].axes;
  if (p.group_count > 1) FindSlopes(p, slope);
  const RowBounds origins = BoundsOf(origin[0], origin[1], origin[2], slope[0]);
  const RowBounds directions = BoundsOf(direction[0], direction[1], direction[2], slope[1]);
  p.common_origin = packet[0].common_origin;
  if constexpr (kLanes > kPacketLanes) p.common_origin &= IsSameOrigin(packet[1], origins);
  p.has_line =
      FindLine(slope, {origins.low[3], directions.low[3]}, {origins.high[3], directions.high[3]},
               directions.low[p.axes.z], directions.high[p.axes.z], scene, p);
  bool is_incoherent = !p.has_line && !scene.has_few_triangles;
  if constexpr (kLanes > kPacketLanes) {
    is_incoherent = !p.has_line || std::max(p.spread_x, p.spread_y) > scene.widest_pair;
  }
  if (HWY_UNLIKELY(p.is_parted() || is_incoherent)) return false;

  PlaceLine(slope, StartHits(packet, lanes, found, p), p);
  const float reach = scene.beams.make(origins, directions, p.farthest, p.beam);
  // The slack of the beam, four times for the roundings here.
  const float slack = 4.0f * kBeamSlack * reach;
  p.half_x += slack;
  p.half_y += slack;
  p.half_z += slack;
  return true;
}

}  // namespace HWY_NAMESPACE
}  // namespace abbe
HWY_AFTER_NAMESPACE();

#endif
