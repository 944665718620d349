/// Quick answers to whether chains of a point light may come to a place or to fog on a ray: the
/// eight planes of world/point_chains.h, all at once. Highway code, compiled once per instruction
/// set.

#if defined(ABBE_INTEGRATE_POINT_BOUNDS_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef ABBE_INTEGRATE_POINT_BOUNDS_INL_H_
#undef ABBE_INTEGRATE_POINT_BOUNDS_INL_H_
#else
#define ABBE_INTEGRATE_POINT_BOUNDS_INL_H_
#endif

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

#include "integrate/lanes-inl.h"
#include "world/point_chains.h"

HWY_BEFORE_NAMESPACE();
namespace abbe {
namespace HWY_NAMESPACE {

/// Where a ball lies in the frame of a group of chains.
struct PlaceInGroup {
  float height_m = 0.0f, radius_m = 0.0f;
  float along_m[8];  ///< Along the directions of the bounds.
};

/// Whether a ball may get light from any chain of a group; a quick no.
inline bool may_light(const PointChainGroup& group, const Vec3f& center, float radius_m,
                      PlaceInGroup& place) {
  const Vec3f v = center - group.origin;
  place.height_m = glm::dot(v, group.normal);
  // A place that touches the face is in front of it, too.
  place.radius_m = radius_m + 4e-6f * (std::abs(v.x) + std::abs(v.y) + std::abs(v.z));
  if (place.height_m < -place.radius_m) return false;
  const float u = glm::dot(v, group.u);
  const float w = glm::dot(v, group.v);
  for (std::size_t k = 0; k < 8; ++k) place.along_m[k] = u * kBoundCosine[k] + w * kBoundSine[k];
  return true;
}

/// Whether a place may lie in the bounds of a chain or group.
inline bool is_in_bounds(const PlaceInGroup& place, const std::array<float, 8>& reach,
                         const std::array<float, 8>& slope) {
  const hn::CappedTag<float, 8> d;
  const auto height = hn::Set(d, std::max(place.height_m, 0.0f));
  const auto radius = hn::Set(d, place.radius_m);
  for (std::size_t k = 0; k < 8; k += hn::Lanes(d)) {
    const auto slopes = hn::LoadU(d, slope.data() + k);
    const auto grown = hn::Add(hn::Mul(height, slopes), hn::Mul(radius, hn::Abs(slopes)));
    const auto most = hn::Add(hn::Add(hn::LoadU(d, reach.data() + k), radius), grown);
    if (!hn::AllTrue(d, hn::Le(hn::LoadU(d, place.along_m + k), most))) return false;
  }
  return true;
}

/// Whether a place may get light from a chain.
inline bool is_in_bounds(const PlaceInGroup& place, const PointChains& all,
                         const PointChain& chain) {
  if (!is_in_bounds(place, chain.reach, chain.slope)) return false;
  const std::uint32_t last = chain.first_cone + chain.cone_count;
  for (std::uint32_t i = chain.first_cone; i < last; ++i) {
    if (is_in_bounds(place, all.cones[i].reach, all.cones[i].slope)) return true;
  }
  return false;
}

/// The part of a ray [0, end_m) that may lie in the bounds of a chain or group; false where that is
/// nothing.
inline bool StretchInBounds(const PointChainGroup& group, const std::array<float, 8>& reach,
                            const std::array<float, 8>& slope, const Vec3f& origin,
                            const Vec3f& direction, float end_m, float* begin, float* end) {
  const hn::CappedTag<float, 8> d;
  const Vec3f v = origin - group.origin;
  const float height = glm::dot(v, group.normal);
  const float rise = glm::dot(direction, group.normal);
  float first = 0.0f;
  float last = end_m;
  *begin = *end = 0.0f;
  // In front of the face.
  if (rise > 0.0f) first = std::max(first, -height / rise);
  if (rise < 0.0f) last = std::min(last, -height / rise);
  if (rise == 0.0f && height < 0.0f) return false;
  const auto zero = hn::Zero(d);
  const auto heights = hn::Set(d, height);
  const auto rises = hn::Set(d, rise);
  const auto along = [&](const Vec3f& x, std::size_t k) {
    return hn::Add(hn::Mul(hn::LoadU(d, kBoundCosine.data() + k), hn::Set(d, glm::dot(x, group.u))),
                   hn::Mul(hn::LoadU(d, kBoundSine.data() + k), hn::Set(d, glm::dot(x, group.v))));
  };
  for (std::size_t k = 0; k < 8; k += hn::Lanes(d)) {
    const auto slopes = hn::LoadU(d, slope.data() + k);
    const auto room =
        hn::Sub(hn::Add(hn::LoadU(d, reach.data() + k), hn::Mul(heights, slopes)), along(v, k));
    const auto growth = hn::Sub(hn::Mul(rises, slopes), along(direction, k));
    const auto crossing = hn::Div(hn::Neg(room), growth);
    const auto begins = hn::IfThenElse(hn::Gt(growth, zero), crossing, hn::Set(d, first));
    const auto ends = hn::IfThenElse(hn::Lt(growth, zero), crossing, hn::Set(d, last));
    first = std::max(first, hn::GetLane(hn::MaxOfLanes(d, begins)));
    last = std::min(last, hn::GetLane(hn::MinOfLanes(d, ends)));
  }
  *begin = first;
  *end = std::max(first, last);
  return first < last;
}

}  // namespace HWY_NAMESPACE
}  // namespace abbe
HWY_AFTER_NAMESPACE();

#endif  // ABBE_INTEGRATE_POINT_BOUNDS_INL_H_
