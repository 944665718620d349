/// The children of a fan. Highway code, compiled once per instruction set.

#if defined(ABBE_INTEGRATE_BRANCHING_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef ABBE_INTEGRATE_BRANCHING_INL_H_
#undef ABBE_INTEGRATE_BRANCHING_INL_H_
#else
#define ABBE_INTEGRATE_BRANCHING_INL_H_
#endif

#include <algorithm>
#include <cstdint>
#include <span>

#include "abbe/integrate/buffers.h"
#include "abbe/integrate/integrator.h"
#include "abbe/integrate/recorder.h"
#include "abbe/integrate/surface/shading.h"
#include "abbe/math/lanes-inl.h"
#include "abbe/math/sampling.h"

HWY_BEFORE_NAMESPACE();
namespace abbe {
namespace HWY_NAMESPACE {

/// Makes the fans that a fan becomes at a surface.
template <class D>
class Branching {
 public:
  Branching(const World& world, const IntegratorSettings& settings,
            std::span<const CameraSample> samples, IntegratorStats& stats,
            IntegratorScratch::Buffers& buffers, const Shading& shading)
      : world_(world),
        settings_(settings),
        samples_(samples),
        stats_(stats),
        b_(buffers),
        shading_(shading),
        stride_(world.lanes.lane_stride()) {}

  /// The share of light that a partly transparent surface lets by goes straight on.
  void pass_through(const Fan& fan, const LaneMask& lanes, float path_length_m,
                    std::uint32_t record_number, FanList& next) {
    Interaction& at = b_.at;
    bool any = false;
    for (int lane = 0; lane < stride_; ++lane) {
      const float alpha = at.alpha[lane];
      reflected_[lane] = at.throughput[lane] * (1.0f - alpha);
      at.throughput[lane] *= alpha;
      any |= reflected_[lane] > 0.0f;
    }
    if (!any) return;
    const float weight = weight_of(reflected_, samples_[fan.sample].set);
    if (fan.depth >= settings_.max_depth) {
      stats_.weight_lost_to_depth += static_cast<double>(weight);
      return;
    }
    add_child(fan, lanes, FanOrigin::Passed, fan.media, at.direction, fan.spread, reflected_,
              weight, path_length_m, record_number, next);
  }

  /// The reflected and the refracted child, or below the cutoff one of them for the whole fan.
  void branch(const Fan& fan, const LaneMask& lanes, Crossing crossing, const MediumStack& behind,
              float path_length_m, std::uint32_t record_number, FanList& next) {
    Interaction& at = b_.at;
    const int set = samples_[fan.sample].set;
    LaneArray& reflected = reflected_;
    LaneArray& refracted = refracted_;
    const bool refracts = crossing != Crossing::None;
    const D d;
    for (int i = 0; i < stride_; i += static_cast<int>(hn::Lanes(d))) {
      const auto throughput = hn::Load(d, at.throughput.v + i);
      hn::Store(hn::Mul(throughput, hn::Load(d, shading_.k_r.v + i)), d, reflected.v + i);
      const auto passed = hn::Mul(throughput, hn::Load(d, shading_.k_t.v + i));
      hn::Store(refracts ? passed : hn::Zero(d), d, refracted.v + i);
    }
    float reflected_weight = weight_of(reflected, set);
    float refracted_weight = refracts ? weight_of(refracted, set) : 0.0f;
    const float weight = reflected_weight + refracted_weight;
    if (!(weight > 0.0f)) return;
    if (fan.depth >= settings_.max_depth) {
      stats_.weight_lost_to_depth += static_cast<double>(weight);
      return;
    }
    if (settings_.drop) {
      const auto drop_faint = [&](float& child) {
        if (child >= settings_.cutoff) return;
        stats_.weight_lost_to_cutoff += static_cast<double>(child);
        child = 0.0f;
      };
      drop_faint(reflected_weight);
      drop_faint(refracted_weight);
    } else if (weight < settings_.cutoff && reflected_weight > 0.0f && refracted_weight > 0.0f) {
      // One random number for the whole fan, tied to its path: what noise this makes is the same in
      // all its lanes.
      const float u = unit_float(static_cast<std::uint32_t>(hash64(fan.path ^ 0x6272616e6368ull)));
      const float p = reflected_weight / weight;
      const bool take_reflected = u < p;
      LaneArray& kept = take_reflected ? reflected : refracted;
      const float scale = 1.0f / (take_reflected ? p : 1.0f - p);
      for (int lane = 0; lane < stride_; ++lane) kept[lane] *= scale;
      reflected_weight = take_reflected ? weight : 0.0f;
      refracted_weight = take_reflected ? 0.0f : weight;
    }
    if (refracted_weight > 0.0f) {
      const bool straight = crossing == Crossing::Thin || crossing == Crossing::Hidden;
      const bool spreads = fan.spread || (!straight && !same_in_all_lanes(lanes));
      if (spreads && settings_.cluster_lanes > 0) {
        add_clusters(fan, lanes, behind, refracted, path_length_m, record_number, next);
      } else {
        add_child(fan, lanes, FanOrigin::Refracted, behind, shading_.refracted, spreads, refracted,
                  refracted_weight, path_length_m, record_number, next);
      }
    }
    if (reflected_weight > 0.0f) {
      add_child(fan, lanes, FanOrigin::Reflected, fan.media, shading_.reflected, fan.spread,
                reflected, reflected_weight, path_length_m, record_number, next);
    }
  }

  /// Says which surface the calls that follow are about.
  void begin_surface(std::uint32_t surface) { solid_ = world_.geometry.surface_solid[surface]; }

 private:
  float weight_of(const LaneArray& throughput, int set) const {
    const float* importance = world_.importance.data() + static_cast<std::size_t>(set) * stride_;
    // Four sums whatever the width of vectors, so that a weight has the same bits on every level.
    const hn::CappedTag<float, 4> d;
    auto sums = hn::Zero(d);
    for (int i = 0; i < stride_; i += 4) {
      sums = hn::Add(sums, hn::Mul(hn::Load(d, throughput.v + i), hn::LoadU(d, importance + i)));
    }
    return hn::GetLane(hn::SumOfLanes(d, sums));
  }

  // The refracted fan as clusters of neighbouring lanes, each along the way of its middle one.
  void add_clusters(const Fan& parent, const LaneMask& lanes, const MediumStack& behind,
                    const LaneArray& throughput, float path_length_m, std::uint32_t record_number,
                    FanList& next) {
    const D d;
    const int set = samples_[parent.sample].set;
    LaneArray3 direction;
    LaneArray cluster_throughput;
    for (int first = 0; first < world_.lanes.lane_count(); first += settings_.cluster_lanes) {
      const int last = std::min(first + settings_.cluster_lanes, world_.lanes.lane_count());
      LaneMask cluster;
      int middle = -1;
      Splat(d, stride_, 0.0f, cluster_throughput);
      for (int lane = first; lane < last; ++lane) {
        if (!lanes.test(lane) || !(throughput[lane] > 0.0f)) continue;
        cluster.set(lane);
        cluster_throughput[lane] = throughput[lane];
        if (middle < 0 || lane <= (first + last) / 2) middle = lane;
      }
      if (middle < 0) continue;
      Splat(d, stride_, shading_.refracted.get(middle), direction);
      add_child(parent, cluster, FanOrigin::Refracted, behind, direction, false, cluster_throughput,
                weight_of(cluster_throughput, set), path_length_m, record_number, next);
    }
  }

  // Whether a united fan stays united when it refracts: there is one index for all its lanes.
  bool same_in_all_lanes(const LaneMask& lanes) const {
    const float eta = shading_.eta_ti[lanes.front()];
    return LanesWith(D(), stride_, shading_.eta_ti.v, eta, lanes) == lanes;
  }

  void add_child(const Fan& parent, const LaneMask& lanes, FanOrigin made_by,
                 const MediumStack& media, const LaneArray3& directions, bool spread,
                 const LaneArray& throughput, float weight, float path_length_m,
                 std::uint32_t record_number, FanList& next) {
    const Interaction& at = b_.at;
    Fan fan;
    const D d;
    for (int i = 0; i < stride_; i += static_cast<int>(hn::Lanes(d))) {
      SetLanesFrom(d, hn::Gt(hn::Load(d, throughput.v + i), hn::Zero(d)), i, fan.lanes);
    }
    fan.lanes = fan.lanes & lanes;
    fan.path = hash64(parent.path + static_cast<std::uint64_t>(made_by));
    fan.sample = parent.sample;
    fan.weight = weight;
    fan.path_length_m = path_length_m;
    fan.depth = static_cast<std::uint16_t>(parent.depth + 1);
    fan.made_by = made_by;
    const bool turns = parent.first_turn == FanOrigin::Camera && made_by != FanOrigin::Passed;
    fan.first_turn = turns ? made_by : parent.first_turn;
    // A fan of one lane is one ray.
    fan.spread = spread && fan.lanes.count() > 1;
    fan.common_origin = fan.spread && !parent.spread;
    fan.media = media;
    fan.parent_record = record_number;
    fan.data = next.reserve_lanes(fan.spread, stride_);
    float* out = next.pool.data() + fan.data;
    const int step = static_cast<int>(hn::Lanes(d));
    for (int i = 0; i < stride_; i += step) {
      hn::StoreU(hn::IfThenElseZero(LanesFrom(d, fan.lanes, i), hn::Load(d, throughput.v + i)), d,
                 out + i);
    }
    if (fan.spread) {
      bool all_inside = true;
      for (int i = 0; i < stride_; i += step) {
        const auto direction = Load3(d, directions, i);
        const auto outward = Load3(d, at.outward, i);
        const auto position = Load3(d, at.position, i);
        const auto inside = hn::Lt(Dot3(d, direction, outward), hn::Zero(d));
        all_inside &= hn::AllFalse(d, hn::AndNot(inside, LanesFrom(d, fan.lanes, i)));
        const auto offset = hn::Load(d, at.offset_m.v + i);
        const auto signed_offset = hn::IfThenElse(inside, hn::Neg(offset), offset);
        const auto origin = Combine3(d, hn::Set(d, 1.0f), position, signed_offset, outward);
        hn::StoreU(origin.x, d, out + stride_ + i);
        hn::StoreU(origin.y, d, out + 2 * stride_ + i);
        hn::StoreU(origin.z, d, out + 3 * stride_ + i);
        hn::StoreU(direction.x, d, out + 4 * stride_ + i);
        hn::StoreU(direction.y, d, out + 5 * stride_ + i);
        hn::StoreU(direction.z, d, out + 6 * stride_ + i);
      }
      if (all_inside) fan.inside = solid_;
    } else {
      const int lane = fan.lanes.front();
      const Vec3f outward = at.outward.get(lane);
      fan.direction = directions.get(lane);
      const float side = glm::dot(fan.direction, outward) < 0.0f ? -1.0f : 1.0f;
      fan.origin = at.position.get(lane) + (side * at.offset_m[lane]) * outward;
    }
    const std::uint64_t rays =
        fan.spread ? static_cast<std::uint64_t>(fan.lanes.count()) : std::uint64_t{1};
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
    next.fans.push_back(fan);
  }

  const World& world_;
  const IntegratorSettings& settings_;
  std::span<const CameraSample> samples_;
  IntegratorStats& stats_;
  IntegratorScratch::Buffers& b_;
  const Shading& shading_;
  const int stride_;
  std::uint32_t solid_ = kNoPrimitive;  ///< Of the surface at hand, if it is an exact shape's.
  LaneArray reflected_, refracted_;     ///< Throughputs of the children being made.
};

}  // namespace HWY_NAMESPACE
}  // namespace abbe
HWY_AFTER_NAMESPACE();

#endif  // ABBE_INTEGRATE_BRANCHING_INL_H_
