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
#include "abbe/caustics/flat/light/parallel-inl.h"
#include "abbe/caustics/flat/light/point-inl.h"
#include "abbe/integrate/light/chain_gates-inl.h"
#include "abbe/optics/absorption-inl.h"
#include "abbe/world/lights-inl.h"

HWY_BEFORE_NAMESPACE();
namespace abbe {
namespace HWY_NAMESPACE {

/// The light of lamps that fog scatters into the rays of fans.
template <class D>
class FogLight {
 public:
  FogLight(const LitWorld& world, std::span<const CameraSample> samples, ShadowQueue<D>& shadows)
      : world_(world),
        caustics_(world.caustics),
        samples_(samples),
        shadows_(shadows),
        stride_(world.lanes.lane_stride()) {}

  /// Light of the lamps that fog scatters into rays outside of all bodies.
  /// Shape: origins and directions in every lane; distance_m to where the ray ends, or infinity.
  void scatter(const Fan& fan, const LaneMask& lanes, const LaneArray3& origins,
               const LaneArray3& directions, const LaneArray& distance_m,
               const LaneArray& throughput) {
    const D d;
    // Farther away fog is black: exp(−16) is 1e-7.
    const auto farthest = hn::Set(d, 16.0f / world_.fog->extinction_per_m);
    for (int i = 0; i < stride_; i += static_cast<int>(hn::Lanes(d))) {
      hn::Store(hn::Min(hn::Load(d, distance_m.v + i), farthest), d, ends_m_.v + i);
    }
    const FanInFog in_fog{
        fan, lanes, {origins, directions, ends_m_}, throughput, samples_[fan.sample].set};
    for (const WorldLight& light : world_.lights) {
      if (!LampSegments(d, stride_, fan.spread, light, in_fog.rays, lit_)) continue;
      for (int piece = 0; piece < pieces(fan); ++piece) {
        if (light.is_parallel) {
          take_depth(fan.spread, share_of(fan, piece));
        } else {
          take_angle(in_fog, light, share_of(fan, piece));
        }
        place_fog(in_fog);
        scatter_straight(in_fog, light);
      }
    }
    for (const ParallelChain& chain : caustics_.parallel.chains) {
      if (chain.ends_inside) continue;
      const ParallelChainLight<D> light(world_, caustics_.parallel, chain, in_fog.set);
      if (!light.segments(in_fog.rays, lit_)) continue;
      for (int piece = 0; piece < pieces(fan); ++piece) {
        take_depth(true, share_of(fan, piece));
        place_fog(in_fog);
        constexpr PixelOnSurface kPoint;
        if (light.run(places_, kPoint, to_light_, met_)) send_arrived(chain, in_fog);
      }
    }
    scatter_point_chains(in_fog);
  }

 private:
  struct FanInFog {
    const Fan& fan;
    const LaneMask& lanes;
    LaneRays rays;
    const LaneArray& throughput;
    int set = 0;
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
  void take_depth(bool spread, float u) {
    const float extinction = world_.fog->extinction_per_m;
    for_rays(spread, [&](int lane) {
      const float begin_m = lit_.begin_m[lane];
      const float length_m = lit_.end_m[lane] - begin_m;
      const float hidden = -std::expm1(-extinction * length_m);
      const float kept = 1.0f - u * hidden;
      const float along_m = -std::log1p(-u * hidden) / extinction;
      distance_m_[lane] = begin_m + std::min(along_m, length_m);
      weight_m_[lane] = hidden / (extinction * kept);
    });
    if (!spread) splat_place();
  }

  // Goes to a share u of the angle under which a lamp sees the segment: its light falls off with
  // the square of the distance, and dt = (h² + s²)/h dθ makes up for that.
  // Source: Kulla and Fajardo, Importance sampling techniques for path tracing in participating
  // media, 2012, 4.
  void take_angle(const FanInFog& in_fog, const WorldLight& light, float u) {
    for_rays(in_fog.fan.spread, [&](int lane) {
      const Vec3f to_lamp = light.position - in_fog.rays.origin.get(lane);
      const Vec3f direction = in_fog.rays.direction.get(lane);
      const float nearest = glm::dot(to_lamp, direction);
      const float height = std::max(glm::length(to_lamp - nearest * direction), 1e-6f);
      const float begin_m = lit_.begin_m[lane];
      const float end_m = lit_.end_m[lane];
      const float first = std::atan2(begin_m - nearest, height);
      const float last = std::atan2(end_m - nearest, height);
      const float s = height * std::tan(first + u * (last - first));
      distance_m_[lane] = std::clamp(nearest + s, begin_m, end_m);
      weight_m_[lane] = (last - first) * (height * height + s * s) / height;
    });
    if (!in_fog.fan.spread) splat_place();
  }

  void splat_place() {
    Splat(D(), stride_, distance_m_[0], distance_m_);
    Splat(D(), stride_, weight_m_[0], weight_m_);
  }

  // Goes to places on rays, and to the light that one metre of fog there sends back along them and
  // through the fog before: throughput · albedo · σ/(4π) · exp(−σ t) · weight / pieces.
  void place_fog(const FanInFog& in_fog) {
    const D d;
    const WorldFog& fog = *world_.fog;
    const float* albedo_row = world_.row(fog.albedo, in_fog.set);
    const float share = fog.extinction_per_m * static_cast<float>(0.25 / kPi) *
                        (1.0f / static_cast<float>(pieces(in_fog.fan)));
    for (int i = 0; i < stride_; i += static_cast<int>(hn::Lanes(d))) {
      const auto t = hn::Load(d, distance_m_.v + i);
      Store3(d,
             Combine3(d, hn::Set(d, 1.0f), Load3(d, in_fog.rays.origin, i), t,
                      Load3(d, in_fog.rays.direction, i)),
             places_, i);
      const auto through = ExpNegative(d, hn::Mul(hn::Set(d, fog.extinction_per_m), t));
      const auto albedo = hn::Mul(hn::LoadU(d, albedo_row + i), hn::Set(d, share));
      hn::Store(hn::Mul(hn::Mul(hn::Load(d, in_fog.throughput.v + i), albedo),
                        hn::Mul(through, hn::Load(d, weight_m_.v + i))),
                d, scattered_.v + i);
    }
  }

  void scatter_straight(const FanInFog& in_fog, const WorldLight& light) {
    const D d;
    StraightLight(d, stride_, light, world_.row(light.row, in_fog.set), places_, to_light_);
    if (light.has_distance()) {
      Attenuate(d, stride_, world_.fog->extinction_per_m, to_light_.distance_m,
                to_light_.irradiance);
    }
    ShadowJob job;
    job.spread = in_fog.fan.spread;
    job.ends_at_glass =
        caustics_.of_light(static_cast<std::size_t>(&light - world_.lights.data())) != nullptr;
    add_job(in_fog, job, [&](int lane) {
      return Ray{places_.get(lane), to_light_.distance_m[lane], to_light_.direction.get(lane)};
    });
  }

  // Light of point and spot lamps that comes to fog on chains.
  void scatter_point_chains(const FanInFog& in_fog) {
    const bool spread = in_fog.fan.spread;
    for (const PointChainGroup& group : caustics_.point.groups) {
      if (group.ends_inside || !find_segment(in_fog, group, group.bounds)) continue;
      for (std::uint32_t c = group.first_chain; c < group.first_chain + group.chain_count; ++c) {
        const PointChain& chain = caustics_.point.chains[c];
        if (!find_segment(in_fog, group, chain.bounds)) continue;
        for (int piece = 0; piece < pieces(in_fog.fan); ++piece) {
          take_depth(spread, share_of(in_fog.fan, piece));
          place_fog(in_fog);
          PointChainLight<D> light(world_, caustics_.point, chain, in_fog.set);
          if (!light.run(places_, in_fog.lanes, !spread, to_light_, met_)) continue;
          send_arrived(chain, in_fog);
        }
      }
    }
  }

  // The part of every lane's ray that may lie in the bounds of a chain or of a group of them.
  bool find_segment(const FanInFog& in_fog, const PointChainGroup& group,
                    const ConeBounds& bounds) {
    bool any = false;
    for_rays(in_fog.fan.spread, [&](int lane) {
      const RaySegment lit =
          SegmentInBounds(group, bounds, in_fog.rays.origin.get(lane),
                          in_fog.rays.direction.get(lane), in_fog.rays.end_m[lane]);
      any |= lit.begin_m < lit.end_m;
      lit_.begin_m[lane] = lit.begin_m;
      lit_.end_m[lane] = std::max(lit.begin_m, lit.end_m);
    });
    if (any && !in_fog.fan.spread) lit_.splat(D(), stride_);
    return any;
  }

  // Notes the light that a chain brings, which lies in to_light_ and met_.
  void send_arrived(const ChainPath& chain, const FanInFog& in_fog) {
    ShadowJob job;
    job.spread = true;
    job.ends_at_glass = true;
    const auto ray_of = [&](int lane) { return LastRay(chain, met_, places_.get(lane), lane); };
    if (add_job(in_fog, job, ray_of)) AddGates(shadows_, world_, chain, met_, job);
  }

  // Whether the light at hand comes to anything in any lane; then it waits in the queue.
  template <class RayOf>
  bool add_job(const FanInFog& in_fog, ShadowJob& job, RayOf&& ray_of) {
    const D d;
    float* light = shadows_.reserve(job);
    for (int i = 0; i < stride_; i += static_cast<int>(hn::Lanes(d))) {
      const auto value =
          hn::Mul(hn::Load(d, scattered_.v + i), hn::Load(d, to_light_.irradiance.v + i));
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
  const int stride_;
  LightGeometry to_light_;
  ChainPlaces met_;
  // Of one piece of the segments of a fan's rays: where it is lit, and a place in there.
  LaneSegments lit_;
  LaneArray ends_m_, distance_m_, weight_m_, scattered_;
  LaneArray3 places_;
};

}  // namespace HWY_NAMESPACE
}  // namespace abbe
HWY_AFTER_NAMESPACE();

#endif  // ABBE_INTEGRATE_FOG_FOG_LIGHT_INL_H_
