#include "abbe/accel/kd/build/few_split.h"

#include <algorithm>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "abbe/accel/kd/build/few_split.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace abbe {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

using FewTag = hn::CappedTag<float, 16>;
using FewVec = hn::Vec<FewTag>;
using FewMask = hn::Mask<FewTag>;

// The lower and then the upper sides of the primitives along an axis, and infinity behind them.
struct alignas(64) Sides {
  float at[2 * kFewPrimitives + 2 * 16];
  bool has_planar = false;
};

// The best plane of each lane; of equally good ones the lowest.
struct BestOfLanes {
  FewVec cost, plane;
  FewMask planar_below;

  HWY_INLINE void take(FewMask valid, FewVec new_cost, FewVec new_plane, bool is_planar_below) {
    const auto lower = hn::And(hn::Eq(new_cost, cost), hn::Lt(new_plane, plane));
    const auto better = hn::And(valid, hn::Or(hn::Lt(new_cost, cost), lower));
    cost = hn::IfThenElse(better, new_cost, cost);
    plane = hn::IfThenElse(better, new_plane, plane);
    planar_below =
        is_planar_below ? hn::Or(planar_below, better) : hn::AndNot(better, planar_below);
  }
};

// SahCell::rate() for the planes of all lanes.
class LaneCosts {
 public:
  HWY_INLINE LaneCosts(const SahCell& cell, int axis) : cell_(cell), axis_(axis) {}

  HWY_INLINE void rate(FewVec plane, FewVec below, FewVec above, bool planar_below,
                       BestOfLanes& best) const {
    const FewTag d;
    const auto low = hn::Set(d, cell_.box.low[axis_]);
    const auto high = hn::Set(d, cell_.box.high[axis_]);
    const auto inside = hn::And(hn::Gt(plane, low), hn::Lt(plane, high));
    const auto most = hn::Set(d, static_cast<float>(cell_.max_parts));
    const auto valid = hn::And(inside, hn::Le(hn::Add(below, above), most));
    const auto cost = hn::Add(
        hn::Add(hn::Set(d, cell_.traversal_cost), hn::Mul(share(hn::Sub(plane, low)), leaf(below))),
        hn::Mul(share(hn::Sub(high, plane)), leaf(above)));
    const auto is_empty = hn::Eq(hn::Min(below, above), hn::Zero(d));
    const auto factor = hn::IfThenElse(is_empty, hn::Set(d, cell_.empty_factor), hn::Set(d, 1.0f));
    best.take(valid, hn::Mul(cost, factor), plane, planar_below);
  }

 private:
  // Of the cell's surface, the part on one side of a plane so far from that side's end.
  HWY_INLINE FewVec share(FewVec depth) const {
    const FewTag d;
    const auto area =
        hn::Add(hn::Set(d, cell_.side(axis_)), hn::Mul(depth, hn::Set(d, cell_.rim(axis_))));
    return hn::Mul(area, hn::Set(d, cell_.inverse_area));
  }
  // Quotients of small whole numbers, rounded, are whole only where they are so exactly.
  HWY_INLINE FewVec leaf(FewVec n) const {
    const FewTag d;
    const auto blocks = hn::Ceil(hn::Div(n, hn::Set(d, static_cast<float>(cell_.block_size))));
    return hn::Mul(hn::Set(d, cell_.block_cost),
                   hn::Max(blocks, hn::Mul(hn::Set(d, cell_.solid_share), n)));
  }

  const SahCell& cell_;
  const int axis_;
};

// Per lane, how often a mask held.
struct LaneCount {
  using Int = hn::RebindToSigned<FewTag>;
  hn::Vec<Int> n;

  HWY_INLINE void add(FewMask mask) {
    n = hn::Sub(n, hn::BitCast(Int(), hn::VecFromMask(FewTag(), mask)));
  }
  HWY_INLINE FewVec value() const { return hn::ConvertTo(FewTag(), n); }
};

// Primitives that are flat in the planes of the lanes.
HWY_INLINE FewVec CountPlanar(const Sides& sides, std::size_t count, FewVec plane) {
  const FewTag d;
  LaneCount in_plane{hn::Zero(LaneCount::Int())};
  for (std::size_t i = 0; i < count; ++i) {
    if (sides.at[i] == sides.at[count + i]) {
      in_plane.add(hn::Eq(hn::Set(d, sides.at[i]), plane));
    }
  }
  return in_plane.value();
}

HWY_INLINE void SearchAxis(const Sides& sides, std::size_t count, int axis, SahCell& cell) {
  const FewTag d;
  constexpr std::size_t kStep = hn::MaxLanes(d);
  const LaneCosts costs(cell, axis);
  BestOfLanes best{hn::Set(d, cell.best.cost), hn::Set(d, -kInfinity),
                   hn::Eq(hn::Zero(d), hn::Set(d, 1.0f))};
  // Two vectors of planes at a time: each primitive is loaded for both.
  for (std::size_t p = 0; p < 2 * count; p += 2 * kStep) {
    const auto plane = hn::Load(d, sides.at + p);
    const auto plane_2 = hn::Load(d, sides.at + p + kStep);
    const LaneCount none{hn::Zero(LaneCount::Int())};
    LaneCount below = none, above = none, below_2 = none, above_2 = none;
    for (std::size_t i = 0; i < count; ++i) {
      const auto low = hn::Set(d, sides.at[i]);
      const auto high = hn::Set(d, sides.at[count + i]);
      below.add(hn::Lt(low, plane));
      above.add(hn::Gt(high, plane));
      below_2.add(hn::Lt(low, plane_2));
      above_2.add(hn::Gt(high, plane_2));
    }
    const auto rate = [&](FewVec at, const LaneCount& n_below, const LaneCount& n_above) HWY_ATTR {
      const auto b = n_below.value(), a = n_above.value();
      if (!sides.has_planar) return costs.rate(at, b, a, true, best);
      const auto in_plane = CountPlanar(sides, count, at);
      costs.rate(at, hn::Add(b, in_plane), a, true, best);
      costs.rate(at, b, hn::Add(a, in_plane), false, best);
    };
    rate(plane, below, above);
    rate(plane_2, below_2, above_2);
  }
  const auto least = hn::MinOfLanes(d, best.cost);
  if (!(hn::GetLane(least) < cell.best.cost)) return;
  const auto is_least = hn::Eq(best.cost, least);
  const auto plane = hn::MinOfLanes(d, hn::IfThenElse(is_least, best.plane, hn::Set(d, kInfinity)));
  const auto chosen = hn::And(is_least, hn::Eq(best.plane, plane));
  const bool planar_below = !hn::AllFalse(d, hn::And(chosen, best.planar_below));
  cell.best = {axis, hn::GetLane(plane), planar_below, hn::GetLane(least)};
  cell.found = true;
}

void SearchFew(std::span<const BuildPrimitive> primitives, SahCell& cell) {
  const std::size_t count = primitives.size();
  Sides sides[3];
  for (std::size_t i = 0; i < count; ++i) {
    for (int axis = 0; axis < 3; ++axis) {
      const float low = primitives[i].low[axis], high = primitives[i].high[axis];
      sides[axis].at[i] = low;
      sides[axis].at[count + i] = high;
      sides[axis].has_planar |= low == high;
    }
  }
  for (int axis = 0; axis < 3; ++axis) {
    std::fill_n(sides[axis].at + 2 * count, 2 * 16, kInfinity);
    SearchAxis(sides[axis], count, axis, cell);
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace abbe
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace abbe {
namespace {
HWY_EXPORT(SearchFew);
}  // namespace

void search_few(std::span<const BuildPrimitive> primitives, SahCell& cell) {
  HWY_DYNAMIC_DISPATCH(SearchFew)(primitives, cell);
}

}  // namespace abbe
#endif  // HWY_ONCE
