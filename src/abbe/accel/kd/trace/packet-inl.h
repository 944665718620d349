/// Packets of sixteen rays that go nearly the same way. The tree sees a packet as one wide beam,
/// and two that follow each other as one where that is hardly wider; packets that cost more than
/// their rays would alone are divided. Compiled once for each instruction set level.

#if defined(ABBE_ACCEL_KD_TRACE_PACKET_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef ABBE_ACCEL_KD_TRACE_PACKET_INL_H_
#undef ABBE_ACCEL_KD_TRACE_PACKET_INL_H_
#else
#define ABBE_ACCEL_KD_TRACE_PACKET_INL_H_
#endif

#include <hwy/highway.h>

#include "abbe/accel/kd/trace/lanes-inl.h"
#include "abbe/accel/kd/trace/packet_leaf-inl.h"
#include "abbe/accel/kd/trace/packet_queue-inl.h"
#include "abbe/accel/kd/trace/packet_start-inl.h"
#include "abbe/accel/kd/trace/state.h"
#include "abbe/accel/kd/trace/step-inl.h"

HWY_BEFORE_NAMESPACE();
namespace abbe {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

// What a packet may cost per ray before it is divided: it pays only while it meets few more cells
// and triangles than one of its rays.
inline constexpr int kLaneBudget = 60;
// The same for a packet in a scene of a few solids whose rays go too different ways for the test
// against their line: divided packets would meet all of the scene again. Among many triangles such
// packets are divided at once.
inline constexpr int kFewSolidsBudget = 160;

// So many packets after its own step what follows from it is done.
inline constexpr std::size_t kPacketLag = 3;

// After so many pairs in a row that were none, the next are not tried but after a pause of so many
// packets.
inline constexpr std::size_t kPairsInVain = 6;
inline constexpr std::size_t kPairPause = 48;

// A packet in flight in an array of them. If they lay a whole page apart, the first lines of each
// would compete for the same few sets of the L1 cache.
template <int kLanes>
struct SpreadState : PacketState<kLanes> {
  static constexpr std::size_t kPage = 4096, kShift = 13 * 64;
  char unused[kPage + kShift - sizeof(PacketState<kLanes>) % kPage];
};

// Hands what a packet has met to the sink; returns the lanes that may meet more.
template <class Sink>
HWY_INLINE std::uint32_t Finish(const PacketState<kPacketLanes>& p, Sink& sink) {
  sink.finish(p.index, p.hits, 0, p.is_whole ? kAllLanes : p.active, p.met);
  return p.active;
}

// The same for two packets.
template <class Sink>
HWY_INLINE std::uint32_t FinishPair(const PacketState<kPairLanes>& p, Sink& sink) {
  sink.finish(p.index, p.hits, 0, kAllLanes, p.met & kAllLanes);
  sink.finish(p.index + 1, p.hits, kPacketLanes, kAllLanes, p.met >> kPacketLanes);
  return p.active;
}

// Packets in flight, one or two in each place.
template <bool kAny, int kLanes>
struct PacketsInFlight {
  SpreadState<kLanes> states[kPacketsInterleaved];
  CulledBlock culled[kPacketLag + 1];
  Candidates<kLanes> candidates;
  WorkLists<kPacketsInterleaved> lists{};
  // A bit for each place that holds packets: a new place is not touched before it is used, for most
  // calls are short.
  std::uint32_t taken = 0;
  static_assert(kPacketsInterleaved <= 32);

  PacketsInFlight() {
    for (std::size_t s = 0; s < kPacketsInterleaved; ++s) {
      lists.slot[WorkList::kDone][s] = static_cast<std::uint8_t>(s);
    }
    lists.count[WorkList::kDone] = kPacketsInterleaved;
  }

  // Hands each place whose packets are done, or that has none, to finish(p) and then to start(p),
  // which returns false if it has nothing to put there.
  template <class FinishPlace, class StartPlace>
  HWY_INLINE void refill(const KdView& view, const FinishPlace& finish, const StartPlace& start) {
    const std::size_t done = lists.count[WorkList::kDone];
    lists.count[WorkList::kDone] = 0;
    for (std::size_t i = 0; i < done; ++i) {
      const std::size_t s = lists.slot[WorkList::kDone][i];
      PacketState<kLanes>& p = states[s];
      const std::uint32_t place = 1u << s;
      if ((taken & place) != 0) finish(p);
      if (!start(p)) {
        taken &= ~place;
        lists.add(kDoneChild, s);
        continue;
      }
      taken |= place;
      p.stack.start(view.root, p.beam);
      pop(p);
      PrefetchAll(view, p.current);
      lists.add(p.current, s);
    }
  }

  // The next step of all that wait for the same.
  HWY_INLINE void go_on(const KdView& view, QueryMask mask) {
    const std::size_t inner = lists.count[WorkList::kInner];
    const std::size_t leaves = lists.count[WorkList::kLeaf];
    // A list that is gone through fills anew from its start.
    if (inner >= leaves) {
      lists.count[WorkList::kInner] = 0;
      ForEachStaggered<kPacketLag>(
          inner,
          [&](std::size_t i) ABBE_INLINE_LAMBDA {
            PacketState<kLanes>& p = states[lists.slot[WorkList::kInner][i]];
            --p.budget;
            PushChildren(view.nodes[p.current], p.beam, p.t_near, p.t_far, p.farthest, p.stack);
          },
          [&](std::size_t i) ABBE_INLINE_LAMBDA {
            const std::size_t s = lists.slot[WorkList::kInner][i];
            pop(states[s]);
            PrefetchAll(view, states[s].current);
            lists.add(states[s].current, s);
          });
      return;
    }
    lists.count[WorkList::kLeaf] = 0;
    ForEachStaggered<kPacketLag>(
        leaves,
        [&](std::size_t i) ABBE_INLINE_LAMBDA {
          const PacketState<kLanes>& p = states[lists.slot[WorkList::kLeaf][i]];
          if (HWY_LIKELY((p.current & kMixedBit) == 0)) {
            CullBlock(view.block(p.current), p, culled[i % (kPacketLag + 1)]);
          }
        },
        [&](std::size_t i) ABBE_INLINE_LAMBDA {
          const std::size_t s = lists.slot[WorkList::kLeaf][i];
          PacketState<kLanes>& p = states[s];
          CulledBlock& block_culled = culled[i % (kPacketLag + 1)];
          if (HWY_LIKELY((p.current & kMixedBit) == 0)) {
            const TriangleBlock& block = view.block(p.current);
            TestPacketBlock<kAny>(view, block, mask, block_culled, p, candidates);
            push_next_block(p, block.next_lines, p.farthest);
          } else {
            TestMixedPacketLeaf<kAny>(view, mask, block_culled, p, candidates);
          }
          pop(p);
          if ((kAny && p.active == 0) || p.budget < 0) p.stop();
          PrefetchAll(view, p.current);
          lists.add(p.current, s);
        });
  }
};

// Traces packets two by two where both go nearly the same way; the others, and lanes that were not
// worth tracing together, are put into the queue.
template <bool kAny>
class PairTracer {
 public:
  PairTracer(const RayPacket* packets, std::size_t count) : packets_(packets), count_(count) {}

  // Goes on until the queue is full or all is done; returns whether all is.
  template <class Sink>
  HWY_INLINE bool run(const StartScene& scene, const KdView& view, QueryMask mask,
                      PacketQueue& queue, Sink& sink) {
    const auto finish = [&](const PacketState<kPairLanes>& p) ABBE_INLINE_LAMBDA {
      const std::uint32_t left = FinishPair(p, sink);
      if (HWY_LIKELY(p.is_complete())) return;
      if ((left & kAllLanes) != 0) queue.append(p.index, left & kAllLanes);
      if (left >> kPacketLanes != 0) queue.append(p.index + 1, left >> kPacketLanes);
    };
    const auto start = [&](PacketState<kPairLanes>& p) ABBE_INLINE_LAMBDA {
      while (next_ < count_ && !queue.is_full()) {
        if (in_vain_ == kPairsInVain || next_ + 1 == count_) {
          pause(queue);
        } else if (take(scene, view, queue, p, sink)) {
          return true;
        }
      }
      return false;
    };
    while (true) {
      in_flight_.refill(view, finish, start);
      if (in_flight_.taken == 0) return next_ == count_;
      if (queue.is_full()) return false;
      in_flight_.go_on(view, mask);
    }
  }

 private:
  HWY_INLINE void pause(PacketQueue& queue) {
    const std::size_t end = std::min(next_ + kPairPause, count_);
    for (; next_ < end && !queue.is_full(); ++next_) queue.append(next_, kAllLanes);
    in_vain_ = 0;
  }

  // Starts the next two packets as one, or leaves them to the queue.
  template <class Sink>
  HWY_INLINE bool take(const StartScene& scene, const KdView& view, PacketQueue& queue,
                       PacketState<kPairLanes>& p, Sink& sink) {
    const std::size_t index = next_;
    next_ += 2;
    for (std::size_t k = next_ + kPacketsAhead; k < next_ + kPacketsAhead + 2; ++k) {
      if (k >= count_) break;
      Fetch(packets_[k]);
      sink.fetch(k);
    }
    const RayPacket* const pair = packets_ + index;
    const std::uint32_t lower = pair[0].active & kAllLanes, upper = pair[1].active & kAllLanes;
    if (lower != 0 && upper != 0 && !view.solids.is_isolated(pair[0].inside) &&
        StartPacket<kPairLanes>(scene, pair, lower | upper << kPacketLanes, nullptr, p)) {
      p.index = index;
      p.budget = kLaneBudget * static_cast<int>(hwy::PopCount(p.active));
      in_vain_ = 0;
      return true;
    }
    ++in_vain_;
    queue.append(index, kAllLanes);
    queue.append(index + 1, kAllLanes);
    return false;
  }

  const RayPacket* const packets_;
  const std::size_t count_;
  std::size_t next_ = 0;
  std::size_t in_vain_ = 0;  // Pairs in a row that were none.
  PacketsInFlight<kAny, kPairLanes> in_flight_;
};

// Traces the packets in a queue.
template <bool kAny>
class QueueTracer {
 public:
  explicit QueueTracer(const RayPacket* packets) : packets_(packets) {}

  // Goes on until the queue is empty, and if it is the last time until all is done.
  template <class Sink>
  HWY_INLINE void run(const StartScene& scene, const KdView& view, QueryMask mask, bool is_last,
                      PacketQueue& queue, Sink& sink) {
    const auto finish = [&](const PacketState<kPacketLanes>& p) ABBE_INLINE_LAMBDA {
      const std::uint32_t left = Finish(p, sink);
      if (HWY_UNLIKELY(!p.is_complete() && left != 0)) {
        Divide(view, packets_[p.index], p.index, left, queue, sink);
      }
    };
    const auto start = [&](PacketState<kPacketLanes>& p)
                           ABBE_INLINE_LAMBDA { return take(scene, view, queue, p, sink); };
    while (true) {
      in_flight_.refill(view, finish, start);
      if (in_flight_.taken == 0 || (queue.is_empty() && !is_last)) return;
      in_flight_.go_on(view, mask);
    }
  }

 private:
  // Starts what comes next; what is better divided is.
  template <class Sink>
  HWY_INLINE bool take(const StartScene& scene, const KdView& view, PacketQueue& queue,
                       PacketState<kPacketLanes>& p, Sink& sink) {
    PacketPart part;
    while ((part = queue.take(packets_, sink)).lanes != 0) {
      const RayPacket& packet = packets_[part.index];
      const bool is_whole = part.lanes == (packet.active & kAllLanes);
      if (is_whole && view.solids.is_isolated(packet.inside) &&
          sink.answer_inside(packet, part.index)) {
        continue;
      }
      p.is_whole = is_whole;
      if (HWY_LIKELY(StartPacket<kPacketLanes>(scene, &packet, part.lanes,
                                               is_whole ? nullptr : sink.found(part.index), p))) {
        p.index = part.index;
        p.budget = p.has_line ? kLaneBudget * static_cast<int>(hwy::PopCount(part.lanes))
                              : kFewSolidsBudget;
        return true;
      }
      if (is_whole) sink.begin_parts(part.index);
      if (!p.is_parted()) {
        Divide(view, packet, part.index, part.lanes, queue, sink);
        continue;
      }
      const std::size_t few = p.has_line ? kFewNearLanes : kFewLanes;
      AddPart(packet, part.index, part.lanes & ~p.apart, few, queue, sink);
      AddPart(packet, part.index, p.apart, few, queue, sink);
    }
    return false;
  }

  const RayPacket* const packets_;
  PacketsInFlight<kAny, kPacketLanes> in_flight_;
};

// Traces all packets with active lanes. sink.finish() takes what a packet has met.
template <bool kAny, class Sink>
HWY_INLINE void TracePackets(const KdView& view, const RayPacket* packets, std::size_t count,
                             QueryMask mask, Sink& sink) {
  const StartScene scene(view);
  PacketQueue queue;
  PairTracer<kAny> pairs(packets, count);
  QueueTracer<kAny> singles(packets);
  for (bool is_last = false; !is_last;) {
    is_last = pairs.run(scene, view, mask, queue, sink);
    singles.run(scene, view, mask, is_last, queue, sink);
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace abbe
HWY_AFTER_NAMESPACE();

#endif
