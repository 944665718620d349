/// Rows of a packet's values in registers, and their bounds. Compiled once for each instruction set
/// level.

#if defined(ABBE_ACCEL_KD_TRACE_LANES_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef ABBE_ACCEL_KD_TRACE_LANES_INL_H_
#undef ABBE_ACCEL_KD_TRACE_LANES_INL_H_
#else
#define ABBE_ACCEL_KD_TRACE_LANES_INL_H_
#endif

#include <hwy/highway.h>

#include "abbe/accel/leaf/lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace abbe {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

template <int kLanes>
HWY_INLINE float LargestLane(const float (&values)[kLanes]) {
  const LaneF d;
  auto most = hn::Load(d, values);
  for (std::size_t i = hn::Lanes(d); i < kLanes; i += hn::Lanes(d)) {
    most = hn::Max(most, hn::Load(d, values + i));
  }
  return hn::GetLane(hn::MaxOfLanes(d, most));
}

// The values of a row in registers.
template <int kLanes>
struct Row {
  static constexpr std::size_t kVectors = kLanes / hn::MaxLanes(LaneF());
  hn::Vec<LaneF> part[kVectors];
};

template <int kLanes>
HWY_INLINE void StoreRow(const Row<kLanes>& row, float (&to)[kLanes]) {
  for (std::size_t i = 0; i < Row<kLanes>::kVectors; ++i) {
    hn::Store(row.part[i], LaneF(), to + i * hn::Lanes(LaneF()));
  }
}

// The least and the largest value of each of four rows.
struct alignas(32) RowBounds {
  float low[4], high[4];
};

struct Least {
  template <class V>
  static HWY_INLINE V of(V a, V b) {
    return hn::Min(a, b);
  }
};

struct Most {
  template <class V>
  static HWY_INLINE V of(V a, V b) {
    return hn::Max(a, b);
  }
};

template <class Op, int kLanes>
HWY_INLINE hn::Vec<LaneF> FoldRow(const Row<kLanes>& row) {
  auto all = row.part[0];
  for (std::size_t i = 1; i < Row<kLanes>::kVectors; ++i) all = Op::of(all, row.part[i]);
  return all;
}

// The four lanes of all of a vector's blocks in one.
template <class Op, class D>
HWY_INLINE hn::Vec<hn::FixedTag<float, 4>> FoldBlocks(D d, hn::Vec<D> v) {
  if constexpr (hn::MaxLanes(d) == 4) {
    return v;
  } else {
    const hn::Half<D> half;
    return FoldBlocks<Op>(half, Op::of(hn::LowerHalf(half, v), hn::UpperHalf(half, v)));
  }
}

// Four reductions for the shuffles of one and a half.
template <class Op, int kLanes>
HWY_INLINE hn::Vec<hn::FixedTag<float, 4>> FoldRows(const Row<kLanes>& a, const Row<kLanes>& b,
                                                    const Row<kLanes>& c, const Row<kLanes>& e) {
  const LaneF d;
  const hn::Repartition<double, LaneF> pairs;
  const auto va = FoldRow<Op>(a), vb = FoldRow<Op>(b), vc = FoldRow<Op>(c), ve = FoldRow<Op>(e);
  const auto ab =
      hn::BitCast(pairs, Op::of(hn::InterleaveLower(d, va, vb), hn::InterleaveUpper(d, va, vb)));
  const auto ce =
      hn::BitCast(pairs, Op::of(hn::InterleaveLower(d, vc, ve), hn::InterleaveUpper(d, vc, ve)));
  return FoldBlocks<Op>(d, Op::of(hn::BitCast(d, hn::InterleaveLower(pairs, ab, ce)),
                                  hn::BitCast(d, hn::InterleaveUpper(pairs, ab, ce))));
}

template <int kLanes>
HWY_INLINE RowBounds BoundsOf(const Row<kLanes>& a, const Row<kLanes>& b, const Row<kLanes>& c,
                              const Row<kLanes>& e) {
  const hn::FixedTag<float, 4> d4;
  RowBounds bounds;
  const auto low = FoldRows<Least>(a, b, c, e), high = FoldRows<Most>(a, b, c, e);
#if HWY_MAX_BYTES >= 32
  // In one store: what reads both halves at once need not wait for two.
  const hn::FixedTag<float, 8> d8;
  hn::Store(hn::Combine(d8, high, low), d8, bounds.low);
#else
  hn::Store(low, d4, bounds.low);
  hn::Store(high, d4, bounds.high);
#endif
  return bounds;
}

}  // namespace HWY_NAMESPACE
}  // namespace abbe
HWY_AFTER_NAMESPACE();

#endif
