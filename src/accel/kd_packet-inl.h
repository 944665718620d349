/// Packets of sixteen rays that go nearly the same way. The tree sees a packet as one wide tube;
/// packets that cost more than their rays would alone are divided. Compiled once for each
/// instruction set level.

#if defined(ABBE_ACCEL_KD_PACKET_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef ABBE_ACCEL_KD_PACKET_INL_H_
#undef ABBE_ACCEL_KD_PACKET_INL_H_
#else
#define ABBE_ACCEL_KD_PACKET_INL_H_
#endif

#include <hwy/cache_control.h>
#include <hwy/highway.h>

#include "accel/kd_lanes-inl.h"
#include "accel/kd_packet_leaf-inl.h"
#include "accel/kd_packet_start-inl.h"
#include "accel/kd_state.h"
#include "accel/kd_step-inl.h"

HWY_BEFORE_NAMESPACE();
namespace abbe {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

// What a packet may cost per ray before it is divided: it pays only while it meets few more cells
// and triangles than one of its rays. Few rays go on alone.
inline constexpr int kLaneBudget = 60;
// The same for a packet in a scene of a few solids whose rays go too different ways for the test
// against their line: divided packets would meet all of the scene again. Among many triangles such
// packets are divided at once.
inline constexpr int kFewSolidsBudget = 160;
inline constexpr std::size_t kFewLanes = 4;
// The same for rays near to one line that only a gap parts.
inline constexpr std::size_t kFewNearLanes = 2;

// Packets under way at a time: most of their time they wait for memory.
inline constexpr std::size_t kPacketsInterleaved = 16;
// So many packets after its own step what follows from it is done.
inline constexpr std::size_t kPacketLag = 3;

// So many packets ahead the rays are fetched, which are only read when their packet starts, and the
// place for their answers.
inline constexpr std::size_t kPacketsAhead = 4;

// A packet under way in an array of them. If they lay a whole page apart, the first lines of each
// would compete for the same few sets of the L1 cache.
struct SpreadState : PacketState {
  static constexpr std::size_t kPage = 4096, kShift = 13 * 64;
  char unused[kPage + kShift - sizeof(PacketState) % kPage];
};
static_assert(sizeof(SpreadState) % SpreadState::kPage == SpreadState::kShift);

// Lanes of packets still to be traced. Each division takes one away and adds two, at most fifteen
// times for a packet.
class PacketQueue {
 public:
  PacketQueue(const RayPacket* packets, std::size_t count) : packets_(packets), count_(count) {}

  // Lanes to be traced next and their packet; no lanes when there are none left. Packets without an
  // active lane are answered on the way.
  template <class Sink>
  HWY_INLINE std::uint32_t take(std::size_t& index, Sink& sink) {
    if (parts_ > 0) {
      --parts_;
      index = part_index_[parts_];
      return part_lanes_[parts_];
    }
    while (next_ < count_) {
      index = next_++;
      if (next_ + kPacketsAhead < count_) {
        fetch(packets_[next_ + kPacketsAhead]);
        sink.fetch(next_ + kPacketsAhead);
      }
      const std::uint32_t lanes = packets_[index].active & 0xffffu;
      if (HWY_LIKELY(lanes != 0)) return lanes;
      sink.answer_nothing(index);
    }
    return 0;
  }

  HWY_INLINE void add(std::size_t index, std::uint32_t lanes) {
    part_index_[parts_] = index;
    part_lanes_[parts_] = lanes;
    ++parts_;
  }

 private:
  HWY_INLINE static void fetch(const RayPacket& packet) {
    const char* const bytes = reinterpret_cast<const char*>(&packet);
    for (std::size_t i = 0; i < sizeof(RayPacket); i += 64) hwy::Prefetch(bytes + i);
  }

  const RayPacket* packets_;
  std::size_t count_;
  std::size_t next_ = 0;
  std::size_t parts_ = 0;
  // All packets under way may be divided to single lanes before one of the parts is taken.
  std::size_t part_index_[kPacketLanes * (kPacketsInterleaved + 1)];
  std::uint32_t part_lanes_[kPacketLanes * (kPacketsInterleaved + 1)];
};

// Puts a part of a packet into the queue, or its rays aside if they are only a few.
template <class Sink>
HWY_INLINE void AddPart(const RayPacket& packet, std::size_t index, std::uint32_t lanes,
                        std::size_t few, PacketQueue& queue, Sink& sink) {
  if (hwy::PopCount(lanes) > few) {
    queue.add(index, lanes);
  } else {
    sink.trace_alone(packet, index, lanes);
  }
}

// Lanes that were not worth tracing together: in two parts, or alone.
template <class Sink>
HWY_INLINE void Divide(const KdView& view, const RayPacket& packet, std::size_t index,
                       std::uint32_t lanes, PacketQueue& queue, Sink& sink) {
  std::uint32_t some = 0;
  if (hwy::PopCount(lanes) > kFewLanes) some = SplitLanes(view, packet, lanes);
  const std::uint32_t rest = lanes & ~some;
  if (some == 0 || rest == 0) {
    sink.trace_alone(packet, index, lanes);
    return;
  }
  AddPart(packet, index, some, kFewLanes, queue, sink);
  AddPart(packet, index, rest, kFewLanes, queue, sink);
}

// Traces all packets with active lanes. sink.finish(p) takes what a packet has met and says which
// lanes are not done if it ran out of its budget.
template <bool kAny, class Sink>
HWY_INLINE void TracePackets(const KdView& view, const RayPacket* packets, std::size_t count,
                             VisibilityMask mask, Sink& sink) {
  SpreadState states[kPacketsInterleaved];
  SeenBlock seen[kPacketLag + 1];
  Candidates candidates;
  WorkLists<kPacketsInterleaved> lists{};
  PacketQueue queue(packets, count);
  const StartScene start(view);
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
      if (p.index < count) {
        const std::uint32_t left = sink.finish(p);
        if (HWY_UNLIKELY(!p.is_complete() && left != 0)) {
          Divide(view, packets[p.index], p.index, left, queue, sink);
        }
        p.index = count;
      }
      std::size_t index = 0;
      std::uint32_t lanes = 0;
      while ((lanes = queue.take(index, sink)) != 0) {
        const bool is_whole = lanes == (packets[index].active & 0xffffu);
        if (is_whole && view.is_lonely_solid(packets[index].inside) &&
            sink.answer_inside(packets[index], index)) {
          continue;
        }
        p.is_whole = is_whole;
        if (HWY_LIKELY(StartPacket(start, packets[index], lanes,
                                   is_whole ? nullptr : sink.found(index), p))) {
          break;
        }
        if (is_whole) sink.begin_parts(index);
        if (!p.is_parted()) {
          Divide(view, packets[index], index, lanes, queue, sink);
          continue;
        }
        const std::size_t few = p.has_line ? kFewNearLanes : kFewLanes;
        AddPart(packets[index], index, lanes & ~p.apart, few, queue, sink);
        AddPart(packets[index], index, p.apart, few, queue, sink);
      }
      if (lanes == 0) continue;
      p.index = index;
      p.budget =
          p.has_line ? kLaneBudget * static_cast<int>(hwy::PopCount(lanes)) : kFewSolidsBudget;
      p.stack.start(view.root, p.tube);
      p.pop();
      PrefetchAll(view, p.current);
      lists.add(p.current, s);
    }
    const std::size_t inner = lists.count[WorkList::kInner];
    const std::size_t leaves = lists.count[WorkList::kLeaf];
    if (inner == 0 && leaves == 0) {
      if (lists.count[WorkList::kDone] == 0) break;
      continue;
    }
    // A list that is gone through fills anew from its start.
    if (inner >= leaves) {
      lists.count[WorkList::kInner] = 0;
      ForEachStaggered<kPacketLag>(
          inner,
          [&](std::size_t i) ABBE_INLINE_LAMBDA {
            PacketState& p = states[lists.slot[WorkList::kInner][i]];
            --p.budget;
            PushChildren(view.nodes[p.current], p.tube, p.t_near, p.t_far, p.farthest, p.stack);
          },
          [&](std::size_t i) ABBE_INLINE_LAMBDA {
            const std::size_t s = lists.slot[WorkList::kInner][i];
            states[s].pop();
            PrefetchAll(view, states[s].current);
            lists.add(states[s].current, s);
          });
    } else {
      lists.count[WorkList::kLeaf] = 0;
      ForEachStaggered<kPacketLag>(
          leaves,
          [&](std::size_t i) ABBE_INLINE_LAMBDA {
            const PacketState& p = states[lists.slot[WorkList::kLeaf][i]];
            if (HWY_LIKELY((p.current & kMixedBit) == 0)) {
              Look(view.block(p.current), p, seen[i % (kPacketLag + 1)]);
            }
          },
          [&](std::size_t i) ABBE_INLINE_LAMBDA {
            const std::size_t s = lists.slot[WorkList::kLeaf][i];
            PacketState& p = states[s];
            SeenBlock& block_seen = seen[i % (kPacketLag + 1)];
            if (HWY_LIKELY((p.current & kMixedBit) == 0)) {
              const TriangleBlock& block = view.block(p.current);
              TestPacketBlock<kAny>(view, block, mask, block_seen, p, candidates);
              p.push_next_block(block.next_lines);
            } else {
              TestMixedPacketLeaf<kAny>(view, mask, block_seen, p, candidates);
            }
            p.pop();
            if ((kAny && p.active == 0) || p.budget < 0) p.stop();
            PrefetchAll(view, p.current);
            lists.add(p.current, s);
          });
    }
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace abbe
HWY_AFTER_NAMESPACE();

#endif
