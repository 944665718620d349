/// Parts of rays, for all lanes at once. Highway code, compiled once per instruction set.

#if defined(ABBE_MATH_SEGMENT_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef ABBE_MATH_SEGMENT_INL_H_
#undef ABBE_MATH_SEGMENT_INL_H_
#else
#define ABBE_MATH_SEGMENT_INL_H_
#endif

#include "abbe/math/lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace abbe {
namespace HWY_NAMESPACE {

/// A ray of every lane, as far as its end.
struct LaneRays {
  const LaneArray3& origin;
  const LaneArray3& direction;
  const LaneArray& end_m;
};

/// A part of every lane's ray; nothing where end ≤ begin.
struct LaneSegments {
  LaneArray begin_m, end_m;

  /// That of lane 0 in all lanes.
  template <class D>
  void splat(D d, int stride) {
    Splat(d, stride, begin_m[0], begin_m);
    Splat(d, stride, end_m[0], end_m);
  }
};

/// Leaves the part of a segment where height + distance·slope ≥ 0.
template <class D>
HWY_INLINE void ClipSegment(D d, VecOf<D> height, VecOf<D> slope, VecOf<D>& begin, VecOf<D>& end) {
  const auto zero = hn::Zero(d);
  const auto crossing = hn::Div(hn::Neg(height), slope);
  begin = hn::IfThenElse(hn::Gt(slope, zero), hn::Max(begin, crossing), begin);
  end = hn::IfThenElse(hn::Lt(slope, zero), hn::Min(end, crossing), end);
  const auto never = hn::And(hn::Eq(slope, zero), hn::Lt(height, zero));
  end = hn::IfThenElse(never, hn::Neg(hn::Set(d, 1.0f)), end);
}

}  // namespace HWY_NAMESPACE
}  // namespace abbe
HWY_AFTER_NAMESPACE();

#endif  // ABBE_MATH_SEGMENT_INL_H_
