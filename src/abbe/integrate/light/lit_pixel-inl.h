/// The part of a pixel that light falls on, for light whose borders are planes. Highway code,
/// compiled once per instruction set.

#if defined(ABBE_INTEGRATE_LIGHT_LIT_PIXEL_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef ABBE_INTEGRATE_LIGHT_LIT_PIXEL_INL_H_
#undef ABBE_INTEGRATE_LIGHT_LIT_PIXEL_INL_H_
#else
#define ABBE_INTEGRATE_LIGHT_LIT_PIXEL_INL_H_
#endif

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

#include "abbe/integrate/integrator.h"
#include "abbe/math/lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace abbe {
namespace HWY_NAMESPACE {

/// A part of a plane that light is averaged over: `shift` from a place to its middle, and its
/// sides. A wavelength is lit or not at a place, so that the few samples of a pixel would find a
/// colour of a spectrum or miss it by chance; over the pixel it has a share, and chance has none.
struct PixelOnSurface {
  Vec3f shift{0.0f};
  Vec2f offset_px{0.0f};                                 ///< Of the place from the middle.
  std::array<Vec3f, 2> sides{Vec3f(0.0f), Vec3f(0.0f)};  ///< Of a pixel.
  float reach_m = 0.0f;                                  ///< From the place to its farthest corner.
  float radius_px = 0.0f;            ///< The kernel reaches so many times the sides to both sides.
  const float* cumulated = nullptr;  ///< PixelKernel::cumulated.

  /// Whether there is nothing to average over: a place is lit or not.
  bool is_point() const { return radius_px == 0.0f; }
};

/// The pixel of a camera sample on the plane in which its ray ends. Units: metres.
/// Domain: unit normal.
inline PixelOnSurface pixel_on_surface(const CameraSample& sample, const PixelKernel& kernel,
                                       float distance_m, const Vec3f& normal) {
  PixelOnSurface pixel;
  if (!(kernel.radius_px > 0.0f)) return pixel;
  pixel.offset_px = sample.offset_px;
  pixel.radius_px = kernel.radius_px;
  pixel.cumulated = kernel.cumulated.data();
  // Where the plane is seen edge-on its pixels are cut short: they would be longer than what is
  // there of it.
  constexpr float kLeastFacing = 0.05f;
  const float facing = glm::dot(sample.direction, normal);
  const float divisor = std::copysign(std::max(std::abs(facing), kLeastFacing), facing);
  for (std::size_t k = 0; k < 2; ++k) {
    const Vec3f moved = sample.origin_per_px[k] + distance_m * sample.direction_per_px[k];
    const Vec3f on_plane = (facing * moved - glm::dot(moved, normal) * sample.direction) / divisor;
    pixel.shift -= sample.offset_px[static_cast<int>(k)] * on_plane;
    pixel.sides[k] = on_plane;
    pixel.reach_m += kernel.radius_px * glm::length(on_plane);
  }
  pixel.reach_m += glm::length(pixel.shift);
  return pixel;
}

/// The part of a pixel's kernel along one of its sides that some half-spaces leave.
template <class D>
struct LitPart {
  VecOf<D> first, last;  ///< In pixels from the centre.

  LitPart(D d, const PixelOnSurface& pixel)
      : first(hn::Set(d, -pixel.radius_px)), last(hn::Set(d, pixel.radius_px)) {}

  /// Leaves the places where height + place·rise ≥ 0, in the lanes of `mask`. Domain: rise ≠ 0.
  HWY_INLINE void clip(D d, hn::Mask<D> mask, VecOf<D> height, VecOf<D> rise) {
    const auto border = hn::Neg(hn::Div(height, rise));
    const auto is_up = hn::Gt(rise, hn::Zero(d));
    first = hn::IfThenElse(hn::And(mask, is_up), hn::Max(first, border), first);
    last = hn::IfThenElse(hn::AndNot(is_up, mask), hn::Min(last, border), last);
  }

  HWY_INLINE hn::Mask<D> is_there() const { return hn::Lt(first, last); }
  /// The place of it that is nearest to one of the pixel.
  HWY_INLINE VecOf<D> nearest(D d, float offset_px) const {
    return hn::Min(hn::Max(hn::Set(d, offset_px), first), last);
  }
  /// The kernel's integral over it. Domain: lanes in which it is there; others are undefined.
  HWY_INLINE VecOf<D> share(D d, const PixelOnSurface& pixel) const {
    return hn::Sub(below(d, pixel, last), below(d, pixel, first));
  }

 private:
  static HWY_INLINE VecOf<D> below(D d, const PixelOnSurface& pixel, VecOf<D> place) {
    const hn::RebindToSigned<D> di;
    constexpr float kCells = PixelKernel::kCells;
    const auto scale = hn::Set(d, 0.5f * kCells / pixel.radius_px);
    const auto at = hn::Mul(hn::Add(place, hn::Set(d, pixel.radius_px)), scale);
    const auto inside = hn::Min(hn::Max(at, hn::Zero(d)), hn::Set(d, kCells));
    const auto cell = hn::Min(hn::ConvertTo(di, inside), hn::Set(di, PixelKernel::kCells - 1));
    const auto part = hn::Sub(inside, hn::ConvertTo(d, cell));
    const auto low = hn::GatherIndex(d, pixel.cumulated, cell);
    const auto high = hn::GatherIndex(d, pixel.cumulated + 1, cell);
    return hn::Add(low, hn::Mul(part, hn::Sub(high, low)));
  }
};

}  // namespace HWY_NAMESPACE
}  // namespace abbe
HWY_AFTER_NAMESPACE();

#endif  // ABBE_INTEGRATE_LIGHT_LIT_PIXEL_INL_H_
