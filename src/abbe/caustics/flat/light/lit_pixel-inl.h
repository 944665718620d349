/// The part of a pixel that light falls on, for light whose borders are planes. Highway code,
/// compiled once per instruction set.

#if defined(ABBE_CAUSTICS_FLAT_LIGHT_LIT_PIXEL_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef ABBE_CAUSTICS_FLAT_LIGHT_LIT_PIXEL_INL_H_
#undef ABBE_CAUSTICS_FLAT_LIGHT_LIT_PIXEL_INL_H_
#else
#define ABBE_CAUSTICS_FLAT_LIGHT_LIT_PIXEL_INL_H_
#endif

#include "abbe/caustics/flat/light/pixel_on_surface.h"
#include "abbe/math/lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace abbe {
namespace HWY_NAMESPACE {

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

#endif  // ABBE_CAUSTICS_FLAT_LIGHT_LIT_PIXEL_INL_H_
