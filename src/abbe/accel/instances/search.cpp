#include <algorithm>
#include <limits>

#include "abbe/accel/instances/tree.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "abbe/accel/instances/search.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace abbe {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

using Boxes = hn::CappedTag<float, 8>;

// Pushes the boxes of a node that the beam may meet before its end, the nearest last.
HWY_INLINE PlaceEntry* PushChildren(const PlaceNode& node, const PlaceSearch& search,
                                    PlaceEntry* top) {
  const Boxes d;
  // Three roundings make a time.
  constexpr float kSlack = 4.0f * std::numeric_limits<float>::epsilon();
  const PlaceBeam& beam = search.beam;
  PlaceEntry* const first = top;
  for (std::size_t i = 0; i < 8; i += hn::Lanes(d)) {
    auto enter = hn::Zero(d);
    auto leave = hn::Set(d, search.end);
    for (int axis = 0; axis < 3; ++axis) {
      const auto to_low =
          hn::Sub(hn::Load(d, node.low[axis] + i), hn::Set(d, beam.origin_high[axis]));
      const auto to_high =
          hn::Sub(hn::Load(d, node.high[axis] + i), hn::Set(d, beam.origin_low[axis]));
      enter = hn::Max(enter, hn::Mul(to_low, hn::Set(d, beam.enter_low[axis])));
      enter = hn::Max(enter, hn::Mul(to_high, hn::Set(d, beam.enter_high[axis])));
      if (beam.leave_high[axis] != 0.0f) {
        leave = hn::Min(leave, hn::Mul(to_high, hn::Set(d, beam.leave_high[axis] +
                                                               kSlack * beam.leave_high[axis])));
      }
      if (beam.leave_low[axis] != 0.0f) {
        leave = hn::Min(leave, hn::Mul(to_low, hn::Set(d, beam.leave_low[axis] +
                                                              kSlack * beam.leave_low[axis])));
      }
    }
    enter = hn::Mul(enter, hn::Set(d, 1.0f - kSlack));
    const auto is_met =
        hn::And(hn::Le(enter, leave), hn::Lt(enter, hn::Set(d, std::numeric_limits<float>::max())));
    alignas(64) float times[8];
    hn::Store(enter, d, times);
    std::uint8_t bits[8] = {};
    hn::StoreMaskBits(d, is_met, bits);
    for (std::size_t lane = 0; lane < hn::Lanes(d); ++lane) {
      if (i + lane >= node.count || (bits[0] >> lane & 1) == 0) continue;
      // What is nearer stays behind it.
      PlaceEntry* at = top++;
      for (; at > first && at[-1].t < times[lane]; --at) *at = at[-1];
      *at = {times[lane], node.children[i + lane]};
    }
  }
  return top;
}

void NextPlaces(const PlaceNode* nodes, PlaceSearch* searches, std::size_t count,
                std::uint32_t* places) {
  for (std::size_t i = 0; i < count; ++i) {
    PlaceSearch& search = searches[i];
    places[i] = kNoPlace;
    PlaceEntry* top = search.top;
    while (top != search.bottom) {
      const PlaceEntry next = *--top;
      if (next.t > search.end) continue;
      if ((next.child & kPlaceBit) != 0) {
        places[i] = next.child & ~kPlaceBit;
        break;
      }
      ++search.visited;
      top = PushChildren(nodes[next.child], search, top);
    }
    search.top = top;
  }
}

template <class D>
HWY_INLINE void MoveLanes(D d, const Mat3d& linear, const Vec3d& offset, const float* x,
                          const float* y, const float* z, float* to_x, float* to_y, float* to_z) {
  const hn::Rebind<float, D> f;
  for (std::size_t i = 0; i < kPacketLanes; i += hn::Lanes(d)) {
    const auto px = hn::PromoteTo(d, hn::Load(f, x + i));
    const auto py = hn::PromoteTo(d, hn::Load(f, y + i));
    const auto pz = hn::PromoteTo(d, hn::Load(f, z + i));
    float* const to[3] = {to_x, to_y, to_z};
    for (int row = 0; row < 3; ++row) {
      const auto sum = hn::Add(
          hn::Add(hn::Mul(hn::Set(d, linear[0][row]), px), hn::Mul(hn::Set(d, linear[1][row]), py)),
          hn::Mul(hn::Set(d, linear[2][row]), pz));
      hn::Store(hn::DemoteTo(f, hn::Add(sum, hn::Set(d, offset[row]))), f, to[row] + i);
    }
  }
}

void MovePacket(const Mat3d& linear, const Vec3d& offset, const RayPacket& from, RayPacket& to) {
  const hn::CappedTag<double, 8> d;
  MoveLanes(d, linear, offset, from.origin_x, from.origin_y, from.origin_z, to.origin_x,
            to.origin_y, to.origin_z);
  MoveLanes(d, linear, Vec3d(0.0), from.direction_x, from.direction_y, from.direction_z,
            to.direction_x, to.direction_y, to.direction_z);
}

}  // namespace HWY_NAMESPACE
}  // namespace abbe
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace abbe {

HWY_EXPORT(NextPlaces);
HWY_EXPORT(MovePacket);

void next_places(const PlaceTree& tree, std::span<PlaceSearch> searches,
                 std::span<std::uint32_t> places) {
  HWY_DYNAMIC_DISPATCH(NextPlaces)(tree.nodes(), searches.data(), searches.size(), places.data());
}

void move_packet(const Mat3d& linear, const Vec3d& offset, const RayPacket& from, RayPacket& to) {
  HWY_DYNAMIC_DISPATCH(MovePacket)(linear, offset, from, to);
}

}  // namespace abbe
#endif  // HWY_ONCE
