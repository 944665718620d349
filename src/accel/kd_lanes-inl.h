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
