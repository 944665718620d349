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

#include "abbe/caustics/flat/light/parallel-inl.h"
#include "abbe/caustics/flat/light/point-inl.h"
#include "abbe/integrate/fog/fog-inl.h"
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

  /// Light of the lamps that fog scatters into rays on their way outside of all bodies.
  /// Shape: origins and directions in every lane; distance_m to where the ray ends, or infinity.
  void scatter(const Fan& fan, const LaneMask& lanes, const LaneArray3& origins,
               const LaneArray3& directions, const LaneArray& distance_m,
               const LaneArray& throughput) {
    const D d;
    const float extinction = world_.fog->extinction_per_m;
    const int set = samples_[fan.sample].set;
    // Farther away fog is black: exp(−16) is 1e-7.
    const auto farthest = hn::Set(d, 16.0f / extinction);
    for (int i = 0; i < stride_; i += static_cast<int>(hn::Lanes(d))) {
      hn::Store(hn::Min(hn::Load(d, distance_m.v + i), farthest), d, fog_.ends_m.v + i);
    }
    fog_.rays = {&origins, &directions, &throughput};
    for (const WorldLight& light : world_.lights) {
      if (!LampSegments(d, stride_, fan.spread, light, origins, directions, fog_.ends_m,
                        fog_.lit)) {
        continue;
      }
      for (int piece = 0; piece < pieces(fan); ++piece) {
        if (light.is_parallel) {
          take_depth(fan.spread, place_of(fan, piece));
        } else {
          take_angle(fan, light, place_of(fan, piece));
        }
        place_fog(fan, set);
        scatter_straight(fan, lanes, light, set);
      }
    }
    for (const ParallelChain& chain : caustics_.parallel.chains) {
      if (chain.ends_inside) continue;
      const ParallelChainLight<D> light(world_, caustics_.parallel, chain, set);
      if (!light.segments(origins, directions, fog_.ends_m, fog_.lit)) continue;
      for (int piece = 0; piece < pieces(fan); ++piece) {
        take_depth(true, place_of(fan, piece));
        place_fog(fan, set);
        constexpr PixelOnSurface kPoint;
        if (!light.run(fog_.places, kPoint, to_light_, met_)) continue;
        send_arrived(chain, fan, lanes);
      }
    }
    scatter_point_chains(fan, lanes, set);
  }

 private:
  // A lit segment of a camera ray is cut into pieces of equal weight with a shadow ray each; where
  // it goes in its piece is stratified over the samples of the pixel, so that few will do.
  static int pieces(const Fan& fan) { return fan.depth == 0 ? 2 : 1; }
  float place_of(const Fan& fan, int piece) const {
    return (static_cast<float>(piece) + samples_[fan.sample].u_fog) /
           static_cast<float>(pieces(fan));
  }

  struct FogRays {
    const LaneArray3* origins = nullptr;
    const LaneArray3* directions = nullptr;
    const LaneArray* throughput = nullptr;
  };
  struct FogWork {
    FogRays rays;
    LaneSegments lit;
    LaneArray ends_m, distance_m, weight_m, scattered;
    LaneArray3 places;
  };

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
      const float begin_m = fog_.lit.begin_m[lane];
      const float length_m = fog_.lit.end_m[lane] - begin_m;
      const float hidden = -std::expm1(-extinction * length_m);
      const float kept = 1.0f - u * hidden;
      const float along_m = -std::log1p(-u * hidden) / extinction;
      fog_.distance_m[lane] = begin_m + std::min(along_m, length_m);
      fog_.weight_m[lane] = hidden / (extinction * kept);
    });
    if (!spread) splat_place();
  }

  // Goes to a share u of the angle under which a lamp sees the segment: its light falls off with
  // the square of the distance, and dt = (h² + s²)/h dθ makes up for that.
  // Source: Kulla and Fajardo, Importance sampling techniques for path tracing in participating
  // media, 2012, 4.
  void take_angle(const Fan& fan, const WorldLight& light, float u) {
    for_rays(fan.spread, [&](int lane) {
      const Vec3f to_lamp = light.position - fog_.rays.origins->get(lane);
      const Vec3f direction = fog_.rays.directions->get(lane);
      const float nearest = glm::dot(to_lamp, direction);
      const float height = std::max(glm::length(to_lamp - nearest * direction), 1e-6f);
      const float begin_m = fog_.lit.begin_m[lane];
      const float end_m = fog_.lit.end_m[lane];
      const float first = std::atan2(begin_m - nearest, height);
      const float last = std::atan2(end_m - nearest, height);
      const float s = height * std::tan(first + u * (last - first));
      fog_.distance_m[lane] = std::clamp(nearest + s, begin_m, end_m);
      fog_.weight_m[lane] = (last - first) * (height * height + s * s) / height;
    });
    if (!fan.spread) splat_place();
  }

  void splat_place() {
    Splat(D(), stride_, fog_.distance_m[0], fog_.distance_m);
    Splat(D(), stride_, fog_.weight_m[0], fog_.weight_m);
  }

  void place_fog(const Fan& fan, int set) {
    FogPlaces(D(), stride_, *world_.fog, world_.row(world_.fog->albedo, set),
              1.0f / static_cast<float>(pieces(fan)), *fog_.rays.origins, *fog_.rays.directions,
              fog_.distance_m, fog_.weight_m, *fog_.rays.throughput, fog_.places, fog_.scattered);
  }

  void scatter_straight(const Fan& fan, const LaneMask& lanes, const WorldLight& light, int set) {
    const D d;
    StraightLight(d, stride_, light, world_.row(light.row, set), fog_.places, to_light_);
    if (light.has_distance()) {
      Attenuate(d, stride_, world_.fog->extinction_per_m, to_light_.distance_m,
                to_light_.irradiance);
    }
    ShadowJob job;
    job.spread = fan.spread;
    job.ends_at_glass =
        caustics_.of_light(static_cast<std::size_t>(&light - world_.lights.data())) != nullptr;
    add_job(fan, lanes, job, [&](int lane) {
      return Ray{fog_.places.get(lane), to_light_.distance_m[lane], to_light_.direction.get(lane)};
    });
  }

  // Light of point and spot lamps that comes to fog on chains.
  void scatter_point_chains(const Fan& fan, const LaneMask& lanes, int set) {
    for (const PointChainGroup& group : caustics_.point.groups) {
      if (group.ends_inside || !find_segment(fan, group, group.reach, group.slope)) continue;
      for (std::uint32_t c = group.first_chain; c < group.first_chain + group.chain_count; ++c) {
        const PointChain& chain = caustics_.point.chains[c];
        if (!find_segment(fan, group, chain.reach, chain.slope)) continue;
        for (int piece = 0; piece < pieces(fan); ++piece) {
          take_depth(fan.spread, place_of(fan, piece));
          place_fog(fan, set);
          PointChainLight<D> light(world_, caustics_.point, chain, set);
          if (!light.run(fog_.places, lanes, !fan.spread, to_light_, met_)) continue;
          send_arrived(chain, fan, lanes);
        }
      }
    }
  }

  // The part of every lane's ray that may lie in the bounds of a chain or of a group of them.
  bool find_segment(const Fan& fan, const PointChainGroup& group, const std::array<float, 8>& reach,
                    const std::array<float, 8>& slope) {
    bool any = false;
    for_rays(fan.spread, [&](int lane) {
      any |= SegmentInBounds(group, reach, slope, fog_.rays.origins->get(lane),
                             fog_.rays.directions->get(lane), fog_.ends_m[lane],
                             &fog_.lit.begin_m[lane], &fog_.lit.end_m[lane]);
    });
    if (any && !fan.spread) splat_segment();
    return any;
  }

  void splat_segment() {
    Splat(D(), stride_, fog_.lit.begin_m[0], fog_.lit.begin_m);
    Splat(D(), stride_, fog_.lit.end_m[0], fog_.lit.end_m);
  }

  // Notes the light that a chain brings, which lies in to_light_ and met_.
  void send_arrived(const ChainPath& chain, const Fan& fan, const LaneMask& lanes) {
    ShadowJob job;
    job.spread = true;
    job.ends_at_glass = true;
    const auto ray_of = [&](int lane) { return LastRay(chain, met_, fog_.places.get(lane), lane); };
    if (add_job(fan, lanes, job, ray_of)) AddGates(shadows_, world_, chain, met_, job);
  }

  // Whether the light at hand comes to anything in any lane; then it waits in the queue.
  template <class RayOf>
  bool add_job(const Fan& fan, const LaneMask& lanes, ShadowJob& job, RayOf&& ray_of) {
    const D d;
    float* light = shadows_.reserve(job);
    for (int i = 0; i < stride_; i += static_cast<int>(hn::Lanes(d))) {
      const auto value =
          hn::Mul(hn::Load(d, fog_.scattered.v + i), hn::Load(d, to_light_.irradiance.v + i));
      hn::StoreU(value, d, light + i);
    }
    if (!shadows_.keep_lit(job, lanes)) return false;
    job.sample = fan.sample;
    job.first_turn = fan.first_turn;
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
  FogWork fog_;
};

}  // namespace HWY_NAMESPACE
}  // namespace abbe
HWY_AFTER_NAMESPACE();

#endif  // ABBE_INTEGRATE_FOG_FOG_LIGHT_INL_H_
