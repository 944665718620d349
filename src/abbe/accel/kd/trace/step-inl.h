/// One step down the tree: which of a wide node's eight children a beam meets, in what order.
/// Compiled once for each instruction set level.

#if defined(ABBE_ACCEL_KD_TRACE_STEP_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef ABBE_ACCEL_KD_TRACE_STEP_INL_H_
#undef ABBE_ACCEL_KD_TRACE_STEP_INL_H_
#else
#define ABBE_ACCEL_KD_TRACE_STEP_INL_H_
#endif

#include <hwy/cache_control.h>
#include <hwy/highway.h>

#include "abbe/accel/kd/trace/beam-inl.h"
#include "abbe/accel/kd/trace/state.h"
#include "abbe/accel/kd/trace/step.h"

HWY_BEFORE_NAMESPACE();
namespace abbe {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

#if HWY_MAX_BYTES >= 32

// Constants of the step for each child: shift of its plane's axis, its side, its plane.
struct StepConstants {
  alignas(32) std::uint32_t shift1[8] = {4, 4, 4, 4, 8, 8, 8, 8};
  alignas(32) std::uint32_t shift2[8] = {12, 12, 16, 16, 20, 20, 24, 24};
  alignas(32) std::uint32_t shift_plane[8] = {0, 4, 8, 12, 16, 20, 24, 28};
  alignas(32) std::uint32_t side0[8] = {0, 0, 0, 0, 4, 4, 4, 4};
  alignas(32) std::uint32_t side1[8] = {0, 0, 4, 4, 0, 0, 4, 4};
  alignas(32) std::uint32_t side2[8] = {0, 4, 0, 4, 0, 4, 0, 4};
  alignas(32) std::uint32_t plane1[8] = {1, 1, 1, 1, 2, 2, 2, 2};
  alignas(32) std::uint32_t plane2[8] = {3, 3, 4, 4, 5, 5, 6, 6};
};
inline constexpr StepConstants kStep;

// Eight lanes of a table of eight; the hardware reads three bits of an index.
template <class V, class VI>
HWY_INLINE V Pick(V table, VI index) {
#if HWY_IS_DEBUG_BUILD
  index = hn::And(index, hn::Set(StepU(), 7u));
#endif
  return hn::TableLookupLanes(table, hn::IndicesFromVec(hn::DFromV<V>(), index));
}

HWY_INLINE void PushChildren(const WideNode& node, const Beam& beam, float t_near, float t_far,
                             float farthest, TraversalStack& stack) {
  const StepF d;
  const StepU du;
  const auto planes = hn::Load(d, node.planes);  // And the axes in the last lane, as a float.
  const auto axes = hn::Set(du, node.axes);
  const auto origins = hn::Load(d, beam.origin);
  const auto reciprocals = hn::Load(d, beam.reciprocal);
  const auto least = hn::Set(d, -kInfinity);
  const auto most = hn::Set(d, kInfinity);

  // The axis of a plane has bit 2 clear; with the side in that place it is an index to the beam.
  const auto side0 = hn::Load(du, kStep.side0);
  const auto side1 = hn::Load(du, kStep.side1);
  const auto side2 = hn::Load(du, kStep.side2);
  const auto key0 = hn::Or(axes, side0);
  const auto key1 = hn::Or(hn::Shr(axes, hn::Load(du, kStep.shift1)), side1);
  const auto key2 = hn::Or(hn::Shr(axes, hn::Load(du, kStep.shift2)), side2);
  const auto r0 = Pick(reciprocals, key0);
  const auto r1 = Pick(reciprocals, key1);
  const auto r2 = Pick(reciprocals, key2);
  const auto plane0 = hn::Set(d, node.planes[0]);
  const auto plane1 = Pick(planes, hn::Load(du, kStep.plane1));
  const auto plane2 = Pick(planes, hn::Load(du, kStep.plane2));
  const auto t0 = hn::Mul(hn::Sub(plane0, Pick(origins, key0)), r0);
  const auto t1 = hn::Mul(hn::Sub(plane1, Pick(origins, key1)), r1);
  const auto t2 = hn::Mul(hn::Sub(plane2, Pick(origins, key2)), r2);
  // The half-line begins at t where the reciprocal is negative below a plane, positive above it.
  const auto begins0 = hn::Xor(r0, hn::BitCast(d, hn::ShiftLeft<29>(side0)));
  const auto begins1 = hn::Xor(r1, hn::BitCast(d, hn::ShiftLeft<29>(side1)));
  const auto begins2 = hn::Xor(r2, hn::BitCast(d, hn::ShiftLeft<29>(side2)));
  auto enter = hn::Max(hn::IfNegativeThenElse(begins0, t0, least),
                       hn::IfNegativeThenElse(begins1, t1, least));
  auto leave =
      hn::Min(hn::IfNegativeThenElse(begins0, most, t0), hn::IfNegativeThenElse(begins1, most, t1));
  enter = hn::Max(enter, hn::Max(hn::IfNegativeThenElse(begins2, t2, least), hn::Set(d, t_near)));
  leave = hn::Min(leave, hn::Min(hn::IfNegativeThenElse(begins2, most, t2), hn::Set(d, t_far)));

  // The side of the origin comes first: a ray that meets both sides starts there.
  const auto plane_key = hn::And(hn::Shr(axes, hn::Load(du, kStep.shift_plane)), hn::Set(du, 3u));
  const auto is_flipped = hn::Lt(planes, Pick(origins, plane_key));
  std::uint8_t flips = 0;
  hn::StoreMaskBits(d, is_flipped, &flips);
  const hn::FixedTag<std::uint8_t, 8> d8;
  const auto order = hn::PromoteTo(du, hn::LoadU(d8, kChildOrder.order[flips & 127]));

  const auto child = hn::Load(du, node.children);
  const auto is_met = hn::And(hn::Le(enter, hn::Min(leave, hn::Set(d, farthest))),
                              hn::RebindMask(d, hn::Ne(child, hn::Zero(du))));
  // Which children come onto the stack, in order: one vector of numbers is compressed instead of
  // three of values. In a register, for compressing stores are slow on some processors.
  const auto met = hn::VecFromMask(du, hn::RebindMask(du, is_met));
  const auto pushed = hn::Compress(order, hn::MaskFromVec(Pick(met, order)));
  const int top = stack.top;
  hn::StoreU(Pick(child, pushed), du, stack.child + top);
  hn::StoreU(Pick(enter, pushed), d, stack.t_near + top);
  hn::StoreU(Pick(leave, pushed), d, stack.t_far + top);
  stack.top = top + static_cast<int>(hn::CountTrue(d, is_met));
}

#else

HWY_INLINE void PushChildren(const WideNode& node, const Beam& beam, float t_near, float t_far,
                             float farthest, TraversalStack& stack) {
  push_children(node, beam, t_near, t_far, farthest, stack);
}

#endif

HWY_INLINE void PrefetchBlock(const KdView& view, KdChild leaf) {
  const char* const block = reinterpret_cast<const char*>(&view.block(leaf));
  for (std::size_t i = 0; i < view.lines_ahead; ++i) hwy::Prefetch(block + 64 * i);
}

// A node, or the first block of a leaf.
HWY_INLINE void PrefetchAll(const KdView& view, KdChild cell) {
  if (cell < kLeafBit) {
    hwy::Prefetch(view.nodes + cell);
  } else {
    PrefetchBlock(view, cell);
  }
}

// Does one thing for each of 0 to count − 1, and kLag calls later what follows from it: its outcome
// is known by then, and the memory that what follows asks for is asked for bit by bit, as fast as
// it comes. All at the end of a round, the requests would queue up, and the processor behind them.
// Both must be inlined: they are too small to be called.
template <std::size_t kLag, class First, class Then>
HWY_INLINE void ForEachStaggered(std::size_t count, const First& first, const Then& then) {
  for (std::size_t i = 0; i < count; ++i) {
    first(i);
    if (i >= kLag) then(i - kLag);
  }
  for (std::size_t i = count > kLag ? count - kLag : 0; i < count; ++i) then(i);
}

}  // namespace HWY_NAMESPACE
}  // namespace abbe
HWY_AFTER_NAMESPACE();

#endif
