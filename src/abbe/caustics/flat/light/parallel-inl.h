/// Light that reaches places on chains of parallel light (caustics/flat/parallel_chain.h), for all
/// lanes at once. Highway code, compiled once per instruction set.

#if defined(ABBE_CAUSTICS_FLAT_LIGHT_PARALLEL_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef ABBE_CAUSTICS_FLAT_LIGHT_PARALLEL_INL_H_
#undef ABBE_CAUSTICS_FLAT_LIGHT_PARALLEL_INL_H_
#else
#define ABBE_CAUSTICS_FLAT_LIGHT_PARALLEL_INL_H_
#endif

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>

#include "abbe/caustics/flat/flat_caustics.h"
#include "abbe/caustics/flat/light/chain_places.h"
#include "abbe/caustics/flat/light/lit_pixel-inl.h"
#include "abbe/math/segment-inl.h"
#include "abbe/optics/absorption-inl.h"
#include "abbe/optics/fresnel-inl.h"
#include "abbe/world/world.h"

HWY_BEFORE_NAMESPACE();
namespace abbe {
namespace HWY_NAMESPACE {

/// A chain's light at a batch of places, lane by lane.
template <class D>
class ParallelChainLight {
 public:
  ParallelChainLight(const TabulatedScene& tables, const FlatCaustics& caustics,
                     const ParallelChain& chain, int set)
      : tables_(tables),
        chain_(chain),
        light_(caustics.source_of(chain)),
        rows_(caustics.parallel.of(chain, set)),
        set_(set) {}

  /// Fills directions to the light, distances to the last facet, and the irradiance across them, 0
  /// in lanes that are not lit. Returns whether any lane is. The light is the mean over a pixel
  /// about each place. The geometry is that of a place of what is lit of the pixel, as likely as
  /// it is the kernel's, so that what stands in the way takes of the light the share that it
  /// stands before. Places may be off by `rounding_m`.
  bool run(const LaneArray3& positions, float rounding_m, const PixelOnSurface& pixel,
           LightGeometry& geometry, ChainPlaces& met) {
    const D d;
    rounding_m_ = rounding_m;
    bool any = false;
    is_shifted_ = false;
    axis_ = pixel.is_point() ? 0 : axis_of(positions, pixel);
    for (int i = 0; i < tables_.lanes.lane_stride(); i += static_cast<int>(hn::Lanes(d))) {
      any |= light_lanes(positions, pixel, i, geometry, met);
    }
    return any;
  }

  /// Whether the geometry of any lane is that of another place of the pixel. Domain: after run().
  bool is_shifted() const { return is_shifted_; }
  /// How far off in the pixel's plane that is. Domain: only where is_shifted().
  Vec3f shift_m(int lane) const { return shift_m_.get(lane); }

  /// The part of every ray that the chain lights. Returns whether it is anything in any
  /// lane of positive weight.
  bool segments(const LaneRays& rays, LaneSegments& lit) const {
    const D d;
    const auto zero = hn::Zero(d);
    bool any = false;
    for (int i = 0; i < tables_.lanes.lane_stride(); i += static_cast<int>(hn::Lanes(d))) {
      const auto origin = Combine3(d, hn::Set(d, 1.0f), Load3(d, rays.origin, i), hn::Set(d, -1.0f),
                                   Set3(d, chain_.origin));
      const auto direction = Load3(d, rays.direction, i);
      auto begin = zero;
      auto end = hn::IfThenElseZero(hn::Gt(hn::LoadU(d, rows_.weight + i), zero),
                                    hn::Load(d, rays.end_m.v + i));
      for (std::size_t s = 0; s < chain_.side_count && !hn::AllFalse(d, hn::Lt(begin, end)); ++s) {
        const Side side = side_at(s, i);
        ClipSegment(d, hn::Add(Dot3(d, side.normal, origin), side.offset),
                    Dot3(d, side.normal, direction), begin, end);
      }
      any |= !hn::AllFalse(d, hn::Lt(begin, end));
      hn::Store(begin, d, lit.begin_m.v + i);
      hn::Store(hn::Max(begin, end), d, lit.end_m.v + i);
    }
    return any;
  }

 private:
  using V = VecOf<D>;
  using V3 = Vec3Of<D>;
  using M = hn::Mask<D>;

  static constexpr std::size_t kLastBit = 63;  ///< Stands for all sides from there on.

  using Line = PixelLine<D>;

  struct Side {
    V3 normal;
    V offset;
  };

  V3 load(const float* row, int i) const {
    const D d;
    return {hn::LoadU(d, row + i), hn::LoadU(d, row + rows_.stride + i),
            hn::LoadU(d, row + 2 * rows_.stride + i)};
  }
  Side side_at(std::size_t number, int i) const {
    const float* row = rows_.side(number);
    return {load(row, i), hn::LoadU(D(), row + 3 * rows_.stride + i)};
  }

  bool light_lanes(const LaneArray3& positions, const PixelOnSurface& pixel, int i,
                   LightGeometry& geometry, ChainPlaces& met) {
    const D d;
    const auto zero = hn::Zero(d);
    const auto one = hn::Set(d, 1.0f);
    V3 place = Combine3(d, one, Load3(d, positions, i), one, Set3(d, -chain_.origin));
    const V weight = hn::LoadU(d, rows_.weight + i);
    V irradiance = hn::Mul(weight, hn::LoadU(d, tables_.row(light_.row, set_) + i));
    const M lit = clip_to_lit(hn::Gt(weight, zero), pixel, i, place, irradiance);
    if (hn::AllFalse(d, lit)) {
      hn::Store(zero, d, geometry.irradiance.v + i);
      Store3(d, Set3(d, Vec3f(0.0f, 0.0f, 1.0f)), geometry.direction, i);
      hn::Store(zero, d, geometry.distance_m.v + i);
      for (std::size_t s = 0; s < chain_.steps.size(); ++s) {
        Store3(d, Set3(d, Vec3f(0.0f)), met.places[s], i);
      }
      return false;
    }
    irradiance = follow_back(place, i, irradiance, geometry, met);
    hn::Store(hn::IfThenElseZero(lit, irradiance), d, geometry.irradiance.v + i);
    return true;
  }

  // The lanes of `lit` whose pixel the light falls on, the light of the whole pixel, and a lit
  // place of it.
  M clip_to_lit(M lit, const PixelOnSurface& pixel, int i, V3& place, V& irradiance) {
    const D d;
    std::uint64_t cuts = 0;
    Vec2f unused(0.0f);
    lit = find_cuts(lit, pixel, i, place, cuts, unused);
    const bool is_cut = cuts != 0 && !hn::AllFalse(d, lit);
    if (is_cut) {
      const V3 from = place;
      lit = clip_area(lit, cuts, pixel, axis_, i, place, irradiance);
      Store3(d, Combine3(d, hn::Set(d, 1.0f), place, hn::Set(d, -1.0f), from), shift_m_, i);
    } else {
      Store3(d, Set3(d, Vec3f(0.0f)), shift_m_, i);
    }
    is_shifted_ |= is_cut;
    return lit;
  }

  // The lanes that some of the pixel is lit in as far as single sides tell, the sides that cut it,
  // and how squarely they cut along each of its own.
  M find_cuts(M lit, const PixelOnSurface& pixel, int i, const V3& place, std::uint64_t& cuts,
              Vec2f& cut_by) const {
    const D d;
    // Most sides leave all of a pixel or nothing.
    for (std::size_t s = 0; s < chain_.side_count && !hn::AllFalse(d, lit); ++s) {
      const Side side = side_at(s, i);
      if (pixel.is_point()) {
        lit = hn::And(lit, hn::Ge(height_of(side, s, place), hn::Zero(d)));
        continue;
      }
      const Line line = line_of(side, s, pixel, 0, place);
      const V rise_x = hn::Abs(line.along), rise_y = hn::Abs(line.across);
      const V most = hn::Mul(hn::Set(d, pixel.radius_px), hn::Add(rise_x, rise_y));
      lit = hn::And(lit, hn::Ge(line.height, hn::Neg(most)));
      const M is_cut = hn::And(lit, hn::Lt(line.height, most));
      if (hn::AllFalse(d, is_cut)) continue;
      cuts |= std::uint64_t{1} << std::min<std::size_t>(s, kLastBit);
      cut_by.x += hn::GetLane(hn::SumOfLanes(d, hn::IfThenElseZero(is_cut, rise_x)));
      cut_by.y += hn::GetLane(hn::SumOfLanes(d, hn::IfThenElseZero(is_cut, rise_y)));
    }
    return lit;
  }

  // Along which side of the pixel its sides are cut more squarely: for all lanes, so that it is the
  // same however many a vector has.
  int axis_of(const LaneArray3& positions, const PixelOnSurface& pixel) const {
    const D d;
    Vec2f cut_by(0.0f);
    for (int i = 0; i < tables_.lanes.lane_stride(); i += static_cast<int>(hn::Lanes(d))) {
      const V3 place = moved(Load3(d, positions, i), hn::Set(d, 1.0f), -chain_.origin);
      std::uint64_t cuts = 0;
      find_cuts(hn::Gt(hn::LoadU(d, rows_.weight + i), hn::Zero(d)), pixel, i, place, cuts, cut_by);
    }
    return cut_by.x >= cut_by.y ? 0 : 1;
  }

  // The same for the sides of `cuts`, of which u runs along the side of the pixel of that number.
  M clip_area(M lit, std::uint64_t cuts, const PixelOnSurface& pixel, int axis, int i, V3& place,
              V& irradiance) const {
    const D d;
    LitArea<D> area(d, pixel);
    for (std::size_t s = 0; s < chain_.side_count; ++s) {
      if ((cuts >> std::min<std::size_t>(s, kLastBit) & 1) == 0) continue;
      area.add(line_of(side_at(s, i), s, pixel, axis, place));
    }
    lit = hn::And(lit, area.integrate(d));
    if (hn::AllFalse(d, lit)) return lit;
    irradiance = hn::Mul(irradiance, area.share());
    const V along_px = hn::Set(d, pixel.offset_px[axis]);
    const V across_px = hn::Set(d, pixel.offset_px[1 - axis]);
    V at_u = along_px, at_v = across_px;
    area.move_in(d, at_u, at_v);
    const V u = hn::Sub(at_u, along_px), v = hn::Sub(at_v, across_px);
    const V nearness =
        hn::MulAdd(u, hn::Set(d, pixel.closer[axis]),
                   hn::MulAdd(v, hn::Set(d, pixel.closer[1 - axis]), hn::Set(d, 1.0f)));
    place = moved(place, hn::Div(u, nearness), pixel.sides[static_cast<std::size_t>(axis)]);
    place = moved(place, hn::Div(v, nearness), pixel.sides[static_cast<std::size_t>(1 - axis)]);
    return lit;
  }

  static HWY_INLINE V3 moved(const V3& place, V by, const Vec3f& side) {
    const D d;
    return Combine3(d, hn::Set(d, 1.0f), place, by, Set3(d, side));
  }

  // A side as a line in the pixel, u along its side of that number: above it, where
  // height + along·u + across·v ≥ 0, from the pixel's middle.
  HWY_INLINE Line line_of(const Side& side, std::size_t number, const PixelOnSurface& pixel,
                          int axis, const V3& place) const {
    const D d;
    const V height = height_of(side, number, place);
    const auto rise = [&](int k) HWY_ATTR {
      const V3 moved_px = Set3(d, pixel.sides[static_cast<std::size_t>(k)]);
      return hn::MulAdd(height, hn::Set(d, pixel.closer[k]), Dot3(d, side.normal, moved_px));
    };
    const V along = rise(axis), across = rise(1 - axis);
    const V to_middle = hn::MulAdd(along, hn::Set(d, pixel.offset_px[axis]),
                                   hn::Mul(across, hn::Set(d, pixel.offset_px[1 - axis])));
    return {hn::Sub(height, to_middle), along, across};
  }

  // Of a place above a side, up to which the light comes.
  HWY_INLINE V height_of(const Side& side, std::size_t number, const V3& place) const {
    const D d;
    const V height = hn::Add(Dot3(d, side.normal, place), side.offset);
    // What the last facet stands on is lit.
    return number == 0 ? hn::Add(height, hn::Set(d, rounding_m_)) : height;
  }

  // Goes back from a place over the facets; returns what is left of its light after what absorbs
  // on that path and is not asked for by itself.
  V follow_back(V3 place, int i, V irradiance, LightGeometry& geometry, ChainPlaces& met) const {
    const D d;
    const auto zero = hn::Zero(d);
    V fog_m = zero;
    const std::size_t step_count = chain_.steps.size();
    for (std::size_t s = step_count; s-- > 0;) {
      const ChainStep& step = chain_.steps[s];
      const V3 direction = load(rows_.direction(s), i);
      const V3 normal = Set3(d, step.normal);
      const V slope = Dot3(d, normal, direction);
      V length = zero;
      // The second time what a long way has rounded is undone.
      for (int time = 0; time < 2; ++time) {
        const V height = hn::Sub(Dot3(d, normal, place), hn::Set(d, step.distance_m));
        const V back = hn::Max(hn::Div(height, slope), hn::Neg(length));
        place = Combine3(d, hn::Set(d, 1.0f), place, hn::Neg(back), direction);
        length = hn::Add(length, back);
      }
      Store3(d, place, met.places[s], i);
      if (s + 1 == step_count) {
        const V3 to_light{hn::Neg(direction.x), hn::Neg(direction.y), hn::Neg(direction.z)};
        Store3(d, to_light, geometry.direction, i);
        hn::Store(length, d, geometry.distance_m.v + i);
      }
      const auto medium = step.goes_on_in();
      if (!medium) {
        fog_m = hn::Add(fog_m, length);
        continue;
      }
      // Where something may stand on a segment inside, the query for that absorbs, too.
      const bool is_asked = s + 1 == step_count || chain_.steps[s + 1].is_checked;
      const SurfaceMaterial& material = tables_.materials[*medium];
      if (is_asked || !material.absorption_per_m) continue;
      const V per_m = hn::LoadU(d, tables_.row(*material.absorption_per_m, set_) + i);
      irradiance = Attenuated(d, irradiance, per_m, length);
    }
    // The illuminance of a sun is what it is at the scene, however long its way: no fog weakens it.
    if (!tables_.fog || !light_.has_distance()) return irradiance;
    const Vec3f from_light = chain_.origin - light_.position;
    const V along = hn::Add(Dot3(d, place, Set3(d, light_.direction)),
                            hn::Set(d, glm::dot(from_light, light_.direction)));
    fog_m = hn::Add(fog_m, hn::Max(along, zero));
    return Attenuated(d, irradiance, hn::Set(d, tables_.fog->extinction_per_m), fog_m);
  }

  const TabulatedScene& tables_;
  const ParallelChain& chain_;
  const WorldLight& light_;
  const ParallelChainRows<const float> rows_;
  const int set_;
  float rounding_m_ = 0.0f;
  int axis_ = 0;
  bool is_shifted_ = false;
  LaneArray3 shift_m_;
};

}  // namespace HWY_NAMESPACE
}  // namespace abbe
HWY_AFTER_NAMESPACE();

#endif  // ABBE_CAUSTICS_FLAT_LIGHT_PARALLEL_INL_H_
