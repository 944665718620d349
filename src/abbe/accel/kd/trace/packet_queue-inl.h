/// Lanes of packets still to be traced, and how packets are divided. Compiled once for each
/// instruction set level.

#if defined(ABBE_ACCEL_KD_TRACE_PACKET_QUEUE_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef ABBE_ACCEL_KD_TRACE_PACKET_QUEUE_INL_H_
#undef ABBE_ACCEL_KD_TRACE_PACKET_QUEUE_INL_H_
#else
#define ABBE_ACCEL_KD_TRACE_PACKET_QUEUE_INL_H_
#endif

#include <hwy/cache_control.h>
#include <hwy/highway.h>

#include "abbe/accel/kd/trace/packet_start-inl.h"
#include "abbe/accel/kd/trace/state.h"

HWY_BEFORE_NAMESPACE();
namespace abbe {
namespace HWY_NAMESPACE {

// Few rays go on alone.
inline constexpr std::size_t kFewLanes = 4;
// The same for rays near to one line that only a gap parts.
inline constexpr std::size_t kFewNearLanes = 2;

// Packets in flight at a time: most of their time they wait for memory.
inline constexpr std::size_t kPacketsInterleaved = 16;
// So many that did not pair are gathered before they are traced one by one.
inline constexpr std::size_t kPacketsQueued = 256;

// So many packets ahead the rays are fetched, which are only read when their packet starts, and the
// place for their answers.
inline constexpr std::size_t kPacketsAhead = 4;

// Lanes of a packet, still to be traced.
struct PacketPart {
  std::size_t index;
  std::uint32_t lanes;
};

HWY_INLINE void Fetch(const RayPacket& packet) {
  const char* const bytes = reinterpret_cast<const char*>(&packet);
  for (std::size_t i = 0; i < sizeof(RayPacket); i += 64) hwy::Prefetch(bytes + i);
}

// Lanes of packets still to be traced: those that did not pair, and parts of those in flight. Each
// division takes one away and adds two, at most fifteen times for a packet.
class PacketQueue {
 public:
  HWY_INLINE bool is_empty() const { return count_ == 0 && parts_ == 0; }
  HWY_INLINE bool is_full() const { return count_ + 2 > kPacketsQueued; }

  // Lanes to be traced next and their packet; no lanes when there are none left. Packets without an
  // active lane are answered on the way.
  template <class Sink>
  HWY_INLINE PacketPart take(const RayPacket* packets, Sink& sink) {
    if (parts_ > 0) return part_[--parts_];
    while (next_ < count_) {
      if (next_ + kPacketsAhead < count_) {
        const std::size_t ahead = list_[next_ + kPacketsAhead].index;
        Fetch(packets[ahead]);
        sink.fetch(ahead);
      }
      PacketPart part = list_[next_++];
      part.lanes &= packets[part.index].active;
      if (HWY_LIKELY(part.lanes != 0)) return part;
      sink.answer_nothing(part.index);
    }
    next_ = count_ = 0;
    return {0, 0};
  }

  // What is traced before anything that waits.
  HWY_INLINE void add(std::size_t index, std::uint32_t lanes) { part_[parts_++] = {index, lanes}; }

  // What waits for its turn: of these lanes, those that are active. Domain: the queue is not full,
  // or what is added was in flight when it became so.
  HWY_INLINE void append(std::size_t index, std::uint32_t lanes) {
    list_[count_++] = {index, lanes};
  }

 private:
  std::size_t count_ = 0, next_ = 0, parts_ = 0;
  PacketPart list_[kPacketsQueued + 2 * kPacketsInterleaved];
  // All packets in flight may be divided to single lanes before one of the parts is taken.
  PacketPart part_[kPacketLanes * (kPacketsInterleaved + 1)];
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

}  // namespace HWY_NAMESPACE
}  // namespace abbe
HWY_AFTER_NAMESPACE();

#endif
