/// The part of a pixel that light falls on, for light whose borders are planes. Highway code,
/// compiled once per instruction set.

#if defined(ABBE_CAUSTICS_FLAT_LIGHT_LIT_PIXEL_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef ABBE_CAUSTICS_FLAT_LIGHT_LIT_PIXEL_INL_H_
#undef ABBE_CAUSTICS_FLAT_LIGHT_LIT_PIXEL_INL_H_
#else
#define ABBE_CAUSTICS_FLAT_LIGHT_LIT_PIXEL_INL_H_
#endif

#include <array>
#include <bit>
#include <cstddef>

#include "abbe/caustics/flat/light/pixel_on_surface.h"
#include "abbe/math/lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace abbe {
namespace HWY_NAMESPACE {

/// The part of a line across a pixel that some half-spaces leave.
template <class D>
struct LitPart {
  static constexpr float kEnd = 0.01f;         ///< What share of it each end is.
  static constexpr float kLeastRise = 1e-12f;  ///< Of a cell that holds nothing of the kernel.
  VecOf<D> first, last;                        ///< In pixels from the centre.

  LitPart(D d, const PixelOnSurface& pixel)
      : first(hn::Set(d, -pixel.radius_px)), last(hn::Set(d, pixel.radius_px)) {}

  /// Leaves the places where height + place·rise ≥ 0.
  HWY_INLINE void clip(D d, VecOf<D> height, VecOf<D> rise) {
    const auto zero = hn::Zero(d);
    const auto border = hn::Neg(hn::Div(height, rise));
    first = hn::IfThenElse(hn::Gt(rise, zero), hn::Max(first, border), first);
    last = hn::IfThenElse(hn::Lt(rise, zero), hn::Min(last, border), last);
    const auto never = hn::And(hn::Eq(rise, zero), hn::Lt(height, zero));
    last = hn::IfThenElse(never, first, last);
  }

  HWY_INLINE hn::Mask<D> is_there() const { return hn::Lt(first, last); }
  /// The place that has the share `below_it` of the kernel's integral over it below it, but for its
  /// ends, where a path of light runs along the edges of facets.
  HWY_INLINE VecOf<D> place_above(D d, const PixelOnSurface& pixel, VecOf<D> below_it) const {
    const auto low = below(d, pixel, first);
    const auto place = at_share(d, pixel, hn::MulAdd(below_it, share(d, pixel), low));
    return inside(d, place);
  }
  /// A place of the line, moved off its ends.
  HWY_INLINE VecOf<D> inside(D d, VecOf<D> place) const {
    const auto end = hn::Mul(hn::Sub(last, first), hn::Set(d, kEnd));
    return hn::Min(hn::Max(place, hn::Add(first, end)), hn::Sub(last, end));
  }
  /// The kernel's integral over it. Domain: lanes in which it is there; others are undefined.
  HWY_INLINE VecOf<D> share(D d, const PixelOnSurface& pixel) const {
    return hn::Sub(below(d, pixel, last), below(d, pixel, first));
  }

  /// The kernel's integral up to a place.
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

  /// The place that a share of the kernel's integral lies below: the inverse of below().
  static HWY_INLINE VecOf<D> at_share(D d, const PixelOnSurface& pixel, VecOf<D> wanted) {
    const hn::RebindToSigned<D> di;
    static_assert(std::has_single_bit(static_cast<unsigned>(PixelKernel::kCells)));
    // The last cell that begins below it.
    auto cell = hn::Zero(di);
    for (int step = PixelKernel::kCells / 2; step > 0; step /= 2) {
      const auto further = hn::Add(cell, hn::Set(di, step));
      const auto begin = hn::GatherIndex(d, pixel.cumulated, further);
      cell = hn::IfThenElse(hn::RebindMask(di, hn::Le(begin, wanted)), further, cell);
    }
    const auto low = hn::GatherIndex(d, pixel.cumulated, cell);
    const auto rise = hn::Sub(hn::GatherIndex(d, pixel.cumulated + 1, cell), low);
    const auto part = hn::Div(hn::Sub(wanted, low), hn::Max(rise, hn::Set(d, kLeastRise)));
    const auto inside = hn::Min(hn::Max(part, hn::Zero(d)), hn::Set(d, 1.0f));
    const auto width = hn::Set(d, 2.0f * pixel.radius_px / PixelKernel::kCells);
    return hn::MulAdd(hn::Add(hn::ConvertTo(d, cell), inside), width, hn::Set(d, -pixel.radius_px));
  }
};

/// A border in a pixel, u and v from its middle: it leaves where height + along·u + across·v ≥ 0.
template <class D>
struct PixelLine {
  VecOf<D> height, along, across;
};

/// The part of a pixel's kernel that some lines leave: a convex polygon.
template <class D>
class LitArea {
 public:
  LitArea(D d, const PixelOnSurface& pixel)
      : pixel_(pixel), across_(d, pixel), share_(hn::Zero(d)) {
    const auto reach = hn::Set(d, pixel.radius_px);
    for (const float sign : {1.0f, -1.0f}) add({reach, hn::Set(d, sign), hn::Zero(d)});
  }

  /// More than a pixel can have of edges that matter are left out.
  void add(const PixelLine<D>& line) {
    if (count_ < kMostLines) lines_[count_++] = line;
  }

  /// Finds share(). Returns the lanes in which anything is left.
  ///
  /// The integral over the polygon is that along its edges, counterclockwise, of the kernel's
  /// integral up to u: of each edge over the v at which no other line is nearer.
  hn::Mask<D> integrate(D d) {
    const auto zero = hn::Zero(d);
    const auto reach = hn::Set(d, pixel_.radius_px);
    auto first = reach, last = hn::Neg(reach);
    for (std::size_t k = 0; k < count_; ++k) {
      const PixelLine<D>& line = lines_[k];
      LitPart<D> edge(d, pixel_);
      for (std::size_t other = 0; other < count_; ++other) {
        if (other != k) clip_edge(d, line, lines_[other], other < k, edge);
      }
      const auto is_edge = hn::And(edge.is_there(), hn::Ne(line.along, zero));
      if (hn::AllFalse(d, is_edge)) continue;
      first = hn::IfThenElse(is_edge, hn::Min(first, edge.first), first);
      last = hn::IfThenElse(is_edge, hn::Max(last, edge.last), last);
      const auto up_to_u = integral_along(d, line, edge);
      const auto part = hn::IfThenElse(hn::Lt(line.along, zero), up_to_u, hn::Neg(up_to_u));
      share_ = hn::Add(share_, hn::IfThenElseZero(is_edge, part));
    }
    across_.first = first;
    across_.last = last;
    return hn::And(across_.is_there(), hn::Gt(share_, zero));
  }

  VecOf<D> share() const { return share_; }
  /// Moves a place of the pixel to where the same share of the polygon lies below it in v, and
  /// beside it in u, as of the pixel did: places that are drawn from the kernel are drawn from what
  /// the polygon leaves of it then. Domain: after integrate(), in the lanes that it returned.
  /// Source: Rosenblatt, Remarks on a Multivariate Transformation, 1952.
  void move_in(D d, VecOf<D>& u, VecOf<D>& v) const {
    const auto beside_u = LitPart<D>::below(d, pixel_, u);
    v = place_across(d, LitPart<D>::below(d, pixel_, v));
    u = along_at(d, v).place_above(d, pixel_, beside_u);
  }

 private:
  static constexpr std::size_t kMostLines = 32;
  static constexpr int kStrips = 16;

  // Leaves the v at which a line has the other behind it: of two that bound u from the same side
  // the nearer one is the edge, of two that face each other it has to be on its side. What is
  // compared is antisymmetric to the bit, so that of two lines in one place one is left.
  static HWY_INLINE void clip_edge(D d, const PixelLine<D>& line, const PixelLine<D>& other,
                                   bool is_other_first, LitPart<D>& edge) {
    const auto zero = hn::Zero(d);
    const auto of_line = hn::Abs(line.along), of_other = hn::Abs(other.along);
    const auto face = hn::Lt(hn::Mul(line.along, other.along), zero);
    const auto compare = [&](VecOf<D> own, VecOf<D> others) HWY_ATTR {
      const auto a = hn::Mul(others, of_line), b = hn::Mul(own, of_other);
      return hn::IfThenElse(face, hn::Add(a, b), hn::Sub(a, b));
    };
    const auto height = compare(line.height, other.height);
    const auto rise = compare(line.across, other.across);
    edge.clip(d, height, rise);
    if (!is_other_first) return;
    const auto same = hn::AndNot(face, hn::And(hn::Eq(height, zero), hn::Eq(rise, zero)));
    edge.last = hn::IfThenElse(same, edge.first, edge.last);
  }

  // ∫ K(u(v)) k(v) dv over an edge, K the kernel's integral: in strips, k exactly, K at the middle.
  VecOf<D> integral_along(D d, const PixelLine<D>& line, const LitPart<D>& edge) const {
    const auto scale = hn::Div(hn::Set(d, -1.0f), line.along);
    const auto step = hn::Mul(hn::Sub(edge.last, edge.first), hn::Set(d, 1.0f / kStrips));
    auto sum = hn::Zero(d);
    auto begin = edge.first;
    auto below = LitPart<D>::below(d, pixel_, begin);
    for (int strip = 0; strip < kStrips; ++strip) {
      const auto middle = hn::MulAdd(step, hn::Set(d, 0.5f), begin);
      const auto end = hn::Add(begin, step);
      const auto up_to_end = LitPart<D>::below(d, pixel_, end);
      const auto u = hn::Mul(hn::MulAdd(line.across, middle, line.height), scale);
      sum = hn::MulAdd(hn::Sub(up_to_end, below), LitPart<D>::below(d, pixel_, u), sum);
      begin = end;
      below = up_to_end;
    }
    return sum;
  }

  // The range of u at a v.
  LitPart<D> along_at(D d, VecOf<D> v) const {
    LitPart<D> part(d, pixel_);
    for (std::size_t k = 2; k < count_; ++k) {
      part.clip(d, hn::MulAdd(lines_[k].across, v, lines_[k].height), lines_[k].along);
    }
    return part;
  }

  // The v that a share of the polygon lies below: in strips, k exactly, the width at the middle.
  VecOf<D> place_across(D d, VecOf<D> below_it) const {
    const auto zero = hn::Zero(d);
    const auto step = hn::Mul(hn::Sub(across_.last, across_.first), hn::Set(d, 1.0f / kStrips));
    std::array<VecOf<D>, kStrips> masses;
    auto all = zero;
    for (int strip = 0; strip < kStrips; ++strip) {
      const auto begin = hn::MulAdd(step, hn::Set(d, static_cast<float>(strip)), across_.first);
      const auto in_v = hn::Sub(LitPart<D>::below(d, pixel_, hn::Add(begin, step)),
                                LitPart<D>::below(d, pixel_, begin));
      const auto middle = hn::MulAdd(step, hn::Set(d, 0.5f), begin);
      const auto in_u = along_at(d, middle).share(d, pixel_);
      masses[static_cast<std::size_t>(strip)] = hn::Mul(in_v, hn::Max(in_u, zero));
      all = hn::Add(all, masses[static_cast<std::size_t>(strip)]);
    }
    const auto wanted = hn::Mul(below_it, all);
    auto before = zero, part = zero, number = zero;
    auto so_far = zero;
    for (int strip = 0; strip < kStrips; ++strip) {
      const auto mass = masses[static_cast<std::size_t>(strip)];
      const auto is_here = hn::And(hn::Le(so_far, wanted), hn::Gt(mass, zero));
      number = hn::IfThenElse(is_here, hn::Set(d, static_cast<float>(strip)), number);
      before = hn::IfThenElse(is_here, so_far, before);
      part = hn::IfThenElse(is_here, mass, part);
      so_far = hn::Add(so_far, mass);
    }
    const auto least = hn::Set(d, LitPart<D>::kLeastRise);
    const auto share = hn::Div(hn::Sub(wanted, before), hn::Max(part, least));
    LitPart<D> strip(d, pixel_);
    strip.first = hn::MulAdd(step, number, across_.first);
    strip.last = hn::Add(strip.first, step);
    const auto low = LitPart<D>::below(d, pixel_, strip.first);
    const auto inside = hn::Min(hn::Max(share, zero), hn::Set(d, 1.0f));
    const auto place =
        LitPart<D>::at_share(d, pixel_, hn::MulAdd(inside, strip.share(d, pixel_), low));
    return across_.inside(d, place);
  }

  const PixelOnSurface& pixel_;
  std::array<PixelLine<D>, kMostLines> lines_;
  std::size_t count_ = 0;
  LitPart<D> across_;
  VecOf<D> share_;
};

}  // namespace HWY_NAMESPACE
}  // namespace abbe
HWY_AFTER_NAMESPACE();

#endif  // ABBE_CAUSTICS_FLAT_LIGHT_LIT_PIXEL_INL_H_
