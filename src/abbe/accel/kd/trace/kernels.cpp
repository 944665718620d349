#include "abbe/accel/kd/trace/kernels.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "abbe/accel/kd/trace/kernels.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "abbe/accel/kd/trace/packet-inl.h"
#include "abbe/accel/kd/trace/stream-inl.h"

HWY_BEFORE_NAMESPACE();
namespace abbe {
namespace HWY_NAMESPACE {

void RaysClosest(const KdView& view, const Ray* rays, std::size_t count, QueryMask mask,
                 Hit* hits) {
  TraceStream<false>(view, mask, ClosestOfSpan{{rays, count}, hits});
}

void RaysAny(const KdView& view, const Ray* rays, std::size_t count, QueryMask mask,
             std::uint8_t* occluded) {
  TraceStream<true>(view, mask, AnyOfSpan{{rays, count}, occluded});
}

// Lanes that left their packets, waiting to be traced as a stream.
struct LeftoverRays {
  static constexpr std::size_t kCapacity = 512;
  std::size_t count = 0;
  std::size_t packet[kCapacity];
  std::uint8_t lane[kCapacity];
  Ray rays[kCapacity];
  Hit met[kCapacity];

  HWY_INLINE bool is_full() const { return count + kPacketLanes > kCapacity; }

  // The given lanes of a packet, with what they met so far, if anything.
  HWY_INLINE void add(const RayPacket& from, std::size_t index, std::uint32_t lanes,
                      const HitPacket* hits) {
    for (; lanes != 0; lanes &= lanes - 1) {
      const auto l = hwy::Num0BitsBelowLS1Bit_Nonzero32(lanes);
      packet[count] = index;
      lane[count] = static_cast<std::uint8_t>(l);
      rays[count] = ray_of(from, static_cast<int>(l));
      met[count] = {from.t_max[l], kNoPrimitive, 0.0f, 0.0f};
      if (hits != nullptr && hits->primitive[l] != kNoPrimitive) {
        met[count] = {hits->t[l], hits->primitive[l], hits->u[l], hits->v[l]};
      }
      ++count;
    }
  }
};

// The same as a stream.
struct LeftoverStream {
  const LeftoverRays& from;
  std::size_t count;
  HWY_INLINE const Ray& ray(std::size_t i) const { return from.rays[i]; }
  HWY_INLINE Hit found(std::size_t i) const { return from.met[i]; }
};

struct ClosestOfLeftover : LeftoverStream {
  HitPacket* hits;
  HWY_INLINE void finish(const RayState& ray) const {
    HitPacket& out = hits[from.packet[ray.index]];
    const auto lane = from.lane[ray.index];
    out.t[lane] = ray.hit.is_hit() ? ray.hit.t : kInfinity;
    out.u[lane] = ray.hit.u;
    out.v[lane] = ray.hit.v;
    out.primitive[lane] = ray.hit.primitive;
  }
};

struct AnyOfLeftover : LeftoverStream {
  std::uint32_t* occluded;
  HWY_INLINE void finish(const RayState& ray) const {
    const std::uint32_t is_met = ray.hit.is_hit() ? 1u : 0u;
    occluded[from.packet[ray.index]] |= is_met << from.lane[ray.index];
  }
};

// The answers of some lanes of a packet, of the sixteen from the first; t of lanes that met nothing
// is set. Lanes that take no part have met nothing.
template <int kLanes>
HWY_INLINE void StoreAnswers(const HitLanes<kLanes>& hits, std::size_t first, std::uint32_t lanes,
                             HitPacket& out) {
  const LaneF d;
  const LaneU du;
  for (std::size_t i = 0; i < kPacketLanes; i += hn::Lanes(d)) {
    const auto primitive = hn::Load(du, hits.primitive + first + i);
    const auto is_none = hn::RebindMask(d, hn::Eq(primitive, hn::Set(du, kNoPrimitive)));
    const auto is_in = MaskOf(d, lanes, i);
    const auto t = hn::IfThenElse(is_none, hn::Set(d, kInfinity), hn::Load(d, hits.t + first + i));
    hn::BlendedStore(primitive, hn::RebindMask(du, is_in), du, out.primitive + i);
    hn::BlendedStore(t, is_in, d, out.t + i);
    hn::BlendedStore(hn::Load(d, hits.u + first + i), is_in, d, out.u + i);
    hn::BlendedStore(hn::Load(d, hits.v + first + i), is_in, d, out.v + i);
  }
}

HWY_INLINE void StoreNothing(HitPacket& out) {
  const LaneF d;
  const LaneU du;
  for (std::size_t i = 0; i < kPacketLanes; i += hn::Lanes(d)) {
    hn::Store(hn::Set(du, kNoPrimitive), du, out.primitive + i);
    hn::Store(hn::Set(d, kInfinity), d, out.t + i);
    hn::Store(hn::Zero(d), d, out.u + i);
    hn::Store(hn::Zero(d), d, out.v + i);
  }
}

struct ClosestSink {
  const KdView& view;
  QueryMask mask;
  HitPacket* hits;
  LeftoverRays leftover;

  ClosestSink(const KdView& v, QueryMask m, HitPacket* h) : view(v), mask(m), hits(h) {}

  // Answers that will be written soon: a write that misses the caches holds up all behind it.
  HWY_INLINE void fetch(std::size_t index) const {
    constexpr int kToWrite = 1;
    const char* const bytes = reinterpret_cast<const char*>(hits + index);
    for (std::size_t i = 0; i < sizeof(HitPacket); i += 64) {
      __builtin_prefetch(bytes + i, kToWrite);
    }
  }
  // Whether the answers are known without a search.
  HWY_INLINE bool answer_inside(const RayPacket& packet, std::size_t index) {
    return view.is_visible(packet.inside, mask) &&
           LeaveIsolatedSolid(view.solids, packet, hits[index]);
  }
  // What the lanes of a packet met before, if it is a part of one.
  HWY_INLINE const HitPacket* found(std::size_t index) const { return hits + index; }
  // Before the lanes of a packet are answered one part after the other.
  HWY_INLINE void begin_parts(std::size_t index) { StoreNothing(hits[index]); }
  // A packet none of whose lanes takes part.
  HWY_INLINE void answer_nothing(std::size_t index) { StoreNothing(hits[index]); }
  // What lanes of a packet have met: the sixteen of `from` from the first.
  template <int kLanes>
  HWY_INLINE void finish(std::size_t index, const HitLanes<kLanes>& from, std::size_t first,
                         std::uint32_t lanes, std::uint32_t) {
    StoreAnswers(from, first, lanes, hits[index]);
  }
  HWY_INLINE void trace_alone(const RayPacket& packet, std::size_t index, std::uint32_t lanes) {
    leftover.add(packet, index, lanes, hits + index);
    if (leftover.is_full()) flush();
  }
  HWY_NOINLINE void flush() {
    TraceStream<false>(view, mask, ClosestOfLeftover{{leftover, leftover.count}, hits});
    leftover.count = 0;
  }
};

struct AnySink {
  const KdView& view;
  QueryMask mask;
  std::uint32_t* occluded;
  LeftoverRays leftover;

  AnySink(const KdView& v, QueryMask m, std::uint32_t* o) : view(v), mask(m), occluded(o) {}

  HWY_INLINE void fetch(std::size_t) const {}
  HWY_INLINE bool answer_inside(const RayPacket&, std::size_t) { return false; }
  HWY_INLINE const HitPacket* found(std::size_t) const { return nullptr; }
  HWY_INLINE void begin_parts(std::size_t) {}
  HWY_INLINE void answer_nothing(std::size_t) {}
  template <int kLanes>
  HWY_INLINE void finish(std::size_t index, const HitLanes<kLanes>&, std::size_t, std::uint32_t,
                         std::uint32_t met) {
    occluded[index] |= met;
  }
  HWY_INLINE void trace_alone(const RayPacket& packet, std::size_t index, std::uint32_t lanes) {
    leftover.add(packet, index, lanes, nullptr);
    if (leftover.is_full()) flush();
  }
  HWY_NOINLINE void flush() {
    TraceStream<true>(view, mask, AnyOfLeftover{{leftover, leftover.count}, occluded});
    leftover.count = 0;
  }
};

void PacketsClosest(const KdView& view, const RayPacket* packets, std::size_t count, QueryMask mask,
                    HitPacket* hits) {
  ClosestSink sink(view, mask, hits);
  TracePackets<false>(view, packets, count, mask, sink);
  if (sink.leftover.count > 0) sink.flush();
}

void PacketsAny(const KdView& view, const RayPacket* packets, std::size_t count, QueryMask mask,
                std::uint32_t* occluded) {
  for (std::size_t i = 0; i < count; ++i) occluded[i] = 0;
  AnySink sink(view, mask, occluded);
  TracePackets<true>(view, packets, count, mask, sink);
  if (sink.leftover.count > 0) sink.flush();
}

}  // namespace HWY_NAMESPACE
}  // namespace abbe
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace abbe {

HWY_EXPORT(RaysClosest);
HWY_EXPORT(RaysAny);

void trace_closest(const KdView& view, const Ray* rays, std::size_t count, QueryMask mask,
                   Hit* hits) {
  HWY_DYNAMIC_DISPATCH(RaysClosest)(view, rays, count, mask, hits);
}

void trace_any(const KdView& view, const Ray* rays, std::size_t count, QueryMask mask,
               std::uint8_t* occluded) {
  HWY_DYNAMIC_DISPATCH(RaysAny)(view, rays, count, mask, occluded);
}

HWY_EXPORT(PacketsClosest);
HWY_EXPORT(PacketsAny);

void trace_closest(const KdView& view, const RayPacket* packets, std::size_t count, QueryMask mask,
                   HitPacket* hits) {
  HWY_DYNAMIC_DISPATCH(PacketsClosest)(view, packets, count, mask, hits);
}

void trace_any(const KdView& view, const RayPacket* packets, std::size_t count, QueryMask mask,
               std::uint32_t* occluded) {
  HWY_DYNAMIC_DISPATCH(PacketsAny)(view, packets, count, mask, occluded);
}

}  // namespace abbe
#endif
