/// Light in fog. Highway code, compiled once per instruction set.

#if defined(ABBE_INTEGRATE_FOG_FOG_LIGHT_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef ABBE_INTEGRATE_FOG_FOG_LIGHT_INL_H_
#undef ABBE_INTEGRATE_FOG_FOG_LIGHT_INL_H_
#else
#define ABBE_INTEGRATE_FOG_FOG_LIGHT_INL_H_
#endif

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <span>

#include "abbe/base/constants.h"
#include "abbe/caustics/flat/light/drawn_place.h"
#include "abbe/caustics/flat/light/parallel-inl.h"
#include "abbe/caustics/flat/light/point-inl.h"
#include "abbe/integrate/light/chain_gates-inl.h"
#include "abbe/optics/absorption-inl.h"
#include "abbe/world/light/lights-inl.h"

HWY_BEFORE_NAMESPACE();
namespace abbe {
namespace HWY_NAMESPACE {

/// The light of lamps that fog scatters into the rays of fans.
template <class D>
class FogLight {
 public:
  FogLight(const LitWorld& world, std::span<const CameraSample> samples, ShadowQueue<D>& shadows,
           KnownMisses& misses)
      : world_(world),
        caustics_(world.caustics),
        samples_(samples),
        shadows_(shadows),
        misses_(misses),
        stride_(world.lanes.lane_stride()) {}

  /// Light of the lamps that fog scatters into rays outside of all bodies.
  /// Shape: origins and directions in every lane; distance_m to where the ray ends, or infinity.
  void scatter(const Fan& fan, const LaneMask& lanes, const LaneArray3& origins,
               const LaneArray3& directions, const LaneArray& distance_m,
               const LaneArray& throughput) {
    const D d;
    // Farther away fog is black: exp(−16) is 1e-7.
    const auto farthest = hn::Set(d, 16.0f / world_.fog->extinction_per_m);
    LaneArray ends_m;
    for (int i = 0; i < stride_; i += static_cast<int>(hn::Lanes(d))) {
      hn::Store(hn::Min(hn::Load(d, distance_m.v + i), farthest), d, ends_m.v + i);
    }
    const FanInFog in_fog{
        fan,           lanes, {origins, directions, ends_m}, throughput, samples_[fan.sample].set,
        place_for(fan)};
    scatter_straight(in_fog);
    scatter_parallel_chains(in_fog);
    scatter_point_chains(in_fog);
  }

 private:
  struct FanInFog {
    const Fan& fan;
    const LaneMask& lanes;
    LaneRays rays;
    const LaneArray& throughput;
    int set = 0;
    std::uint32_t place = 0;  ///< Of lamps with an extent, the one whose chains are followed.
  };

  // Places on rays, and what weight they have of their segment, in metres.
  struct Distances {
    LaneArray distance_m, weight_m;
  };

  // Fog at a place on every ray, and the light that it sends back for each unit of irradiance.
  struct LitFog {
    LaneArray3 places;
    LaneArray scattered;
  };

  // A lit segment of a camera ray is cut into pieces of equal weight with a shadow ray each; where
  // it goes in its piece is stratified over the samples of the pixel, so that few will do.
  static int pieces(const Fan& fan) { return fan.depth == 0 ? 2 : 1; }
  float share_of(const Fan& fan, int piece) const {
    return (static_cast<float>(piece) + samples_[fan.sample].u_fog) /
           static_cast<float>(pieces(fan));
  }

  // Calls body(lane) for every lane that has a ray of its own.
  template <class Body>
  void for_rays(bool spread, Body&& body) const {
    for (int lane = 0; lane < (spread ? stride_ : 1); ++lane) body(lane);
  }

  // Goes to a share u of what fog in the segment hides: e^(−σt) falls off evenly in u, so that an
  // evenly lit segment has no noise.
  Distances at_depth(bool spread, const LaneSegments& lit, float u) const {
    Distances at;
    const float extinction = world_.fog->extinction_per_m;
    for_rays(spread, [&](int lane) {
      const float begin_m = lit.begin_m[lane];
      const float length_m = lit.end_m[lane] - begin_m;
      const float hidden = -std::expm1(-extinction * length_m);
      const float kept = 1.0f - u * hidden;
      const float along_m = -std::log1p(-u * hidden) / extinction;
      at.distance_m[lane] = begin_m + std::min(along_m, length_m);
      at.weight_m[lane] = hidden / (extinction * kept);
    });
    if (!spread) splat(at);
    return at;
  }

  // Goes to a share u of the angle under which a lamp sees the segment: its light falls off with
  // the square of the distance, and dt = (h² + s²)/h dθ makes up for that.
  // Source: Kulla and Fajardo, Importance sampling techniques for path tracing in participating
  // media, 2012, 4.
  Distances at_angle(const FanInFog& in_fog, const WorldLight& light, const LaneSegments& lit,
                     float u) const {
    Distances at;
    for_rays(in_fog.fan.spread, [&](int lane) {
      const Vec3f to_lamp = light.position - in_fog.rays.origin.get(lane);
      const Vec3f direction = in_fog.rays.direction.get(lane);
      const float nearest = glm::dot(to_lamp, direction);
      const float height = std::max(glm::length(to_lamp - nearest * direction), 1e-6f);
      const float begin_m = lit.begin_m[lane];
      const float end_m = lit.end_m[lane];
      const float first = std::atan2(begin_m - nearest, height);
      const float last = std::atan2(end_m - nearest, height);
      const float s = height * std::tan(first + u * (last - first));
      at.distance_m[lane] = std::clamp(nearest + s, begin_m, end_m);
      at.weight_m[lane] = (last - first) * (height * height + s * s) / height;
    });
    if (!in_fog.fan.spread) splat(at);
    return at;
  }

  void splat(Distances& at) const {
    Splat(D(), stride_, at.distance_m[0], at.distance_m);
    Splat(D(), stride_, at.weight_m[0], at.weight_m);
  }

  // The light that fog there sends back along the rays and through the fog before:
  // throughput · albedo · σ/(4π) · exp(−σ t) · weight / pieces.
  LitFog fog_at(const FanInFog& in_fog, const Distances& at) const {
    const D d;
    LitFog fog_there;
    const WorldFog& fog = *world_.fog;
    const float* albedo_row = world_.row(fog.albedo, in_fog.set);
    const float share = fog.extinction_per_m * static_cast<float>(0.25 / kPi) *
                        (1.0f / static_cast<float>(pieces(in_fog.fan)));
    for (int i = 0; i < stride_; i += static_cast<int>(hn::Lanes(d))) {
      const auto t = hn::Load(d, at.distance_m.v + i);
      Store3(d,
             Combine3(d, hn::Set(d, 1.0f), Load3(d, in_fog.rays.origin, i), t,
                      Load3(d, in_fog.rays.direction, i)),
             fog_there.places, i);
      const auto through = Attenuated(d, hn::Set(d, 1.0f), hn::Set(d, fog.extinction_per_m), t);
      const auto albedo = hn::Mul(hn::LoadU(d, albedo_row + i), hn::Set(d, share));
      hn::Store(hn::Mul(hn::Mul(hn::Load(d, in_fog.throughput.v + i), albedo),
                        hn::Mul(through, hn::Load(d, at.weight_m.v + i))),
                d, fog_there.scattered.v + i);
    }
    return fog_there;
  }

  void scatter_straight(const FanInFog& in_fog) {
    const D d;
    const Fan& fan = in_fog.fan;
    LaneSegments lit;
    LightGeometry to_light;
    for (const WorldLight& light : world_.lights) {
      if (!LampSegments(d, stride_, fan.spread, light, in_fog.rays, lit)) continue;
      for (int piece = 0; piece < pieces(fan); ++piece) {
        const float u = share_of(fan, piece);
        const LitFog fog = fog_at(in_fog, light.is_parallel ? at_depth(fan.spread, lit, u)
                                                            : at_angle(in_fog, light, lit, u));
        StraightLight(d, stride_, light, world_.row(light.row, in_fog.set), fog.places, to_light);
        if (light.has_distance()) {
          Attenuate(d, stride_, world_.fog->extinction_per_m, to_light.distance_m,
                    to_light.irradiance);
        }
        ShadowJob job;
        job.spread = fan.spread;
        job.at_glass = rule_of(caustics_, static_cast<std::size_t>(&light - world_.lights.data()));
        add_job(in_fog, fog, to_light, job, [&](int lane) {
          return Ray{fog.places.get(lane), to_light.distance_m[lane], to_light.direction.get(lane)};
        });
      }
    }
  }

  std::uint32_t place_for(const Fan& fan) const {
    if (caustics_.near_places.empty()) return 0;
    return drawn_place(caustics_, samples_[fan.sample].chance, fan.path);
  }
  bool is_followed(const FanInFog& in_fog, std::uint32_t source) const {
    const ChainSource& from = caustics_.sources[source];
    return !from.is_part || from.place == in_fog.place;
  }

  void scatter_parallel_chains(const FanInFog& in_fog) {
    LaneSegments lit;
    LightGeometry to_light;
    ChainPlaces met;
    for (const ParallelChain& chain : caustics_.parallel.chains) {
      if (chain.ends_in() || !is_followed(in_fog, chain.source)) continue;
      ParallelChainLight<D> light(world_, caustics_, chain, in_fog.set);
      if (!light.segments(in_fog.rays, lit)) continue;
      for (int piece = 0; piece < pieces(in_fog.fan); ++piece) {
        const LitFog fog = fog_at(in_fog, at_depth(true, lit, share_of(in_fog.fan, piece)));
        constexpr PixelOnSurface kPoint;
        if (!light.run(fog.places, 0.0f, kPoint, to_light, met)) continue;
        send_arrived(chain, in_fog, fog, to_light, met);
      }
    }
  }

  // Light of point and spot lamps that comes to fog on chains.
  void scatter_point_chains(const FanInFog& in_fog) {
    const bool spread = in_fog.fan.spread;
    LaneSegments lit;
    LightGeometry to_light;
    ChainPlaces met;
    for (const PointChainGroup& group : caustics_.point.groups) {
      if (group.ends_in || !is_followed(in_fog, group.source)) continue;
      if (!find_segment(in_fog, group, nullptr, lit)) continue;
      for (std::uint32_t c = group.first_chain; c < group.first_chain + group.chain_count; ++c) {
        const PointChain& chain = caustics_.point.chains[c];
        if (!find_segment(in_fog, group, &chain, lit)) continue;
        for (int piece = 0; piece < pieces(in_fog.fan); ++piece) {
          const LitFog fog = fog_at(in_fog, at_depth(spread, lit, share_of(in_fog.fan, piece)));
          if (!spread && misses_.hold(c, fog.places.get(0), 0.0f)) continue;
          PointChainLight<D> light(world_, caustics_, chain, in_fog.set);
          if (!light.run(fog.places, 0.0f, in_fog.lanes, !spread, to_light, met)) {
            misses_.add(c, light.middle(), light.miss());
            continue;
          }
          send_arrived(chain, in_fog, fog, to_light, met);
        }
      }
    }
  }

  // The part of every lane's ray that may lie in the light of a group or of one of its chains.
  bool find_segment(const FanInFog& in_fog, const PointChainGroup& group, const PointChain* chain,
                    LaneSegments& lit) const {
    bool any = false;
    for_rays(in_fog.fan.spread, [&](int lane) {
      const Vec3f origin = in_fog.rays.origin.get(lane);
      const Vec3f direction = in_fog.rays.direction.get(lane);
      const float end_m = in_fog.rays.end_m[lane];
      const RaySegment segment =
          chain == nullptr
              ? SegmentInBounds(group, group.bounds, origin, direction, end_m)
              : SegmentInCones(group, caustics_.point, *chain, origin, direction, end_m);
      any |= segment.begin_m < segment.end_m;
      lit.begin_m[lane] = segment.begin_m;
      lit.end_m[lane] = std::max(segment.begin_m, segment.end_m);
    });
    if (any && !in_fog.fan.spread) lit.splat(D(), stride_);
    return any;
  }

  // Notes the light that a chain brings to fog.
  void send_arrived(const ChainPath& chain, const FanInFog& in_fog, const LitFog& fog,
                    const LightGeometry& to_light, const ChainPlaces& met) {
    ShadowJob job;
    job.spread = true;
    job.at_glass = AtGlass::Ends;
    const auto place_of = [&](int lane) { return LitPlace{fog.places.get(lane)}; };
    const auto ray_of = [&](int lane) { return LastRay(chain, met, place_of(lane), lane); };
    if (!add_job(in_fog, fog, to_light, job, ray_of)) return;
    AddGates(shadows_, world_, caustics_.source_of(chain), chain, met, job, place_of);
  }

  // Whether light that arrives at fog comes to anything in any lane; then it waits in the queue.
  template <class RayOf>
  bool add_job(const FanInFog& in_fog, const LitFog& fog, const LightGeometry& to_light,
               ShadowJob& job, RayOf&& ray_of) {
    const D d;
    float* light = shadows_.reserve(job);
    for (int i = 0; i < stride_; i += static_cast<int>(hn::Lanes(d))) {
      const auto value =
          hn::Mul(hn::Load(d, fog.scattered.v + i), hn::Load(d, to_light.irradiance.v + i));
      hn::StoreU(value, d, light + i);
    }
    if (!shadows_.keep_lit(job, in_fog.lanes)) return false;
    job.sample = in_fog.fan.sample;
    job.first_turn = in_fog.fan.first_turn;
    shadows_.add(job, ray_of);
    return true;
  }

  const World& world_;
  const FlatCaustics& caustics_;
  std::span<const CameraSample> samples_;
  ShadowQueue<D>& shadows_;
  KnownMisses& misses_;
  const int stride_;
};

}  // namespace HWY_NAMESPACE
}  // namespace abbe
HWY_AFTER_NAMESPACE();

#endif  // ABBE_INTEGRATE_FOG_FOG_LIGHT_INL_H_
