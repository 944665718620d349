/// Light in fog. Highway code, compiled once per instruction set.

#if defined(ABBE_INTEGRATE_FOG_LIGHT_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef ABBE_INTEGRATE_FOG_LIGHT_INL_H_
#undef ABBE_INTEGRATE_FOG_LIGHT_INL_H_
#else
#define ABBE_INTEGRATE_FOG_LIGHT_INL_H_
#endif

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <span>

#include "integrate/chain_gates-inl.h"
#include "integrate/fog-inl.h"
#include "integrate/shade-inl.h"
#include "math/sampling.h"

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
      if (light.is_beam) {
        if (!StretchInBeam(d, stride_, light, origins, directions, fog_.ends_m, fog_.stretch)) {
          continue;
        }
        for (int piece = 0; piece < kFogPieces; ++piece) {
          take_piece(fan, set, piece, 0.5f, kFogPieces);
          scatter_straight(fan, lanes, light, set);
        }
        continue;
      }
      // One random number for all lanes, tied to the fan's path: what noise it makes has no colour.
      const std::uint64_t bits = hash64(fan.path ^ 0x666f67ull);
      const float u = unit_float(static_cast<std::uint32_t>(bits));
      for (int piece = 0; piece < kFogSteps; ++piece) {
        if (light.type == LightType::Directional) {
          fill_from_start();
          take_piece(fan, set, piece, u, kFogSteps);
        } else {
          take_angle(light, set, (static_cast<float>(piece) + u) / static_cast<float>(kFogSteps));
        }
        scatter_straight(fan, lanes, light, set);
      }
    }
    for (const Chain& chain : world_.chains) {
      if (chain.ends_inside) continue;
      if (!StretchInChain(d, world_, chain, set, origins, directions, fog_.ends_m, fog_.stretch)) {
        continue;
      }
      for (int piece = 0; piece < kFogPieces; ++piece) {
        take_piece(fan, set, piece, 0.5f, kFogPieces);
        if (!LightOnChain(d, world_, chain, set, fog_.places, to_light_, way_)) continue;
        ShadowJob job;
        job.spread = true;
        job.ends_at_glass = true;
        if (add_job(fan, lanes, job)) AddGates(shadows_, world_, chain, way_, job);
      }
    }
  }

 private:
  /// A lit stretch of a ray is cut into this many pieces, one shadow ray each: inside a beam light
  /// changes only where something stands in it.
  static constexpr int kFogPieces = 4;
  /// The same for lamps that light the whole ray.
  static constexpr int kFogSteps = 6;

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

  void fill_from_start() {
    const D d;
    for (int i = 0; i < stride_; i += static_cast<int>(hn::Lanes(d))) {
      hn::Store(hn::Zero(d), d, fog_.stretch.begin_m.v + i);
      hn::Store(hn::Load(d, fog_.ends_m.v + i), d, fog_.stretch.end_m.v + i);
    }
  }

  void place_fog(int set) {
    FogPlaces(D(), stride_, *world_.fog, world_.row(world_.fog->albedo, set), *fog_.rays.origins,
              *fog_.rays.directions, fog_.distance_m, fog_.weight_m, *fog_.rays.throughput,
              fog_.places, fog_.scattered);
  }

  // Goes to (piece + u)/pieces of the stretch.
  void take_piece(const Fan&, int set, int piece, float u, int pieces) {
    const D d;
    const auto share = hn::Set(d, 1.0f / static_cast<float>(pieces));
    const auto place = hn::Mul(hn::Set(d, static_cast<float>(piece) + u), share);
    for (int i = 0; i < stride_; i += static_cast<int>(hn::Lanes(d))) {
      const auto begin = hn::Load(d, fog_.stretch.begin_m.v + i);
      const auto length = hn::Sub(hn::Load(d, fog_.stretch.end_m.v + i), begin);
      hn::Store(hn::Add(begin, hn::Mul(length, place)), d, fog_.distance_m.v + i);
      hn::Store(hn::Mul(length, share), d, fog_.weight_m.v + i);
    }
    place_fog(set);
  }

  // Goes to a share u of the angle under which a lamp sees the ray: its light falls off with the
  // square of the distance, and dt = (h² + s²)/h dθ makes up for that.
  // Source: Kulla and Fajardo, Importance sampling techniques for path tracing in participating
  // media, 2012, 4.
  void take_angle(const WorldLight& light, int set, float u) {
    for (int lane = 0; lane < stride_; ++lane) {
      const Vec3f to_lamp = light.position - fog_.rays.origins->get(lane);
      const Vec3f direction = fog_.rays.directions->get(lane);
      const float nearest = glm::dot(to_lamp, direction);
      const float height = std::max(glm::length(to_lamp - nearest * direction), 1e-6f);
      const float first = std::atan2(-nearest, height);
      const float last = std::atan2(fog_.ends_m[lane] - nearest, height);
      const float s = height * std::tan(first + u * (last - first));
      fog_.distance_m[lane] = std::clamp(nearest + s, 0.0f, fog_.ends_m[lane]);
      fog_.weight_m[lane] =
          (last - first) * (height * height + s * s) / height / static_cast<float>(kFogSteps);
    }
    place_fog(set);
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
    add_job(fan, lanes, job);
  }

  // Whether the light at hand comes to anything in any lane; then it waits in the queue.
  bool add_job(const Fan& fan, const LaneMask& lanes, ShadowJob& job) {
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
    shadows_.add(job, [&](int lane) {
      return Ray{fog_.places.get(lane), to_light_.distance_m[lane], to_light_.direction.get(lane)};
    });
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

#endif  // ABBE_INTEGRATE_FOG_LIGHT_INL_H_
