/// The lanes of a packet or of two in as many vectors as the level needs, their bit masks, and the
/// rule for ties. Compiled once for each instruction set level.

#if defined(ABBE_ACCEL_LEAF_LANES_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef ABBE_ACCEL_LEAF_LANES_INL_H_
#undef ABBE_ACCEL_LEAF_LANES_INL_H_
#else
#define ABBE_ACCEL_LEAF_LANES_INL_H_
#endif

#include <hwy/highway.h>

#include "abbe/accel/leaf/ties.h"
#include "abbe/accel/query.h"

/// A lambda that is inlined wherever it is called, compiled for the instruction set of its
/// function.
#undef ABBE_INLINE_LAMBDA
#define ABBE_INLINE_LAMBDA HWY_ATTR __attribute__((always_inline))

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

// The bits of a mask that begins with lane `first`.
template <class D, class M>
HWY_INLINE std::uint32_t BitsOf(D d, M mask, std::size_t first) {
  std::uint8_t bytes[8] = {};
  hn::StoreMaskBits(d, mask, bytes);
  return (bytes[0] | static_cast<std::uint32_t>(bytes[1]) << 8) << first;
}

// is_nearer() for lanes: hits at t of primitives `ids` against the best so far.
HWY_INLINE hn::Mask<LaneF> IsNearer(hn::Vec<LaneF> t, hn::Vec<LaneU> ids, hn::Vec<LaneF> best,
                                    hn::Vec<LaneU> held) {
  const LaneF d;
  const auto is_lower =
      hn::RebindMask(d, hn::And(hn::Lt(ids, held), hn::Ne(held, hn::Set(LaneU(), kNoPrimitive))));
  return hn::Or(hn::Lt(t, best), hn::And(hn::Eq(t, best), is_lower));
}

}  // namespace HWY_NAMESPACE
}  // namespace abbe
HWY_AFTER_NAMESPACE();

#endif
