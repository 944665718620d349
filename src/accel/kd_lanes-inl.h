/// The sixteen lanes of a packet in as many vectors as the level needs, and their bit masks.
/// Compiled once for each instruction set level.

#if defined(ABBE_ACCEL_KD_LANES_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef ABBE_ACCEL_KD_LANES_INL_H_
#undef ABBE_ACCEL_KD_LANES_INL_H_
#else
#define ABBE_ACCEL_KD_LANES_INL_H_
#endif

#include <hwy/highway.h>

#include "accel/query.h"

HWY_BEFORE_NAMESPACE();
namespace abbe {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

using LaneF = hn::CappedTag<float, kPacketLanes>;
using LaneU = hn::CappedTag<std::uint32_t, kPacketLanes>;

// Lanes [first, first + Lanes) of a bit mask.
template <class D>
HWY_INLINE hn::Mask<D> MaskOf(D d, std::uint32_t bits, std::size_t first) {
  const std::uint32_t part = bits >> first;
  const std::uint8_t bytes[8] = {static_cast<std::uint8_t>(part),
                                 static_cast<std::uint8_t>(part >> 8)};
  return hn::LoadMaskBits(d, bytes);
}

template <class D, class M>
HWY_INLINE std::uint32_t BitsOf(D d, M mask, std::size_t first) {
  std::uint8_t bytes[8] = {};
  hn::StoreMaskBits(d, mask, bytes);
  return (bytes[0] | static_cast<std::uint32_t>(bytes[1]) << 8) << first;
}

// A value for each of the sixteen vertices of a block, looked up by the corners of its triangles.
// Lanes [i, i + Lanes) are set at a time.
struct VertexRow {
  static constexpr std::size_t kLanes = hn::MaxLanes(LaneF());

#if HWY_MAX_BYTES >= 32
  hn::Vec<LaneF> part[kPacketLanes / kLanes];

  HWY_INLINE void set(std::size_t i, hn::Vec<LaneF> values) {
    part[i / kLanes] = values;
  }

  HWY_INLINE hn::Vec<LaneF> at(hn::Vec<LaneU> corner) const {
    const LaneF d;
    if constexpr (kLanes == kPacketLanes) {
      return hn::TableLookupLanes(part[0], hn::IndicesFromVec(d, corner));
    } else {
      // The hardware reads three bits of an index; the fourth says which half.
      const auto is_high = hn::BitCast(d, hn::ShiftLeft<28>(corner));
#if HWY_IS_DEBUG_BUILD
      corner = hn::And(corner, hn::Set(LaneU(), 7u));
#endif
      const auto index = hn::IndicesFromVec(d, corner);
      return hn::IfNegativeThenElse(is_high, hn::TableLookupLanes(part[1], index),
                                    hn::TableLookupLanes(part[0], index));
    }
  }
#else
  alignas(16) float value[kPacketLanes];

  HWY_INLINE void set(std::size_t i, hn::Vec<LaneF> values) {
    hn::Store(values, LaneF(), value + i);
  }

  HWY_INLINE hn::Vec<LaneF> at(hn::Vec<LaneU> corner) const {
    const LaneF d;
    return hn::GatherIndex(d, value, hn::BitCast(hn::RebindToSigned<LaneF>(), corner));
  }
#endif
};

// Numbers of the vertices that are one corner of triangles [i, i + Lanes) of a block.
HWY_INLINE hn::Vec<LaneU> CornersOf(const std::uint8_t* row, std::size_t i) {
  const hn::Rebind<std::uint8_t, LaneU> d8;
  return hn::PromoteTo(LaneU(), hn::LoadU(d8, row + i));
}

HWY_INLINE float LargestLane(const float* values) {
  const LaneF d;
  auto most = hn::Load(d, values);
  for (std::size_t i = hn::Lanes(d); i < kPacketLanes; i += hn::Lanes(d)) {
    most = hn::Max(most, hn::Load(d, values + i));
  }
  return hn::GetLane(hn::MaxOfLanes(d, most));
}

HWY_INLINE float SmallestLane(const float* values) {
  const LaneF d;
  auto least = hn::Load(d, values);
  for (std::size_t i = hn::Lanes(d); i < kPacketLanes; i += hn::Lanes(d)) {
    least = hn::Min(least, hn::Load(d, values + i));
  }
  return hn::GetLane(hn::MinOfLanes(d, least));
}

}  // namespace HWY_NAMESPACE
}  // namespace abbe
HWY_AFTER_NAMESPACE();

#endif
