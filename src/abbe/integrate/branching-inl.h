/// The children of a fan. Highway code, compiled once per instruction set.

#if defined(ABBE_INTEGRATE_BRANCHING_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef ABBE_INTEGRATE_BRANCHING_INL_H_
#undef ABBE_INTEGRATE_BRANCHING_INL_H_
#else
#define ABBE_INTEGRATE_BRANCHING_INL_H_
#endif

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "abbe/integrate/fan.h"
#include "abbe/integrate/integrator.h"
#include "abbe/integrate/light/shared_light-inl.h"
#include "abbe/integrate/lit_surface.h"
#include "abbe/integrate/surface/beam.h"
#include "abbe/integrate/surface/point_lanes-inl.h"
#include "abbe/math/random.h"

HWY_BEFORE_NAMESPACE();
namespace abbe {
namespace HWY_NAMESPACE {

/// Makes the fans that a fan becomes at a surface.
template <class D>
class Branching {
 public:
  Branching(const World& world, const IntegratorSettings& settings,
            std::span<const CameraSample> samples, IntegratorStats& stats)
      : world_(world),
        settings_(settings),
        samples_(samples),
        stats_(stats),
        stride_(world.lanes.lane_stride()) {}

  /// The share of light that a partly covering surface lets by goes straight on; what is left of
  /// the throughput is for the surface.
  /// Shape: coverage in [0, 1] per lane.
  void pass_by(const FanAtSurface& at, const LaneArray& coverage, LaneArray& throughput,
               FanList& next) {
    LaneArray passed;
    bool any = false;
    for (int lane = 0; lane < stride_; ++lane) {
      passed[lane] = throughput[lane] * (1.0f - coverage[lane]);
      throughput[lane] *= coverage[lane];
      any |= passed[lane] > 0.0f;
    }
    if (!any) return;
    const float weight = weight_of(passed, samples_[at.fan.sample].set);
    if (ends_here(at.fan, weight)) return;
    add_child(at,
              {FanOrigin::Passed, 0, at.fan.spread, at.hit.lanes, at.fan.media, at.hit.direction,
               passed, weight, at.fan.shared},
              next);
  }

  /// A child for every lobe of the surface, or below the cutoff one of them for the whole fan.
  void branch(const FanAtSurface& at, const LaneArray& throughput, const SurfaceAnswer& answer,
              FanList& next) {
    const Fan& fan = at.fan;
    const int set = samples_[fan.sample].set;
    std::array<LaneArray, kMaxLobes> arrived;
    std::array<float, kMaxLobes> weights{};
    float weight = 0.0f;
    for (std::size_t i = 0; i < answer.lobe_count; ++i) {
      multiply(throughput, answer.lobes[i].share, arrived[i]);
      weights[i] = weight_of(arrived[i], set);
      weight += weights[i];
    }
    if (!(weight > 0.0f) || ends_here(fan, weight)) return;
    const std::span<float> of_lobes(weights.data(), answer.lobe_count);
    if (settings_.drop) {
      drop_faint(of_lobes);
    } else if (weight < settings_.cutoff) {
      keep_one(fan, weight, of_lobes, arrived);
    }
    for (std::size_t i = answer.lobe_count; i-- > 0;) {
      const Lobe& lobe = answer.lobes[i];
      if (!(weights[i] > 0.0f)) continue;
      Child child{lobe.made_by, lobe.order, fan.spread || lobe.spreads,
                  at.hit.lanes, lobe.media, lobe.direction,
                  arrived[i],   weights[i]};
      if (lobe.is_bent) child.eta_ti = &answer.eta_ti;
      child.width_rad = lobe.width_rad;
      if (lobe.is_straight) {
        child.shared = at.fan.shared;
      } else if (lobe.per_sr != nullptr) {
        child.shared = lit_place(world_, at.hit, answer.rough_samples, answer.is_lit_from_behind);
        if (world_.environment) {
          LightCells::Seen seen;
          world_.environment->cells().look(child.shared.normal, seen);
          child.shared.environment = seen.total;
        }
        child.per_sr = lobe.per_sr;
      }
      if (child.spread && settings_.cluster_lanes > 0) {
        add_clusters(at, child, next);
      } else {
        add_child(at, child, next);
      }
    }
  }

 private:
  /// A fan to be made.
  struct Child {
    FanOrigin made_by;
    std::uint32_t order;
    bool spread;
    LaneMask lanes;
    const MediumStack& media;
    const LaneArray3& direction;
    const LaneArray& throughput;
    float weight;
    SharedRays shared{};  ///< But for what follows, and nothing of a lane.
    const LaneArray* per_sr =
        nullptr;  ///< Of a ray's own, where it begins to share; null: goes on.
    // For its beam.
    const LaneArray* eta_ti = nullptr;  ///< By which it is refracted; null: it is not.
    float width_rad = 0.0f;             ///< Lobe::width_rad.
  };

  // Whether the depth limit ends a fan that would have children of some weight.
  bool ends_here(const Fan& fan, float weight) {
    if (fan.depth < settings_.max_depth) return false;
    stats_.weight_lost_to_depth += static_cast<double>(weight);
    return true;
  }

  void multiply(const LaneArray& a, const LaneArray& b, LaneArray& product) const {
    const D d;
    for (int i = 0; i < stride_; i += static_cast<int>(hn::Lanes(d))) {
      hn::Store(hn::Mul(hn::Load(d, a.v + i), hn::Load(d, b.v + i)), d, product.v + i);
    }
  }

  // Whitted's plain rule.
  void drop_faint(std::span<float> weights) {
    for (float& weight : weights) {
      if (weight >= settings_.cutoff) continue;
      stats_.weight_lost_to_cutoff += static_cast<double>(weight);
      weight = 0.0f;
    }
  }

  // Follows one lobe for all, chosen by weight and divided by its probability. One random number
  // for the whole fan, tied to its path: what noise this makes is the same in all its lanes.
  void keep_one(const Fan& fan, float weight, std::span<float> weights,
                std::array<LaneArray, kMaxLobes>& throughputs) const {
    const auto has_weight = [](float w) { return w > 0.0f; };
    if (std::count_if(weights.begin(), weights.end(), has_weight) < 2) return;
    std::size_t last = weights.size() - 1;
    while (!has_weight(weights[last])) --last;
    const float u = random_1d(samples_[fan.sample].chance, fan.path, Purpose::Roulette);
    std::size_t kept = 0;
    float before = 0.0f;
    float probability = weights[0] / weight;
    while (kept < last && !(u < before + probability)) {
      before += probability;
      ++kept;
      probability = kept < last ? weights[kept] / weight : 1.0f - before;
    }
    const float scale = 1.0f / probability;
    for (int lane = 0; lane < stride_; ++lane) throughputs[kept][lane] *= scale;
    std::fill(weights.begin(), weights.end(), 0.0f);
    weights[kept] = weight;
  }

  float weight_of(const LaneArray& throughput, int set) const {
    const float* weights =
        world_.luminance_weights.data() + static_cast<std::size_t>(set) * stride_;
    // Four sums whatever the width of vectors, so that a weight has the same bits on every level.
    const hn::CappedTag<float, 4> d;
    auto sums = hn::Zero(d);
    for (int i = 0; i < stride_; i += 4) {
      sums = hn::Add(sums, hn::Mul(hn::Load(d, throughput.v + i), hn::LoadU(d, weights + i)));
    }
    return hn::GetLane(hn::SumOfLanes(d, sums));
  }

  // A spread fan as clusters of neighbouring lanes, each in the direction of its middle one.
  void add_clusters(const FanAtSurface& at, const Child& child, FanList& next) {
    const D d;
    const int set = samples_[at.fan.sample].set;
    LaneArray3 direction;
    LaneArray throughput;
    for (int first = 0; first < world_.lanes.lane_count(); first += settings_.cluster_lanes) {
      const int last = std::min(first + settings_.cluster_lanes, world_.lanes.lane_count());
      LaneMask cluster;
      int middle = -1;
      Splat(d, stride_, 0.0f, throughput);
      for (int lane = first; lane < last; ++lane) {
        if (!child.lanes.test(lane) || !(child.throughput[lane] > 0.0f)) continue;
        cluster.set(lane);
        throughput[lane] = child.throughput[lane];
        if (middle < 0 || lane <= (first + last) / 2) middle = lane;
      }
      if (middle < 0) continue;
      Splat(d, stride_, child.direction.get(middle), direction);
      add_child(
          at,
          {child.made_by, child.order, false, cluster, child.media, direction, throughput,
           weight_of(throughput, set), child.shared, child.per_sr, child.eta_ti, child.width_rad},
          next);
    }
  }

  void add_child(const FanAtSurface& at, const Child& child, FanList& next) {
    const D d;
    const Fan& parent = at.fan;
    Fan fan;
    for (int i = 0; i < stride_; i += static_cast<int>(hn::Lanes(d))) {
      SetLanesFrom(d, hn::Gt(hn::Load(d, child.throughput.v + i), hn::Zero(d)), i, fan.lanes);
    }
    fan.lanes = fan.lanes & child.lanes;
    fan.path = path_after(parent.path, static_cast<std::uint32_t>(child.made_by) + 8 * child.order);
    fan.sample = parent.sample;
    fan.weight = child.weight;
    fan.path_length_m = at.path_length_m;
    fan.depth = static_cast<std::uint16_t>(parent.depth + 1);
    fan.made_by = child.made_by;
    const bool turns = parent.first_turn == FanOrigin::Camera && child.made_by != FanOrigin::Passed;
    fan.first_turn = turns ? child.made_by : parent.first_turn;
    // A fan of one lane is one ray.
    fan.spread = child.spread && fan.lanes.count() > 1;
    fan.common_origin = fan.spread && !parent.spread;
    fan.media = child.media;
    fan.parent_record = at.record_number;
    fan.shared = child.shared;
    fan.data = next.reserve_lanes(fan.spread, fan.shared.any(), stride_);
    float* out = next.pool.data() + fan.data;
    for (int i = 0; i < stride_; i += static_cast<int>(hn::Lanes(d))) {
      hn::StoreU(
          hn::IfThenElseZero(LanesFrom(d, fan.lanes, i), hn::Load(d, child.throughput.v + i)), d,
          out + i);
    }
    fan.departure = departure_from(at.hit, fan.lanes, child.direction);
    if (fan.spread) {
      const bool all_inside = store_rays(at.hit, child.direction, fan, out + stride_);
      if (all_inside) fan.inside = world_.geometry.surface_solid[at.hit.surface];
    } else {
      const int lane = fan.lanes.front();
      const float offset_m = fan.departure.is_crowded() ? 0.0f : at.hit.offset_m[lane];
      fan.direction = child.direction.get(lane);
      fan.origin =
          off_surface(at.hit.position.get(lane), at.hit.outward.get(lane), offset_m, fan.direction);
    }
    if (fan.shared.any()) share_rays(at, child, fan, out + FanList::kSpreadArrays * stride_);
    if (const Beam* beam = at.list.beam_of(parent)) {
      next.beams.push_back(beam_after(at, *beam, child, fan.lanes.front()));
    }
    count(child.made_by, fan.spread ? static_cast<std::uint64_t>(fan.lanes.count()) : 1);
    next.fans.push_back(fan);
  }

  // The beam of a fan's first ray, behind the surface; other lanes have the same.
  HWY_NOINLINE Beam beam_after(const FanAtSurface& at, const Beam& beam, const Child& child,
                               int lane) const {
    const Beam arrived = moved(beam, at.hit.distance_m[lane]);
    const bool is_mirrored = child.made_by == FanOrigin::Reflected;
    const Vec3f departure = child.direction.get(lane);
    if (!is_mirrored && child.eta_ti == nullptr) {
      return child.width_rad > 0.0f ? widened(arrived, departure, child.width_rad) : arrived;
    }
    BeamTurn turn{at.hit.direction.get(lane), departure, at.hit.outward.get(lane)};
    turn.normal = at.hit.normal.get(lane);
    const bool is_of_coat = is_mirrored && child.order > 0;
    const bool outside = glm::dot(turn.normal, turn.outward) > 0.0f;
    turn.normal_change = normal_changes(
        world_, at.hit, lane, on_surface(arrived, turn.arrival, turn.outward), is_of_coat);
    if (!outside) turn.normal = -turn.normal;
    const Beam after =
        is_mirrored ? reflected(arrived, turn) : refracted(arrived, turn, (*child.eta_ti)[lane]);
    return child.width_rad > 0.0f ? widened(after, departure, child.width_rad) : after;
  }

  // How likely the rays of a new fan were drawn, and how far they have come since.
  HWY_NOINLINE void share_rays(const FanAtSurface& at, const Child& child, Fan& fan,
                               float* of_lanes) const {
    const auto density = [&](int lane) {
      return child.per_sr != nullptr ? (*child.per_sr)[lane]
                                     : at.list.per_sr(at.fan, lane, stride_);
    };
    const auto way_m = [&](int lane) {
      return child.per_sr != nullptr
                 ? 0.0f
                 : at.list.way_m(at.fan, lane, stride_) + at.hit.distance_m[lane];
    };
    if (!fan.spread) {
      fan.shared.per_sr = density(fan.lanes.front());
      fan.shared.way_m = way_m(fan.lanes.front());
      return;
    }
    for (int lane = 0; lane < stride_; ++lane) {
      const bool member = fan.lanes.test(lane);
      of_lanes[lane] = member ? density(lane) : 0.0f;
      of_lanes[stride_ + lane] = member ? way_m(lane) : 0.0f;
    }
  }

  // A ray per lane, as FanList has them; whether all of them go below the surface.
  bool store_rays(const SurfaceHit& hit, const LaneArray3& directions, const Fan& fan,
                  float* out) const {
    const D d;
    bool all_inside = true;
    const auto step = hn::Set(d, fan.departure.is_crowded() ? 0.0f : 1.0f);
    for (int i = 0; i < stride_; i += static_cast<int>(hn::Lanes(d))) {
      const auto direction = Load3(d, directions, i);
      const auto outward = Load3(d, hit.outward, i);
      const auto inside = hn::Lt(Dot3(d, direction, outward), hn::Zero(d));
      all_inside &= hn::AllFalse(d, hn::AndNot(inside, LanesFrom(d, fan.lanes, i)));
      const auto origin = OffSurface(d, Load3(d, hit.position, i), outward,
                                     hn::Mul(step, hn::Load(d, hit.offset_m.v + i)), inside);
      hn::StoreU(origin.x, d, out + i);
      hn::StoreU(origin.y, d, out + stride_ + i);
      hn::StoreU(origin.z, d, out + 2 * stride_ + i);
      hn::StoreU(direction.x, d, out + 3 * stride_ + i);
      hn::StoreU(direction.y, d, out + 4 * stride_ + i);
      hn::StoreU(direction.z, d, out + 5 * stride_ + i);
    }
    return all_inside;
  }

  void count(FanOrigin made_by, std::uint64_t rays) {
    switch (made_by) {
      case FanOrigin::Reflected:
        stats_.reflected_rays += rays;
        break;
      case FanOrigin::Refracted:
        stats_.refracted_rays += rays;
        break;
      default:
        stats_.passed_rays += rays;
        break;
    }
  }

  const World& world_;
  const IntegratorSettings& settings_;
  std::span<const CameraSample> samples_;
  IntegratorStats& stats_;
  const int stride_;
};

}  // namespace HWY_NAMESPACE
}  // namespace abbe
HWY_AFTER_NAMESPACE();

#endif  // ABBE_INTEGRATE_BRANCHING_INL_H_
