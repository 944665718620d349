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

#include "abbe/integrate/fog/fog-inl.h"
#include "abbe/integrate/light/chain_gates-inl.h"
#include "abbe/integrate/light/point_chains-inl.h"
#include "abbe/integrate/light/straight_light-inl.h"

HWY_BEFORE_NAMESPACE();
namespace abbe {
namespace HWY_NAMESPACE {

/// The light of lamps that fog scatters into the rays of fans.
template <class D>
class FogLight {
 public:
  FogLight(const World& world, std::span<const CameraSample> samples, ShadowQueue<D>& shadows)
      : world_(world), samples_(samples), shadows_(shadows), stride_(world.lanes.lane_stride()) {}

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
      if (!find_stretch(fan, light)) continue;
      for (int piece = 0; piece < pieces(fan); ++piece) {
        if (has_falloff(light)) {
          take_angle(fan, light, place_of(fan, piece));
        } else {
          take_depth(fan.spread, place_of(fan, piece));
        }
        place_fog(fan, set);
        scatter_straight(fan, lanes, light, set);
      }
    }
    for (const Chain& chain : world_.chains) {
      if (chain.ends_inside) continue;
      if (!StretchInChain(d, world_, chain, set, origins, directions, fog_.ends_m, fog_.stretch)) {
        continue;
      }
      for (int piece = 0; piece < pieces(fan); ++piece) {
        take_depth(true, place_of(fan, piece));
        place_fog(fan, set);
        constexpr PixelOnSurface kPoint;
        if (!LightOnChain(d, world_, chain, set, fog_.places, kPoint, to_light_, way_)) continue;
        send_arrived(chain, fan, lanes);
      }
    }
    scatter_point_chains(fan, lanes, set);
  }

 private:
  // A lit stretch of a camera ray is cut into pieces of equal weight with a shadow ray each; where
  // it goes in its piece is stratified over the samples of the pixel, so that few will do.
  static int pieces(const Fan& fan) { return fan.depth == 0 ? 2 : 1; }
  float place_of(const Fan& fan, int piece) const {
    return (static_cast<float>(piece) + samples_[fan.sample].u_fog) /
           static_cast<float>(pieces(fan));
  }

  static bool has_falloff(const WorldLight& light) { return light.type != LightType::Directional; }

  struct FogRays {
    const LaneArray3* origins = nullptr;
    const LaneArray3* directions = nullptr;
    const LaneArray* throughput = nullptr;
  };
  struct FogWork {
    FogRays rays;
    Stretch stretch;
    LaneArray ends_m, distance_m, weight_m, scattered;
    LaneArray3 places;
  };

  // The part of every lane's ray that a lamp shines on, whatever stands in between; false when
  // that is nothing.
  bool find_stretch(const Fan& fan, const WorldLight& light) {
    const D d;
    if (light.is_beam) {
      return StretchInBeam(d, stride_, light, *fog_.rays.origins, *fog_.rays.directions,
                           fog_.ends_m, fog_.stretch);
    }
    bool any = false;
    for_rays(fan.spread, [&](int lane) {
      StretchM lit{0.0f, fog_.ends_m[lane]};
      if (light.type == LightType::Spot) {
        lit = stretch_in_cone(light, fog_.rays.origins->get(lane), fog_.rays.directions->get(lane),
                              lit.end_m);
      }
      any |= lit.begin_m < lit.end_m;
      fog_.stretch.begin_m[lane] = lit.begin_m;
      fog_.stretch.end_m[lane] = std::max(lit.begin_m, lit.end_m);
    });
    if (!fan.spread) splat_stretch();
    return any;
  }

  // Calls body(lane) for every lane that has a ray of its own.
  template <class Body>
  void for_rays(bool spread, Body&& body) const {
    for (int lane = 0; lane < (spread ? stride_ : 1); ++lane) body(lane);
  }

  // Goes to a share u of what fog in the stretch hides: e^(−σt) falls off evenly in u, so that an
  // evenly lit stretch has no noise.
  void take_depth(bool spread, float u) {
    const float extinction = world_.fog->extinction_per_m;
    for_rays(spread, [&](int lane) {
      const float begin_m = fog_.stretch.begin_m[lane];
      const float length_m = fog_.stretch.end_m[lane] - begin_m;
      const float hidden = -std::expm1(-extinction * length_m);
      const float kept = 1.0f - u * hidden;
      const float along_m = -std::log1p(-u * hidden) / extinction;
      fog_.distance_m[lane] = begin_m + std::min(along_m, length_m);
      fog_.weight_m[lane] = hidden / (extinction * kept);
    });
    if (!spread) splat_place();
  }

  // Goes to a share u of the angle under which a lamp sees the stretch: its light falls off with
  // the square of the distance, and dt = (h² + s²)/h dθ makes up for that.
  // Source: Kulla and Fajardo, Importance sampling techniques for path tracing in participating
  // media, 2012, 4.
  void take_angle(const Fan& fan, const WorldLight& light, float u) {
    for_rays(fan.spread, [&](int lane) {
      const Vec3f to_lamp = light.position - fog_.rays.origins->get(lane);
      const Vec3f direction = fog_.rays.directions->get(lane);
      const float nearest = glm::dot(to_lamp, direction);
      const float height = std::max(glm::length(to_lamp - nearest * direction), 1e-6f);
      const float begin_m = fog_.stretch.begin_m[lane];
      const float end_m = fog_.stretch.end_m[lane];
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
    if (HasDistance(light)) {
      FogAttenuate(d, stride_, world_.fog->extinction_per_m, to_light_.distance_m,
                   to_light_.irradiance);
    }
    ShadowJob job;
    job.spread = fan.spread;
    job.ends_at_glass = light.has_chains;
    add_job(fan, lanes, job, [&](int lane) {
      return Ray{fog_.places.get(lane), to_light_.distance_m[lane], to_light_.direction.get(lane)};
    });
  }

  // Light of point and spot lamps that comes to fog on chains.
  void scatter_point_chains(const Fan& fan, const LaneMask& lanes, int set) {
    for (const PointChainGroup& group : world_.point_chains.groups) {
      if (group.ends_inside || !find_stretch(fan, group, group.reach, group.slope)) continue;
      for (std::uint32_t c = group.first_chain; c < group.first_chain + group.chain_count; ++c) {
        const PointChain& chain = world_.point_chains.chains[c];
        if (!find_stretch(fan, group, chain.reach, chain.slope)) continue;
        for (int piece = 0; piece < pieces(fan); ++piece) {
          take_depth(fan.spread, place_of(fan, piece));
          place_fog(fan, set);
          PointChainLight<D> light(world_, chain, set);
          if (!light.run(fog_.places, lanes, !fan.spread, to_light_, way_)) continue;
          send_arrived(chain, fan, lanes);
        }
      }
    }
  }

  // The part of every lane's ray that may lie in the bounds of a chain or of a group of them.
  bool find_stretch(const Fan& fan, const PointChainGroup& group, const std::array<float, 8>& reach,
                    const std::array<float, 8>& slope) {
    bool any = false;
    for_rays(fan.spread, [&](int lane) {
      any |= StretchInBounds(group, reach, slope, fog_.rays.origins->get(lane),
                             fog_.rays.directions->get(lane), fog_.ends_m[lane],
                             &fog_.stretch.begin_m[lane], &fog_.stretch.end_m[lane]);
    });
    if (any && !fan.spread) splat_stretch();
    return any;
  }

  void splat_stretch() {
    Splat(D(), stride_, fog_.stretch.begin_m[0], fog_.stretch.begin_m);
    Splat(D(), stride_, fog_.stretch.end_m[0], fog_.stretch.end_m);
  }

  // Notes the light that a chain brings, which lies in to_light_ and way_.
  void send_arrived(const ChainPath& chain, const Fan& fan, const LaneMask& lanes) {
    ShadowJob job;
    job.spread = true;
    job.ends_at_glass = true;
    const auto ray_of = [&](int lane) { return LastRay(chain, way_, fog_.places.get(lane), lane); };
    if (add_job(fan, lanes, job, ray_of)) AddGates(shadows_, world_, chain, way_, job);
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
  std::span<const CameraSample> samples_;
  ShadowQueue<D>& shadows_;
  const int stride_;
  LightGeometry to_light_;
  ChainWay way_;
  FogWork fog_;
};

}  // namespace HWY_NAMESPACE
}  // namespace abbe
HWY_AFTER_NAMESPACE();

#endif  // ABBE_INTEGRATE_FOG_FOG_LIGHT_INL_H_
