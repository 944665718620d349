/// Rays from a point lamp over the planes of a chain, with their derivatives, for all lanes at
/// once. Highway code, compiled once per instruction set. Source: Igehy, Tracing Ray Differentials,
/// SIGGRAPH 1999, for the derivatives.

#if defined(ABBE_CAUSTICS_FLAT_LIGHT_POINT_SHOT_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef ABBE_CAUSTICS_FLAT_LIGHT_POINT_SHOT_INL_H_
#undef ABBE_CAUSTICS_FLAT_LIGHT_POINT_SHOT_INL_H_
#else
#define ABBE_CAUSTICS_FLAT_LIGHT_POINT_SHOT_INL_H_
#endif

#include <cstddef>
#include <cstdint>
#include <optional>

#include "abbe/caustics/flat/point_chain.h"
#include "abbe/math/lanes-inl.h"
#include "abbe/optics/snell-inl.h"
#include "abbe/world/world.h"

HWY_BEFORE_NAMESPACE();
namespace abbe {
namespace HWY_NAMESPACE {

/// A ray of every lane over the planes, and how it moves with the first crossing.
template <class D>
struct Shot {
  using V = VecOf<D>;
  using V3 = Vec3Of<D>;

  V3 places[kMaxRefractions];
  V3 directions[kMaxRefractions + 1];
  V lengths_m[kMaxRefractions + 1];
  V cos_in[kMaxRefractions];
  V miss_u, miss_v, miss2;  ///< What to add to the first crossing; square of what it missed by.
  V jacobian;               ///< Solid angle at the lamp over area across the beam.
  hn::Mask<D> is_valid;
};

/// (a × b)·c.
template <class D>
HWY_INLINE VecOf<D> Triple(D d, const Vec3Of<D>& a, const Vec3Of<D>& b, const Vec3Of<D>& c) {
  const Vec3Of<D> cross{hn::Sub(hn::Mul(a.y, b.z), hn::Mul(a.z, b.y)),
                        hn::Sub(hn::Mul(a.z, b.x), hn::Mul(a.x, b.z)),
                        hn::Sub(hn::Mul(a.x, b.y), hn::Mul(a.y, b.x))};
  return Dot3(d, cross, c);
}

/// What lanes shoot over: the planes of a chain, their indices in the lanes from i on.
struct ShotLanes {
  const TabulatedScene& tables;
  const PointChain& chain;
  int set = 0;
  int i = 0;

  template <class D>
  HWY_INLINE VecOf<D> index_of(D d, const std::optional<std::uint32_t>& medium) const {
    if (!medium) return hn::Set(d, 1.0f);
    return hn::LoadU(d, tables.row(tables.materials[*medium].index, set) + i);
  }
};

/// Sends a ray of every lane from the lamp through (u, v) of the first crossed plane, from the
/// chain's start on.
/// Domain: the chain crosses a plane; place is unfolded.
template <class D>
HWY_INLINE void ShootOverChain(D d, const ShotLanes& lanes, VecOf<D> u, VecOf<D> v,
                               const Vec3Of<D>& place, Shot<D>& shot) {
  const PointChain& chain = lanes.chain;
  using V = VecOf<D>;
  using V3 = Vec3Of<D>;
  const std::size_t count = chain.crossings.size();
  const auto set3 = [d](const Vec3d& x) { return Set3(d, Vec3f(x)); };
  const auto one = hn::Set(d, 1.0f);
  const auto zero = hn::Zero(d);
  const UnfoldedFace* face = &chain.faces[chain.crossings[0]];
  V3 a = set3(face->u);
  V3 b = set3(face->v);
  const V3 from_start = Combine3(d, u, a, v, b);
  V3 at = Combine3(d, one, from_start, one, set3(chain.start_place));
  V3 offset = Combine3(d, one, from_start, one, set3(chain.start_place - chain.lamp));
  const V length = hn::Sqrt(Dot3(d, offset, offset));
  const V inverse = hn::Div(one, length);
  V3 direction{hn::Mul(offset.x, inverse), hn::Mul(offset.y, inverse), hn::Mul(offset.z, inverse)};
  const auto turned = [&](const V3& t) {
    return Combine3(d, inverse, t, hn::Neg(hn::Mul(inverse, Dot3(d, direction, t))), direction);
  };
  V3 turn_a = turned(a);
  V3 turn_b = turned(b);
  shot.is_valid = hn::Gt(length, zero);
  shot.lengths_m[0] = length;
  V solid_angle = zero;
  V n = lanes.index_of(d, chain.media[0]);
  for (std::size_t k = 0; k < count; ++k) {
    const ChainStep& step = chain.steps[chain.crossings[k]];
    const float side = step.event == ChainEvent::Enter ? -1.0f : 1.0f;
    const V3 ahead = set3(static_cast<double>(side) * face->normal);
    const V next_n = lanes.index_of(d, chain.media[k + 1]);
    const V eta_it = hn::Div(n, next_n);
    const V cosine = Dot3(d, ahead, direction);
    if (k == 0) solid_angle = hn::Mul(hn::Abs(cosine), hn::Mul(inverse, inverse));
    const V eta_cosine = hn::Mul(eta_it, cosine);
    const V square = hn::Add(hn::Mul(hn::Sub(one, eta_it), hn::Add(one, eta_it)),
                             hn::Mul(eta_cosine, eta_cosine));
    shot.is_valid = hn::And(shot.is_valid, hn::And(hn::Gt(cosine, zero), hn::Gt(square, zero)));
    const V cos_after = hn::Sqrt(hn::Max(square, hn::Set(d, 1e-12f)));
    shot.places[k] = at;
    shot.directions[k] = direction;
    shot.cos_in[k] = hn::Min(cosine, one);
    const V3 facing{hn::Neg(ahead.x), hn::Neg(ahead.y), hn::Neg(ahead.z)};
    direction = RefractedDirection(d, direction, facing, cosine, cos_after, eta_it);
    // d(cosθ′ − eta·cosθ) = eta·(eta·cosθ/cosθ′ − 1)·d(cosθ).
    const V bend = hn::Mul(eta_it, hn::Sub(hn::Div(eta_cosine, cos_after), one));
    turn_a = Combine3(d, eta_it, turn_a, hn::Mul(bend, Dot3(d, turn_a, ahead)), ahead);
    turn_b = Combine3(d, eta_it, turn_b, hn::Mul(bend, Dot3(d, turn_b, ahead)), ahead);
    if (k + 1 == count) break;
    n = next_n;
    face = &chain.faces[chain.crossings[k + 1]];
    const V3 normal = set3(face->normal);
    const V slope = hn::Div(one, Dot3(d, normal, direction));
    const V3 to_plane = Combine3(d, one, set3(face->origin), hn::Neg(one), at);
    const V t = hn::Mul(Dot3(d, normal, to_plane), slope);
    shot.is_valid = hn::And(shot.is_valid, hn::Gt(t, zero));
    shot.lengths_m[k + 1] = t;
    at = Combine3(d, one, at, t, direction);
    const auto carried = [&](const V3& x, const V3& turn) {
      const V3 moved = Combine3(d, one, x, t, turn);
      return Combine3(d, one, moved, hn::Neg(hn::Mul(Dot3(d, normal, moved), slope)), direction);
    };
    a = carried(a, turn_a);
    b = carried(b, turn_b);
  }
  offset = Combine3(d, one, place, hn::Neg(one), at);
  const V along = Dot3(d, offset, direction);
  const V3 miss = Combine3(d, one, offset, hn::Neg(along), direction);
  a = Combine3(d, one, a, along, turn_a);
  b = Combine3(d, one, b, along, turn_b);
  const V area = Triple(d, a, b, direction);
  shot.directions[count] = direction;
  shot.lengths_m[count] = along;
  shot.miss2 = Dot3(d, miss, miss);
  const V over_area = hn::Div(one, area);
  shot.miss_u = hn::Mul(Triple(d, miss, b, direction), over_area);
  shot.miss_v = hn::Mul(Triple(d, a, miss, direction), over_area);
  shot.jacobian = hn::Mul(solid_angle, hn::Abs(over_area));
}

}  // namespace HWY_NAMESPACE
}  // namespace abbe
HWY_AFTER_NAMESPACE();

#endif  // ABBE_CAUSTICS_FLAT_LIGHT_POINT_SHOT_INL_H_
