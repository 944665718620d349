/// Beams around rays and packets, made on all axes and both sides at once, and whether they meet a
/// box. Compiled once for each instruction set level.

#if defined(ABBE_ACCEL_KD_TRACE_BEAM_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef ABBE_ACCEL_KD_TRACE_BEAM_INL_H_
#undef ABBE_ACCEL_KD_TRACE_BEAM_INL_H_
#else
#define ABBE_ACCEL_KD_TRACE_BEAM_INL_H_
#endif

#include <hwy/highway.h>

#include <algorithm>

#include "abbe/accel/kd/trace/beam.h"
#include "abbe/accel/kd/trace/lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace abbe {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

// Whether a ray or packet may meet anything in a box up to a distance.
HWY_INLINE bool MeetsBox(const Beam& beam, const Box3f& box, float t_far) {
  const hn::FixedTag<float, 4> d;
  const auto low = hn::LoadU(d, &box.low.x);                        // And high.x.
  const auto high = hn::Shuffle0321(hn::LoadU(d, &box.low.x + 2));  // And low.z.
  const auto below = hn::Load(d, beam.reciprocal), above = hn::Load(d, beam.reciprocal + 4);
  const auto t_below = hn::Mul(hn::Sub(high, hn::Load(d, beam.origin)), below);
  const auto t_above = hn::Mul(hn::Sub(low, hn::Load(d, beam.origin + 4)), above);
  const auto is_axis = hn::FirstN(d, 3);
  const auto least = hn::Set(d, -kInfinity), most = hn::Set(d, kInfinity);
  const auto enter = hn::Max(hn::IfNegativeThenElse(below, t_below, least),
                             hn::IfNegativeThenElse(above, least, t_above));
  const auto leave = hn::Min(hn::IfNegativeThenElse(below, most, t_below),
                             hn::IfNegativeThenElse(above, t_above, most));
  const float t_near =
      std::max(hn::GetLane(hn::MaxOfLanes(d, hn::IfThenElse(is_axis, enter, least))), 0.0f);
  return t_near <=
         std::min(hn::GetLane(hn::MinOfLanes(d, hn::IfThenElse(is_axis, leave, most))), t_far);
}

#if HWY_MAX_BYTES >= 32

using StepF = hn::FixedTag<float, 8>;
using StepU = hn::FixedTag<std::uint32_t, 8>;

// make_beam(), the same operations on all axes and both sides at once.
struct BeamMaker {
  alignas(32) float opposite[8];  // The sides as seen by the lower and the upper bound.

  explicit BeamMaker(const Box3f& bounds) {
    for (int k = 0; k < 3; ++k) {
      opposite[k] = bounds.high[k];
      opposite[4 + k] = bounds.low[k];
    }
    opposite[3] = opposite[7] = 0.0f;
  }

  HWY_INLINE void make(const Ray& ray, Beam& beam) const {
    const StepF d;
    const hn::FixedTag<float, 4> d4;
    const auto low = hn::LoadU(d4, &ray.origin.x);  // And t_max.
    const auto last = hn::LoadU(d4, &ray.t_max);    // t_max and the direction.
    const auto turned = hn::Shuffle0321(last);      // The direction and t_max.
    make(hn::Combine(d, low, low), hn::Combine(d, turned, turned), ray.t_max, beam);
  }

  // Around many rays, from the bounds of their x, y, z; the fourth is not read. Returns the largest
  // distance along any axis from an origin to the scene.
  HWY_INLINE float make(const RowBounds& origins, const RowBounds& directions, float t_max,
                        Beam& beam) const {
    const StepF d;
    return make(hn::Load(d, origins.low), hn::Load(d, directions.low), t_max, beam);
  }

 private:
  HWY_INLINE float make(hn::Vec<StepF> both_o, hn::Vec<StepF> both_d, float t_max,
                        Beam& beam) const {
    const StepF d;
    const StepU du;
    alignas(32) static constexpr std::uint32_t kAxes[8] = {~0u, ~0u, ~0u, 0, ~0u, ~0u, ~0u, 0};
    alignas(32) static constexpr std::uint32_t kUpper[8] = {
        0, 0, 0, 0, 0x80000000u, 0x80000000u, 0x80000000u, 0x80000000u};
    const auto is_axis = hn::BitCast(d, hn::Load(du, kAxes));
    const auto upper = hn::BitCast(d, hn::Load(du, kUpper));
    const auto origin = hn::And(both_o, is_axis);
    const auto direction = hn::And(both_d, is_axis);
    const auto sides = hn::Load(d, opposite);
    const auto size = hn::Abs(direction);
    const auto tiny =
        hn::Max(hn::Mul(hn::MaxOfLanes(d, size), hn::Set(d, 1e-18f)), hn::Set(d, 1e-37f));
    const auto reach = hn::MaxOfLanes(d, hn::Abs(hn::Sub(sides, origin)));
    const auto width = hn::Max(hn::Mul(reach, hn::Set(d, kBeamSlack)),
                               hn::Mul(hn::Set(d, 0x1p-23f), hn::Abs(origin)));
    // The lower bound moves down, the upper up.
    const auto down = hn::Xor(upper, hn::Set(d, -0.0f));
    const auto wide = hn::Add(origin, hn::Xor(width, down));
    const auto safe = hn::IfThenElse(hn::Lt(size, tiny), hn::Xor(tiny, down), direction);
    const auto exact = hn::Div(hn::Set(d, 1.0f), safe);
    const auto begins = hn::Xor(exact, upper);
    const auto reciprocal =
        hn::Mul(exact, hn::IfNegativeThenElse(begins, hn::Set(d, 1.0f - kBeamSlack),
                                              hn::Set(d, 1.0f + kBeamSlack)));
    hn::Store(wide, d, beam.origin);
    hn::Store(reciprocal, d, beam.reciprocal);
    const auto t = hn::Mul(hn::Sub(sides, wide), reciprocal);
    const auto least = hn::Set(d, -kInfinity);
    const auto most = hn::Set(d, kInfinity);
    const auto counts = hn::MaskFromVec(is_axis);
    const auto enter = hn::IfThenElse(counts, hn::IfNegativeThenElse(begins, t, least), least);
    const auto leave = hn::IfThenElse(counts, hn::IfNegativeThenElse(begins, most, t), most);
    beam.t_near = hn::GetLane(hn::Max(hn::MaxOfLanes(d, enter), hn::Zero(d)));
    beam.t_far = hn::GetLane(hn::Min(hn::MinOfLanes(d, leave), hn::Set(d, t_max)));
    return hn::GetLane(reach);
  }
};

#else

struct BeamMaker {
  const Box3f& bounds;
  explicit BeamMaker(const Box3f& b) : bounds(b) {}
  HWY_INLINE void make(const Ray& ray, Beam& beam) const { beam = make_beam(ray, bounds); }
  HWY_INLINE float make(const RowBounds& origins, const RowBounds& directions, float t_max,
                        Beam& beam) const {
    float reach = 0.0f, longest = 0.0f;
    for (int k = 0; k < 3; ++k) {
      reach = std::max({reach, std::abs(bounds.low[k] - origins.high[k]),
                        std::abs(bounds.high[k] - origins.low[k])});
      longest = std::max({longest, std::abs(directions.low[k]), std::abs(directions.high[k])});
    }
    for (int k = 0; k < 3; ++k) {
      set_beam_axis(beam, k, {origins.low[k], origins.high[k]},
                    {directions.low[k], directions.high[k]}, reach, longest);
    }
    clip_beam(beam, bounds, t_max);
    return reach;
  }
};

#endif

}  // namespace HWY_NAMESPACE
}  // namespace abbe
HWY_AFTER_NAMESPACE();

#endif
