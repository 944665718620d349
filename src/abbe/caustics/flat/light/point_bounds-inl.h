/// Quick answers to whether chains of a point light may come to a place or to fog on a ray: the
/// eight planes of caustics/flat/point_chain.h, all at once. Highway code, compiled once per
/// instruction set.

#if defined(ABBE_CAUSTICS_FLAT_LIGHT_POINT_BOUNDS_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef ABBE_CAUSTICS_FLAT_LIGHT_POINT_BOUNDS_INL_H_
#undef ABBE_CAUSTICS_FLAT_LIGHT_POINT_BOUNDS_INL_H_
#else
#define ABBE_CAUSTICS_FLAT_LIGHT_POINT_BOUNDS_INL_H_
#endif

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

#include "abbe/caustics/flat/point_chain.h"
#include "abbe/math/lanes-inl.h"
#include "abbe/world/light/lights.h"

HWY_BEFORE_NAMESPACE();
namespace abbe {
namespace HWY_NAMESPACE {

/// Whether a place may lie in the bounds of a chain or group.
inline bool is_in_bounds(const PlaceInGroup& place, const ConeBounds& bounds) {
  const hn::CappedTag<float, 8> d;
  const auto height = hn::Set(d, std::max(place.height_m, 0.0f));
  const auto radius = hn::Set(d, place.radius_m);
  for (std::size_t k = 0; k < 8; k += hn::Lanes(d)) {
    const auto slopes = hn::LoadU(d, bounds.slope.data() + k);
    const auto grown = hn::Add(hn::Mul(height, slopes), hn::Mul(radius, hn::Abs(slopes)));
    const auto most = hn::Add(hn::Add(hn::LoadU(d, bounds.reach.data() + k), radius), grown);
    if (!hn::AllTrue(d, hn::Le(hn::LoadU(d, place.along_m + k), most))) return false;
  }
  return true;
}

/// Whether a place may get light from a chain.
inline bool is_in_bounds(const PlaceInGroup& place, const PointChains& all,
                         const PointChain& chain) {
  if (!is_in_bounds(place, chain.bounds)) return false;
  for (std::uint32_t b = chain.first_bunch; b < chain.last_bunch; ++b) {
    const ConeBunch& bunch = all.bunches[b];
    if (!is_in_bounds(place, bunch.bounds)) continue;
    for (std::uint32_t c = bunch.first_cone; c < bunch.last_cone; ++c) {
      if (is_in_bounds(place, all.cones[c])) return true;
    }
  }
  return false;
}

/// The places of the lanes of a spread fan in the frame of a group of chains.
template <class D>
class LanesInGroup {
 public:
  /// Returns those of `among` that the group may light; places may be off by `rounding_m`.
  LaneMask place(int stride, const PointChainGroup& group, const LaneArray3& positions,
                 float rounding_m, const LaneMask& among) {
    const D d;
    const V touches = hn::Set(d, kTouches);
    LaneMask found;
    for (int i = 0; i < stride; i += static_cast<int>(hn::Lanes(d))) {
      const auto wanted = LanesFrom(d, among, i);
      if (hn::AllFalse(d, wanted)) continue;
      const Vec3Of<D> v = Combine3(d, hn::Set(d, 1.0f), Load3(d, positions, i), hn::Set(d, -1.0f),
                                   Set3(d, group.origin));
      const V height = Dot3(d, v, Set3(d, group.normal));
      const V size = hn::Add(hn::Add(hn::Abs(v.x), hn::Abs(v.y)), hn::Abs(v.z));
      const V radius = hn::Add(hn::Mul(touches, size), hn::Set(d, rounding_m));
      const V u = Dot3(d, v, Set3(d, group.u));
      const V w = Dot3(d, v, Set3(d, group.v));
      for (std::size_t k = 0; k < 8; ++k) {
        hn::Store(
            hn::Add(hn::Mul(u, hn::Set(d, kBoundCosine[k])), hn::Mul(w, hn::Set(d, kBoundSine[k]))),
            d, along_m_[k].v + i);
      }
      hn::Store(radius, d, radius_m_.v + i);
      hn::Store(hn::Max(height, hn::Zero(d)), d, height_m_.v + i);
      const auto is_in_front = hn::And(wanted, hn::Ge(height, hn::Neg(radius)));
      SetLanesFrom(d, in_cone(group.bounds, is_in_front, i), i, found);
    }
    return found;
  }

  /// Of these, those that a chain may light.
  LaneMask in_bounds(int stride, const PointChains& all, const PointChain& chain,
                     const LaneMask& among) const {
    const D d;
    LaneMask found;
    for (int i = 0; i < stride; i += static_cast<int>(hn::Lanes(d))) {
      auto left = in_cone(chain.bounds, LanesFrom(d, among, i), i);
      const auto wanted = left;
      for (std::uint32_t b = chain.first_bunch; b < chain.last_bunch; ++b) {
        const ConeBunch& bunch = all.bunches[b];
        if (hn::AllFalse(d, in_cone(bunch.bounds, left, i))) continue;
        for (std::uint32_t c = bunch.first_cone; c < bunch.last_cone; ++c) {
          left = hn::AndNot(in_cone(all.cones[c], left, i), left);
        }
      }
      SetLanesFrom(d, hn::AndNot(left, wanted), i, found);
    }
    return found;
  }

 private:
  using V = VecOf<D>;

  hn::Mask<D> in_cone(const ConeBounds& bounds, hn::Mask<D> among, int i) const {
    const D d;
    const V height = hn::Load(d, height_m_.v + i);
    const V radius = hn::Load(d, radius_m_.v + i);
    for (std::size_t k = 0; k < 8; ++k) {
      const V grown = hn::Add(hn::Mul(height, hn::Set(d, bounds.slope[k])),
                              hn::Mul(radius, hn::Set(d, 1.0f + std::abs(bounds.slope[k]))));
      const V most = hn::Add(hn::Set(d, bounds.reach[k]), grown);
      among = hn::And(among, hn::Le(hn::Load(d, along_m_[k].v + i), most));
      if (hn::AllFalse(d, among)) break;
    }
    return among;
  }

  LaneArray height_m_, radius_m_;
  std::array<LaneArray, 8> along_m_;  ///< Along the directions of the bounds.
};

/// The part of a ray [0, end) that may lie in the bounds of a chain or group.
inline RaySegment SegmentInBounds(const PointChainGroup& group, const ConeBounds& bounds,
                                  const Vec3f& origin, const Vec3f& direction, float end_m) {
  const hn::CappedTag<float, 8> d;
  const Vec3f v = origin - group.origin;
  const float height = glm::dot(v, group.normal);
  const float rise = glm::dot(direction, group.normal);
  float first = 0.0f;
  float last = end_m;
  // In front of the face.
  if (rise > 0.0f) first = std::max(first, -height / rise);
  if (rise < 0.0f) last = std::min(last, -height / rise);
  if (rise == 0.0f && height < 0.0f) return {};
  const auto zero = hn::Zero(d);
  const auto heights = hn::Set(d, height);
  const auto rises = hn::Set(d, rise);
  const auto along = [&](const Vec3f& x, std::size_t k) {
    return hn::Add(hn::Mul(hn::LoadU(d, kBoundCosine.data() + k), hn::Set(d, glm::dot(x, group.u))),
                   hn::Mul(hn::LoadU(d, kBoundSine.data() + k), hn::Set(d, glm::dot(x, group.v))));
  };
  for (std::size_t k = 0; k < 8; k += hn::Lanes(d)) {
    const auto slopes = hn::LoadU(d, bounds.slope.data() + k);
    const auto room = hn::Sub(
        hn::Add(hn::LoadU(d, bounds.reach.data() + k), hn::Mul(heights, slopes)), along(v, k));
    const auto growth = hn::Sub(hn::Mul(rises, slopes), along(direction, k));
    const auto crossing = hn::Div(hn::Neg(room), growth);
    const auto begins = hn::IfThenElse(hn::Gt(growth, zero), crossing, hn::Set(d, first));
    const auto ends = hn::IfThenElse(hn::Lt(growth, zero), crossing, hn::Set(d, last));
    first = std::max(first, hn::GetLane(hn::MaxOfLanes(d, begins)));
    last = std::min(last, hn::GetLane(hn::MinOfLanes(d, ends)));
  }
  return {first, last};
}

/// The same for the light of a chain: from where the ray enters the first of its parts to where it
/// leaves the last.
inline RaySegment SegmentInCones(const PointChainGroup& group, const PointChains& all,
                                 const PointChain& chain, const Vec3f& origin,
                                 const Vec3f& direction, float end_m) {
  const auto in = [&](const ConeBounds& bounds) {
    return SegmentInBounds(group, bounds, origin, direction, end_m);
  };
  const auto is_there = [](const RaySegment& segment) { return segment.begin_m < segment.end_m; };
  RaySegment found;
  const RaySegment whole = in(chain.bounds);
  if (!is_there(whole)) return found;
  for (std::uint32_t b = chain.first_bunch; b < chain.last_bunch; ++b) {
    const ConeBunch& bunch = all.bunches[b];
    if (!is_there(in(bunch.bounds))) continue;
    for (std::uint32_t c = bunch.first_cone; c < bunch.last_cone; ++c) {
      const RaySegment part = in(all.cones[c]);
      if (!is_there(part)) continue;
      if (!is_there(found)) found = part;
      found = {std::min(found.begin_m, part.begin_m), std::max(found.end_m, part.end_m)};
    }
  }
  return found;
}

}  // namespace HWY_NAMESPACE
}  // namespace abbe
HWY_AFTER_NAMESPACE();

#endif  // ABBE_CAUSTICS_FLAT_LIGHT_POINT_BOUNDS_INL_H_
