/// Vectors of three over wavelength lanes, and masks between bits and vectors. Highway code,
/// compiled once per instruction set.

#if defined(ABBE_MATH_LANES_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef ABBE_MATH_LANES_INL_H_
#undef ABBE_MATH_LANES_INL_H_
#else
#define ABBE_MATH_LANES_INL_H_
#endif

#include <hwy/highway.h>

#include <cmath>

#include "abbe/math/lane_array.h"
#include "abbe/math/lane_mask.h"

HWY_BEFORE_NAMESPACE();
namespace abbe {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

template <class D>
using VecOf = hn::Vec<D>;

/// Three vectors: one 3-vector per lane.
template <class D>
struct Vec3Of {
  VecOf<D> x, y, z;
};

template <class D>
HWY_INLINE Vec3Of<D> Load3(D d, const LaneArray3& a, int i) {
  return {hn::Load(d, a.x.v + i), hn::Load(d, a.y.v + i), hn::Load(d, a.z.v + i)};
}

template <class D>
HWY_INLINE void Store3(D d, const Vec3Of<D>& v, LaneArray3& a, int i) {
  hn::Store(v.x, d, a.x.v + i);
  hn::Store(v.y, d, a.y.v + i);
  hn::Store(v.z, d, a.z.v + i);
}

template <class D>
HWY_INLINE VecOf<D> Dot3(D, const Vec3Of<D>& a, const Vec3Of<D>& b) {
  return hn::Add(hn::Add(hn::Mul(a.x, b.x), hn::Mul(a.y, b.y)), hn::Mul(a.z, b.z));
}

template <class D>
HWY_INLINE Vec3Of<D> Set3(D d, const Vec3f& v) {
  return {hn::Set(d, v.x), hn::Set(d, v.y), hn::Set(d, v.z)};
}

/// s·a + t·b.
template <class D>
HWY_INLINE Vec3Of<D> Combine3(D, VecOf<D> s, const Vec3Of<D>& a, VecOf<D> t, const Vec3Of<D>& b) {
  return {hn::Add(hn::Mul(s, a.x), hn::Mul(t, b.x)), hn::Add(hn::Mul(s, a.y), hn::Mul(t, b.y)),
          hn::Add(hn::Mul(s, a.z), hn::Mul(t, b.z))};
}

template <class D>
HWY_INLINE Vec3Of<D> Select3(D, hn::Mask<D> mask, const Vec3Of<D>& yes, const Vec3Of<D>& no) {
  return {hn::IfThenElse(mask, yes.x, no.x), hn::IfThenElse(mask, yes.y, no.y),
          hn::IfThenElse(mask, yes.z, no.z)};
}

template <class D>
HWY_INLINE Vec3Of<D> Normalized3(D d, const Vec3Of<D>& a) {
  const auto scale = hn::Div(hn::Set(d, 1.0f), hn::Sqrt(Dot3(d, a, a)));
  return {hn::Mul(a.x, scale), hn::Mul(a.y, scale), hn::Mul(a.z, scale)};
}

/// The same value in all lanes.
template <class D>
HWY_INLINE void Splat(D d, int stride, float value, LaneArray& a) {
  const auto v = hn::Set(d, value);
  for (int i = 0; i < stride; i += static_cast<int>(hn::Lanes(d))) hn::Store(v, d, a.v + i);
}

template <class D>
HWY_INLINE void Splat(D d, int stride, const Vec3f& value, LaneArray3& a) {
  Splat(d, stride, value.x, a.x);
  Splat(d, stride, value.y, a.y);
  Splat(d, stride, value.z, a.z);
}

/// The lanes of a mask from lane i on, as a vector mask. Domain: i a multiple of Lanes(d).
template <class D>
HWY_INLINE hn::Mask<D> LanesFrom(D d, const LaneMask& lanes, int i) {
  const std::uint32_t bits = lanes.block16(i / 16) >> (i % 16);
  const std::uint8_t bytes[8] = {static_cast<std::uint8_t>(bits),
                                 static_cast<std::uint8_t>(bits >> 8)};
  return hn::LoadMaskBits(d, bytes);
}

/// A vector mask as bits of lanes from i on. Domain: i a multiple of Lanes(d).
template <class D>
HWY_INLINE void SetLanesFrom(D d, hn::Mask<D> mask, int i, LaneMask& lanes) {
  std::uint8_t bytes[8] = {};
  hn::StoreMaskBits(d, mask, bytes);
  const std::uint32_t valid = hn::Lanes(d) >= 16 ? 0xffffu : (1u << hn::Lanes(d)) - 1u;
  const std::uint32_t bits = (bytes[0] | static_cast<std::uint32_t>(bytes[1]) << 8) & valid;
  lanes.set_block16(i / 16, bits << (i % 16));
}

/// The largest distance from a place to those of some lanes.
template <class D>
HWY_INLINE float LargestDistance(D d, int stride, const LaneArray3& places, const LaneMask& lanes,
                                 const Vec3f& from) {
  auto square = hn::Zero(d);
  for (int i = 0; i < stride; i += static_cast<int>(hn::Lanes(d))) {
    const auto away =
        Combine3(d, hn::Set(d, 1.0f), Load3(d, places, i), hn::Set(d, -1.0f), Set3(d, from));
    square = hn::Max(square, hn::IfThenElseZero(LanesFrom(d, lanes, i), Dot3(d, away, away)));
  }
  return std::sqrt(hn::GetLane(hn::MaxOfLanes(d, square)));
}

/// The largest value among some lanes, at least 0.
template <class D>
HWY_INLINE float LargestOf(D d, int stride, const LaneArray& values, const LaneMask& lanes) {
  auto largest = hn::Zero(d);
  for (int i = 0; i < stride; i += static_cast<int>(hn::Lanes(d))) {
    const auto here = hn::Load(d, values.v + i);
    largest = hn::Max(largest, hn::IfThenElseZero(LanesFrom(d, lanes, i), here));
  }
  return hn::GetLane(hn::MaxOfLanes(d, largest));
}

/// The lanes of `among` whose value equals `value`.
template <class D, typename T>
HWY_INLINE LaneMask LanesWith(D, int stride, const T* values, T value, const LaneMask& among) {
  const hn::Rebind<T, D> d;
  LaneMask found;
  for (int i = 0; i < stride; i += static_cast<int>(hn::Lanes(d))) {
    SetLanesFrom(d, hn::Eq(hn::Load(d, values + i), hn::Set(d, value)), i, found);
  }
  return found & among;
}

}  // namespace HWY_NAMESPACE
}  // namespace abbe
HWY_AFTER_NAMESPACE();

#endif  // ABBE_MATH_LANES_INL_H_
