/// Light of point and spot lamps on chains of flat faces (caustics/flat/point_chain.h), for all
/// lanes at once. Highway code, compiled once per instruction set.
///
/// The path of the middle wavelength is found first, in double precision (solver.h). Every
/// lane then shoots from the lamp at its own guess of the first crossing and corrects it by what it
/// misses the place, with the derivatives of the ray (Igehy, Tracing Ray Differentials, SIGGRAPH
/// 1999). The same derivatives give the irradiance: the solid angle that the lamp sends into an
/// area of the first face, over the area across the beam that it becomes at the place.
///
/// Contract. A lane stops when it has converged, whatever its neighbours do: a result has the same
/// bits on every instruction set level.

#if defined(ABBE_CAUSTICS_FLAT_LIGHT_POINT_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef ABBE_CAUSTICS_FLAT_LIGHT_POINT_INL_H_
#undef ABBE_CAUSTICS_FLAT_LIGHT_POINT_INL_H_
#else
#define ABBE_CAUSTICS_FLAT_LIGHT_POINT_INL_H_
#endif

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <span>

#include "abbe/caustics/flat/flat_caustics.h"
#include "abbe/caustics/flat/light/chain_places.h"
#include "abbe/caustics/flat/light/facet_reflectance-inl.h"
#include "abbe/caustics/flat/light/on_plane-inl.h"
#include "abbe/caustics/flat/light/point_bounds-inl.h"
#include "abbe/caustics/flat/light/point_shot-inl.h"
#include "abbe/caustics/flat/light/solver.h"
#include "abbe/optics/absorption-inl.h"
#include "abbe/world/light/lights-inl.h"
#include "abbe/world/world.h"

HWY_BEFORE_NAMESPACE();
namespace abbe {
namespace HWY_NAMESPACE {

/// A chain's light at a batch of places, lane by lane.
template <class D>
class PointChainLight {
 public:
  PointChainLight(const TabulatedScene& tables, const FlatCaustics& caustics,
                  const PointChain& chain, int set)
      : tables_(tables),
        chains_(caustics.point),
        chain_(chain),
        light_(caustics.source_of(chain)),
        set_(set),
        count_(chain.crossings.size()) {}

  /// Whether, after run(), all lanes go the same way.
  bool is_one_path() const { return is_one_place_ && !(widest_ > 0.0); }

  /// After run() that found nothing: what the path to the middle of the places misses, if known.
  const Miss& miss() const { return miss_; }
  const Vec3f& middle() const { return center_; }

  /// As ParallelChainLight does for parallel light. The places of `among` count; they are one place
  /// where `is_one_place`.
  bool run(const LaneArray3& positions, float rounding_m, const LaneMask& among, bool is_one_place,
           LightGeometry& geometry, ChainPlaces& met) {
    miss_ = {};
    const LaneMask lanes = among & chain_.lanes;
    if (!lanes.any()) return false;
    rounding_m_ = rounding_m;
    is_one_place_ = is_one_place;
    if (!start(positions, lanes, is_one_place)) return false;
    const D d;
    const int stride = tables_.lanes.lane_stride();
    bool any = false;
    for (int i = 0; i < stride; i += static_cast<int>(hn::Lanes(d))) {
      const auto lit = light_lanes(positions, LanesFrom(d, lanes, i), i, geometry, met);
      any |= !hn::AllFalse(d, lit);
    }
    return any;
  }

 private:
  using V = VecOf<D>;
  using V3 = Vec3Of<D>;

  // What a path may miss a place by, and be moved off its last face by, as a share of its length.
  static constexpr float kOffOfPath = 4e-6f;

  // Whether a miss at the wavelengths of one set is one at those of the others: between many they
  // lie within what is allowed for; of a few, each set has its own.
  bool holds_for_all_sets() const {
    return tables_.lanes.set_count() == 1 || tables_.lanes.lane_count() >= 8;
  }

  double index(std::size_t segment, int lane) const {
    const auto& medium = chain_.media[segment];
    if (!medium) return 1.0;
    return static_cast<double>(tables_.row(tables_.materials[*medium].index, set_)[lane]);
  }

  Vec3d unfolded(const Vec3f& place) const {
    return chain_.fold * (Vec3d(place) - Vec3d(chain_.origin)) + chain_.fold_shift;
  }

  // The path of the middle wavelength to the middle of the places; false where it and all others
  // near it miss a face. Where it is totally reflected, those of the least and the greatest index
  // may yet arrive.
  bool start(const LaneArray3& positions, const LaneMask& lanes, bool is_one_place) {
    const int lane_count = tables_.lanes.lane_count();
    center_ = positions.get(lanes.front());
    float radius_m = 0.0f;
    if (!is_one_place) {
      Vec3f sum(0.0f);
      for (int lane = 0; lane < lane_count; ++lane) {
        if (lanes.test(lane)) sum += positions.get(lane);
      }
      center_ = sum / static_cast<float>(lanes.count());
      radius_m = LargestDistance(D(), tables_.lanes.lane_stride(), positions, lanes, center_);
    }
    middle_ = off_last_face(chain_, unfolded(center_));
    if (count_ == 0) return true;
    std::array<double, kMaxRefractions + 1> n{};
    std::array<double, kMaxRefractions + 1> change{};
    widest_ = 0.0;
    for (std::size_t j = 0; j <= count_; ++j) {
      n[j] = 1.0;
      if (!chain_.media[j]) continue;
      const Vec2d range = chains_.index_range(*chain_.media[j], set_);
      n[j] = 0.5 * (range.x + range.y);
      change[j] = range.y - range.x;
      if (change[j] > widest_) {
        widest_ = change[j];
        widest_segment_ = j;
        widest_middle_ = n[j];
      }
    }
    const std::span<const double> indices(n.data(), count_ + 1);
    // Far from the outline of a face, no other lane will be inside.
    slopes_ = CrossingSlopes{};
    bool passes_by = false;
    const auto certainly_misses = [&](const Crossings& at, double off_m) {
      if (may_cross(chains_, chain_, at, off_m)) return false;
      slopes_ = crossing_slopes(chain_, indices, {change.data(), count_ + 1}, middle_, at);
      passes_by = !may_cross(chains_, chain_, at, slopes_, static_cast<double>(radius_m), off_m);
      if (passes_by && holds_for_all_sets()) {
        miss_ = clearest_miss(chains_, chain_, middle_, at, slopes_, off_m);
      }
      return passes_by;
    };
    has_middle_ = solve_crossings(chain_, indices, middle_, crossings_, certainly_misses);
    if (passes_by) return false;
    if (!has_middle_) return widest_ > 0.0 && any_end_arrives(n, change);
    if (certainly_misses(crossings_, 0.0)) return false;
    if (widest_ > 0.0 || radius_m > 0.0f) {
      slopes_ = crossing_slopes(chain_, indices, {change.data(), count_ + 1}, middle_, crossings_);
    }
    return true;
  }

  bool any_end_arrives(const std::array<double, kMaxRefractions + 1>& n,
                       const std::array<double, kMaxRefractions + 1>& change) const {
    for (const double towards : {-0.5, 0.5}) {
      std::array<double, kMaxRefractions + 1> end{};
      for (std::size_t j = 0; j <= count_; ++j) end[j] = n[j] + towards * change[j];
      Crossings crossings{};
      if (solve_crossings(chain_, {end.data(), count_ + 1}, middle_, crossings)) return true;
    }
    return false;
  }

  V3 set3(const Vec3d& v) const { return Set3(D(), Vec3f(v)); }

  void shoot(V u, V v, const V3& place, int i, Shot<D>& shot) const {
    ShootOverChain(D(), {tables_, chain_, set_, i}, u, v, place, shot);
  }

  V total(const Shot<D>& shot) const {
    V sum = shot.lengths_m[0];
    for (std::size_t j = 1; j <= count_; ++j) sum = hn::Add(sum, shot.lengths_m[j]);
    return sum;
  }

  // The straight path of a chain that only reflects.
  void go_straight(const V3& place, Shot<D>& shot) const {
    const D d;
    const auto one = hn::Set(d, 1.0f);
    const V3 offset = Combine3(d, one, place, hn::Neg(one), set3(chain_.lamp));
    const V length = hn::Sqrt(Dot3(d, offset, offset));
    const V inverse = hn::Div(one, length);
    shot.directions[0] = {hn::Mul(offset.x, inverse), hn::Mul(offset.y, inverse),
                          hn::Mul(offset.z, inverse)};
    shot.lengths_m[0] = length;
    shot.jacobian = hn::Mul(inverse, inverse);
    shot.is_valid = hn::Gt(length, hn::Zero(d));
  }

  V3 unfolded(const V3& position) const {
    const D d;
    const V3 relative =
        Combine3(d, hn::Set(d, 1.0f), position, hn::Set(d, -1.0f), Set3(d, chain_.origin));
    return moved(chain_.fold, chain_.fold_shift, relative);
  }

  V3 moved(const Mat3d& linear, const Vec3d& shift, const V3& x) const {
    const D d;
    const Mat3d rows = glm::transpose(linear);
    const auto one = hn::Set(d, 1.0f);
    const V3 turned{Dot3(d, set3(rows[0]), x), Dot3(d, set3(rows[1]), x),
                    Dot3(d, set3(rows[2]), x)};
    return Combine3(d, one, turned, one, set3(shift));
  }

  // Solves each lane's path; returns the lanes that have one.
  hn::Mask<D> solve(const V3& place, hn::Mask<D> active, int i, Shot<D>& shot) const {
    const D d;
    if (count_ == 0) {
      go_straight(place, shot);
      return hn::And(active, shot.is_valid);
    }
    if (!has_middle_ || tables_.lanes.are_followed_apart()) {
      V u = hn::Zero(d);
      V v = u;
      const auto solved = solve_one_by_one(place, active, i, u, v);
      shoot(u, v, place, i, shot);
      return hn::And(solved, shot.is_valid);
    }
    // First order in the index and in the place.
    V share = hn::Zero(d);
    if (widest_ > 0.0) {
      const auto& medium = tables_.materials[*chain_.media[widest_segment_]];
      share = hn::Mul(hn::Sub(hn::LoadU(d, tables_.row(medium.index, set_) + i),
                              hn::Set(d, static_cast<float>(widest_middle_))),
                      hn::Set(d, static_cast<float>(1.0 / widest_)));
    }
    const V3 off = Combine3(d, hn::Set(d, 1.0f), place, hn::Set(d, -1.0f), set3(middle_));
    const auto guess = [&](auto part) {
      const Vec3d by_place(part(slopes_.by_place[0][0]), part(slopes_.by_place[1][0]),
                           part(slopes_.by_place[2][0]));
      const auto moved_by =
          hn::Add(hn::Mul(hn::Set(d, static_cast<float>(part(slopes_.by_index[0]))), share),
                  Dot3(d, set3(by_place), off));
      return hn::Add(hn::Set(d, static_cast<float>(part(crossings_[0] - chain_.start))), moved_by);
    };
    V u = guess([](const Vec2d& at) { return at.x; });
    V v = guess([](const Vec2d& at) { return at.y; });
    constexpr int kMaxShots = 6;
    constexpr int kLastCorrection = 3;
    constexpr float kNear = 1e-5f;
    constexpr float kExact = 5e-7f;
    hn::Mask<D> waiting = active;
    for (int n = 0; n < kMaxShots; ++n) {
      shoot(u, v, place, i, shot);
      const auto misses_by = [&](float path_share) {
        const V tolerance = hn::Mul(total(shot), hn::Set(d, path_share));
        const auto hit = hn::And(shot.is_valid, hn::Le(shot.miss2, hn::Mul(tolerance, tolerance)));
        return hn::AndNot(hit, active);
      };
      waiting = misses_by(kNear);
      // Near is what a last step makes exact: where the lanes started from is not seen any more.
      const auto corrected = n < kLastCorrection ? misses_by(kExact) : waiting;
      if (hn::AllFalse(d, corrected)) return active;
      if (n + 1 == kMaxShots) break;
      const auto goes_on = hn::And(corrected, shot.is_valid);
      u = hn::IfThenElse(goes_on, hn::Add(u, shot.miss_u), u);
      v = hn::IfThenElse(goes_on, hn::Add(v, shot.miss_v), v);
    }
    const auto solved = solve_one_by_one(place, waiting, i, u, v);
    shoot(u, v, place, i, shot);
    return hn::And(hn::Or(hn::AndNot(waiting, active), solved), shot.is_valid);
  }

  // For lanes that shooting has not brought there: the search that cannot miss.
  hn::Mask<D> solve_one_by_one(const V3& place, hn::Mask<D> waiting, int i, V& u, V& v) const {
    const D d;
    LaneMask lanes;
    SetLanesFrom(d, waiting, 0, lanes);
    alignas(64) float us[16], vs[16], xs[16], ys[16], zs[16];
    hn::Store(u, d, us);
    hn::Store(v, d, vs);
    hn::Store(place.x, d, xs);
    hn::Store(place.y, d, ys);
    hn::Store(place.z, d, zs);
    LaneMask solved;
    for (int k = 0; k < static_cast<int>(hn::Lanes(d)); ++k) {
      const int lane = std::min(i + k, tables_.lanes.lane_count() - 1);
      if (!lanes.test(k)) continue;
      std::array<double, kMaxRefractions + 1> n{};
      for (std::size_t j = 0; j <= count_; ++j) n[j] = index(j, lane);
      Crossings crossings{};
      const Vec3d goal = off_last_face(chain_, Vec3d(xs[k], ys[k], zs[k]));
      const auto gives_up = [&](const Crossings& at, double off_m) {
        return !may_cross(chains_, chain_, at, off_m);
      };
      if (!solve_crossings(chain_, {n.data(), count_ + 1}, goal, crossings, gives_up)) continue;
      if (!goes_ahead(chain_, crossings)) continue;
      us[k] = static_cast<float>(crossings[0].x - chain_.start.x);
      vs[k] = static_cast<float>(crossings[0].y - chain_.start.y);
      solved.set(k);
    }
    u = hn::Load(d, us);
    v = hn::Load(d, vs);
    return LanesFrom(d, solved, 0);
  }

  // Inside the outline of a face; edges that two pieces share belong to both.
  hn::Mask<D> is_inside(const UnfoldedFace& face, const V3& place, hn::Mask<D> among) const {
    const D d;
    const V3 off = Combine3(d, hn::Set(d, 1.0f), place, hn::Set(d, -1.0f), set3(face.origin));
    const V u = Dot3(d, off, set3(face.u));
    const V v = Dot3(d, off, set3(face.v));
    auto inside = hn::Lt(u, u);  // None.
    for (const std::vector<Vec3f>& edges : chains_.frames[face.face].pieces) {
      auto here = among;
      for (const Vec3f& edge : edges) {
        const V height =
            hn::Add(hn::Add(hn::Mul(hn::Set(d, edge.x), u), hn::Mul(hn::Set(d, edge.y), v)),
                    hn::Set(d, edge.z));
        here = hn::And(here, hn::Ge(height, hn::Zero(d)));
        if (hn::AllFalse(d, here)) break;
      }
      inside = hn::Or(inside, here);
    }
    return inside;
  }

  V in_fog(V light, V length_m) const {
    const D d;
    if (!tables_.fog) return light;
    return Attenuated(d, light, hn::Set(d, tables_.fog->extinction_per_m),
                      hn::Max(length_m, hn::Zero(d)));
  }

  // What is left of light on the segment that ends at a step. Where something may stand on it, and
  // from the last face on, the query for that absorbs.
  V absorbed(V light, const ChainStep& step, V length_m, int i) const {
    const D d;
    const auto medium = step.comes_from();
    if (!medium) return in_fog(light, length_m);
    const SurfaceMaterial& material = tables_.materials[*medium];
    if (step.is_checked || !material.absorption_per_m) return light;
    const V per_m = hn::LoadU(d, tables_.row(*material.absorption_per_m, set_) + i);
    return Attenuated(d, light, per_m, hn::Max(length_m, hn::Zero(d)));
  }

  // Walks over the faces of the chain: places, outlines, and what each leaves of the light.
  hn::Mask<D> walk(const Shot<D>& shot, hn::Mask<D> lit, int i, V& power, V3& last_place,
                   ChainPlaces& met) const {
    const D d;
    const auto zero = hn::Zero(d);
    const auto one = hn::Set(d, 1.0f);
    std::size_t segment = 0;
    V3 from = set3(chain_.lamp);
    V gone = zero;  // On this segment.
    for (std::size_t s = 0; s < chain_.steps.size(); ++s) {
      const ChainStep& step = chain_.steps[s];
      const UnfoldedFace& face = chain_.faces[s];
      const V3& direction = shot.directions[segment];
      V3 place = from;
      V cosine = zero;
      if (segment < count_ && chain_.crossings[segment] == s) {
        place = shot.places[segment];
        cosine = shot.cos_in[segment];
        lit = hn::And(lit, hn::Ge(shot.lengths_m[segment], gone));
        power = absorbed(power, step, hn::Sub(shot.lengths_m[segment], gone), i);
        ++segment;
        from = place;
        gone = zero;
      } else {
        const V3 normal = set3(face.normal);
        const V slope = Dot3(d, normal, direction);
        const V3 to_plane = Combine3(d, one, set3(face.origin), hn::Neg(one), from);
        const V t = hn::Div(Dot3(d, normal, to_plane), slope);
        lit = hn::And(lit, hn::Ge(t, gone));
        if (step.event == ChainEvent::ReflectInside) lit = hn::And(lit, hn::Gt(slope, zero));
        power = absorbed(power, step, hn::Sub(t, gone), i);
        gone = t;
        place = Combine3(d, one, from, t, direction);
        cosine = hn::Min(hn::Abs(slope), one);
      }
      lit = hn::And(lit, is_inside(face, place, lit));
      if (hn::AllFalse(d, lit)) return lit;
      const SurfaceMaterial& material = tables_.materials[step.material];
      const V reflectance = FacetReflectance(d, tables_, step, set_, i, cosine);
      const V tint = hn::LoadU(d, tables_.row(material.base_color, set_) + i);
      power =
          hn::Mul(power, step.refracts() ? hn::Mul(hn::Sub(one, reflectance), tint) : reflectance);
      Store3(d, OnPlane(d, step, moved(face.to_world, face.shift, place)), met.places[s], i);
      last_place = place;
    }
    return lit;
  }

  hn::Mask<D> light_lanes(const LaneArray3& positions, hn::Mask<D> active, int i,
                          LightGeometry& geometry, ChainPlaces& met) const {
    const D d;
    const auto zero = hn::Zero(d);
    const auto one = hn::Set(d, 1.0f);
    Shot<D> shot;
    V power = one;
    const V3 position = Load3(d, positions, i);
    const V3 place = unfolded(position);
    V3 last_place = place;
    auto lit = active;
    if (!hn::AllFalse(d, lit)) lit = solve(place, lit, i, shot);
    if (!hn::AllFalse(d, lit)) lit = walk(shot, lit, i, power, last_place, met);
    if (hn::AllFalse(d, lit)) {
      hn::Store(zero, d, geometry.irradiance.v + i);
      Store3(d, Set3(d, Vec3f(0.0f, 0.0f, 1.0f)), geometry.direction, i);
      hn::Store(zero, d, geometry.distance_m.v + i);
      for (std::size_t s = 0; s < chain_.steps.size(); ++s) {
        Store3(d, Set3(d, Vec3f(0.0f)), met.places[s], i);
      }
      return lit;
    }
    const V path_m = total(shot);
    // To the face that was met, not along the ray, which may miss the place by the tolerance. From
    // a place that touches the face the ray tells better.
    const V3 last_offset = Combine3(d, one, place, hn::Neg(one), last_place);
    const V3& last = shot.directions[count_];
    const V last_m = hn::Sqrt(Dot3(d, last_offset, last_offset));
    const V off_m = hn::Add(hn::Set(d, 16.0f * (chain_.slack_m + rounding_m_)),
                            hn::Mul(hn::Set(d, kOffOfPath), path_m));
    const auto touches = hn::Lt(last_m, off_m);
    lit = hn::And(lit, hn::Or(touches, hn::Gt(Dot3(d, last_offset, last), zero)));
    const V over = hn::Div(one, last_m);
    const V3 straight{hn::Mul(last_offset.x, over), hn::Mul(last_offset.y, over),
                      hn::Mul(last_offset.z, over)};
    V irradiance =
        hn::Mul(hn::LoadU(d, tables_.row(light_.row, set_) + i), hn::Mul(power, shot.jacobian));
    const V cosine = Dot3(d, shot.directions[0], Set3(d, light_.direction));
    irradiance = hn::Mul(irradiance, WindowFromMiddle(d, light_, path_m, cosine));
    if (!chain_.media[count_]) irradiance = in_fog(irradiance, last_m);
    hn::Store(hn::IfThenElseZero(lit, irradiance), d, geometry.irradiance.v + i);
    const V3 arrives =
        moved(glm::transpose(chain_.fold), Vec3d(0.0), Select3(d, touches, last, straight));
    Store3(d, V3{hn::Neg(arrives.x), hn::Neg(arrives.y), hn::Neg(arrives.z)}, geometry.direction,
           i);
    hn::Store(hn::IfThenElseZero(lit, last_m), d, geometry.distance_m.v + i);
    return lit;
  }

  const TabulatedScene& tables_;
  const PointChains& chains_;
  const PointChain& chain_;
  const WorldLight& light_;
  const int set_;
  const std::size_t count_;
  float rounding_m_ = 0.0f;
  bool is_one_place_ = false;
  Vec3f center_{0.0f};  ///< Of the places; `middle_` is it in the unfolded space.
  Miss miss_;
  Vec3d middle_{0.0};
  bool has_middle_ = false;
  Crossings crossings_{};
  CrossingSlopes slopes_;
  double widest_ = 0.0, widest_middle_ = 1.0;
  std::size_t widest_segment_ = 0;
};

}  // namespace HWY_NAMESPACE
}  // namespace abbe
HWY_AFTER_NAMESPACE();

#endif  // ABBE_CAUSTICS_FLAT_LIGHT_POINT_INL_H_
