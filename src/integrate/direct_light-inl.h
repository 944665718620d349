/// Light from lamps: what would arrive at a batch of fans, and what stands in its way. Highway
/// code, compiled once per instruction set.

#if defined(ABBE_INTEGRATE_DIRECT_LIGHT_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef ABBE_INTEGRATE_DIRECT_LIGHT_INL_H_
#undef ABBE_INTEGRATE_DIRECT_LIGHT_INL_H_
#else
#define ABBE_INTEGRATE_DIRECT_LIGHT_INL_H_
#endif

#include <algorithm>
#include <span>

#include "integrate/buffers.h"
#include "integrate/chains-inl.h"
#include "integrate/fog-inl.h"
#include "integrate/integrator.h"
#include "integrate/passage.h"
#include "integrate/recorder.h"
#include "integrate/shade-inl.h"
#include "math/sampling.h"

HWY_BEFORE_NAMESPACE();
namespace abbe {
namespace HWY_NAMESPACE {

/// Where light of a kind belongs that was met by a fan: lanes of a part of its sample.
inline float* part_of(std::span<float> light_parts, std::uint32_t sample, FanOrigin first_turn,
                      LightPart kind, int stride) {
  if (first_turn == FanOrigin::Reflected) kind = LightPart::Reflected;
  if (first_turn == FanOrigin::Refracted) kind = LightPart::Refracted;
  const std::size_t place = sample * kLightParts + static_cast<std::size_t>(kind);
  return light_parts.data() + place * static_cast<std::size_t>(stride);
}

/// The light of lamps on the surfaces of one batch.
template <class D>
class DirectLight {
 public:
  DirectLight(const World& world, std::span<const CameraSample> samples, IntegratorStats& stats,
              IntegratorScratch::Buffers& buffers, FanRecorder& recorder)
      : world_(world),
        samples_(samples),
        stats_(stats),
        b_(buffers),
        recorder_(recorder),
        stride_(world.lanes.lane_stride()) {}

  void start_batch() {
    b_.shadow_jobs.clear();
    b_.shadow_data.clear();
    b_.shadow_rays.clear();
    b_.shadow_packets.clear();
  }

  /// Notes the light of every lamp on the lanes that lie in the buffers' interaction, to be
  /// resolved with the batch.
  void send(const Fan& fan, const LaneMask& lanes, const SurfaceMaterial& material,
            const BoundaryRows& rows, const Shading& shading, bool rough,
            std::uint32_t record_number) {
    const D d;
    const int set = samples_[fan.sample].set;
    const float fog_per_m = world_.fog && fan.media.empty() ? world_.fog->extinction_per_m : 0.0f;
    for (const WorldLight& light : world_.lights) {
      StraightLight(d, stride_, light, world_.row(light.row, set), b_.at.position, to_light_);
      if (fog_per_m > 0.0f && HasDistance(light)) {
        FogAttenuate(d, stride_, fog_per_m, to_light_.distance_m, to_light_.irradiance);
      }
      ShadowJob job;
      job.ends_at_glass = light.has_chains;
      if (!begin_job(fan, lanes, material, rows, shading, rough, record_number, job)) continue;
      if (!fan.spread) {
        job.first_query = static_cast<std::uint32_t>(b_.shadow_rays.size());
        b_.shadow_rays.push_back(shadow_ray(0));
        ++stats_.shadow_rays;
      } else {
        add_shadow_packets(job);
      }
      b_.shadow_jobs.push_back(job);
    }
    if (!world_.chains.empty())
      send_chains(fan, lanes, material, rows, shading, rough, record_number);
  }

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
        if (!begin_fog_job(fan, lanes, true, job)) continue;
        b_.shadow_jobs.push_back(job);
        add_gates(chain, job);
      }
    }
  }

  /// All shadow rays of the batch, and the light they let through, also by its parts where there is
  /// room for them.
  void resolve(std::span<float> light_parts) {
    if (b_.shadow_jobs.empty()) return;
    b_.shadow_ray_occluded.resize(b_.shadow_rays.size());
    b_.shadow_packet_occluded.resize(b_.shadow_packets.size());
    if (!b_.shadow_rays.empty()) {
      world_.tree.any_hits(std::span<const Ray>(b_.shadow_rays), kOpaqueBit,
                           std::span<std::uint8_t>(b_.shadow_ray_occluded));
    }
    if (!b_.shadow_packets.empty()) {
      world_.tree.any_hits(std::span<const RayPacket>(b_.shadow_packets), kOpaqueBit,
                           std::span<std::uint32_t>(b_.shadow_packet_occluded));
    }
    for (const ShadowJob& job : b_.shadow_jobs) {
      float* visibility = b_.shadow_data.data() + job.data + stride_;
      for (int lane = 0; lane < stride_; ++lane) {
        const bool blocked =
            job.spread ? (b_.shadow_packet_occluded[job.first_query + lane / kPacketLanes] >>
                          (lane % kPacketLanes)) &
                             1u
                       : b_.shadow_ray_occluded[job.first_query] != 0;
        visibility[lane] = blocked ? 0.0f : 1.0f;
      }
    }
    if (world_.has_transparent) attenuate_by_transparent(world_, samples_, b_, stats_);
    const D d;
    for (const ShadowJob& gate : b_.shadow_jobs) {
      if (!gate.gate_of) continue;
      const float* open = b_.shadow_data.data() + gate.data + stride_;
      float* visibility = b_.shadow_data.data() + *gate.gate_of + stride_;
      for (int lane = 0; lane < stride_; ++lane) visibility[lane] *= open[lane];
    }
    for (const ShadowJob& job : b_.shadow_jobs) {
      if (job.gate_of) continue;
      const float* light = b_.shadow_data.data() + job.data;
      const float* visibility = light + stride_;
      float* sum = b_.direct_light.data() + static_cast<std::size_t>(job.sample) * stride_;
      for (int i = 0; i < stride_; i += static_cast<int>(hn::Lanes(d))) {
        const auto arrived = hn::Mul(hn::LoadU(d, light + i), hn::LoadU(d, visibility + i));
        hn::StoreU(hn::Add(hn::LoadU(d, sum + i), arrived), d, sum + i);
      }
      if (!light_parts.empty()) {
        float* part = part_of(light_parts, job.sample, job.first_turn, LightPart::Direct, stride_);
        for (int lane = 0; lane < stride_; ++lane) part[lane] += light[lane] * visibility[lane];
      }
      const auto lanes = static_cast<std::size_t>(stride_);
      recorder_.add_direct_light(job.record, {light, lanes}, {visibility, lanes});
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
    if (!begin_fog_job(fan, lanes, fan.spread, job)) return;
    job.ends_at_glass = light.has_chains;
    b_.shadow_jobs.push_back(job);
  }

  bool begin_fog_job(const Fan& fan, const LaneMask& lanes, bool spread, ShadowJob& job) {
    const D d;
    job.data = static_cast<std::uint32_t>(b_.shadow_data.size());
    b_.shadow_data.resize(job.data + 2 * static_cast<std::size_t>(stride_), 1.0f);
    float* light = b_.shadow_data.data() + job.data;
    for (int i = 0; i < stride_; i += static_cast<int>(hn::Lanes(d))) {
      const auto value =
          hn::Mul(hn::Load(d, fog_.scattered.v + i), hn::Load(d, to_light_.irradiance.v + i));
      hn::StoreU(value, d, light + i);
      SetLanesFrom(d, hn::Gt(value, hn::Zero(d)), i, job.lanes);
    }
    job.lanes = job.lanes & lanes;
    if (!job.lanes.any()) {
      b_.shadow_data.resize(job.data);
      return false;
    }
    job.sample = fan.sample;
    job.spread = spread;
    job.first_turn = fan.first_turn;
    job.ends_at_glass = true;
    const auto ray_of = [&](int lane) {
      Ray ray;
      ray.origin = fog_.places.get(lane);
      ray.direction = to_light_.direction.get(lane);
      ray.t_max = to_light_.distance_m[lane];
      return ray;
    };
    if (!spread) {
      job.first_query = static_cast<std::uint32_t>(b_.shadow_rays.size());
      b_.shadow_rays.push_back(ray_of(job.lanes.front()));
      ++stats_.shadow_rays;
      return true;
    }
    job.first_query = static_cast<std::uint32_t>(b_.shadow_packets.size());
    for (int block = 0; block * kPacketLanes < stride_; ++block) {
      RayPacket& packet = b_.shadow_packets.emplace_back();
      packet.active = job.lanes.block16(block);
      for (int i = 0; i < kPacketLanes; ++i) {
        set_ray(packet, i, ray_of(std::min(block * kPacketLanes + i, stride_ - 1)));
      }
    }
    stats_.shadow_rays += static_cast<std::uint64_t>(job.lanes.count());
    return true;
  }

  // Room for the light of a lamp and what it adds; false when no lane gets any.
  bool begin_job(const Fan& fan, const LaneMask& lanes, const SurfaceMaterial& material,
                 const BoundaryRows& rows, const Shading& shading, bool rough,
                 std::uint32_t record_number, ShadowJob& job) {
    const D d;
    job.data = static_cast<std::uint32_t>(b_.shadow_data.size());
    b_.shadow_data.resize(job.data + 2 * static_cast<std::size_t>(stride_), 1.0f);
    float* contribution = b_.shadow_data.data() + job.data;
    if (ReflectLight(d, stride_, rows, material.index_is_infinite, rough, b_.at, shading, to_light_,
                     contribution)) {
      for (int i = 0; i < stride_; i += static_cast<int>(hn::Lanes(d))) {
        SetLanesFrom(d, hn::Ne(hn::LoadU(d, contribution + i), hn::Zero(d)), i, job.lanes);
      }
      job.lanes = job.lanes & lanes;
    }
    if (!job.lanes.any()) {
      b_.shadow_data.resize(job.data);
      return false;
    }
    job.sample = fan.sample;
    job.record = record_number;
    job.media = fan.media;
    job.spread = fan.spread;
    job.first_turn = fan.first_turn;
    return true;
  }

  void send_chains(const Fan& fan, const LaneMask& lanes, const SurfaceMaterial& material,
                   const BoundaryRows& rows, const Shading& shading, bool rough,
                   std::uint32_t record_number) {
    const D d;
    const int set = samples_[fan.sample].set;
    const Vec3f center = b_.at.position.get(lanes.front());
    float radius_m = 0.0f;
    if (fan.spread) {
      for (int lane = 0; lane < world_.lanes.lane_count(); ++lane) {
        if (lanes.test(lane)) {
          radius_m = std::max(radius_m, glm::distance(center, b_.at.position.get(lane)));
        }
      }
    }
    for (const Chain& chain : world_.chains) {
      if (!may_light(chain, center, radius_m)) continue;
      if (chain.ends_inside &&
          (fan.media.empty() || fan.media.top() != chain.steps.back().material)) {
        continue;
      }
      if (!LightOnChain(d, world_, chain, set, b_.at.position, to_light_, way_)) continue;
      ShadowJob job;
      if (!begin_job(fan, lanes, material, rows, shading, rough, record_number, job)) continue;
      job.spread = true;
      job.ends_at_glass = true;
      add_shadow_packets(job);
      b_.shadow_jobs.push_back(job);
      add_gates(chain, job);
    }
  }

  // The parts of a chain's way before its last facet on which something may stand.
  void add_gates(const Chain& chain, const ShadowJob& main) {
    const WorldLight& light = world_.lights[chain.light];
    for (std::size_t s = 0; s < chain.steps.size(); ++s) {
      // The way that ends at step s.
      const ChainStep& step = chain.steps[s];
      const bool inside =
          step.event == ChainEvent::Leave || step.event == ChainEvent::ReflectInside;
      if (inside && !step.is_checked) continue;
      ShadowJob gate;
      gate.sample = main.sample;
      gate.lanes = main.lanes;
      gate.spread = true;
      gate.ends_at_glass = true;
      gate.gate_of = main.data;
      if (inside) gate.media.push(step.material);
      gate.data = static_cast<std::uint32_t>(b_.shadow_data.size());
      b_.shadow_data.resize(gate.data + 2 * static_cast<std::size_t>(stride_), 1.0f);
      gate.first_query = static_cast<std::uint32_t>(b_.shadow_packets.size());
      for (int block = 0; block * kPacketLanes < stride_; ++block) {
        RayPacket& packet = b_.shadow_packets.emplace_back();
        packet.active = gate.lanes.block16(block);
        for (int i = 0; i < kPacketLanes; ++i) {
          const int lane = std::min(block * kPacketLanes + i, stride_ - 1);
          set_ray(packet, i, gate_ray(chain, light, s, lane));
        }
      }
      stats_.shadow_rays += static_cast<std::uint64_t>(gate.lanes.count());
      b_.shadow_jobs.push_back(gate);
    }
  }

  // Backwards from the facet of step s to the one before it, or to the light.
  Ray gate_ray(const Chain& chain, const WorldLight& light, std::size_t s, int lane) const {
    const Vec3f from = way_.places[s].get(lane) + chain.origin;
    Ray ray;
    if (s > 0) {
      const Vec3f way = way_.places[s - 1].get(lane) + chain.origin - from;
      const float length = glm::length(way);
      ray.direction = length > 0.0f ? way / length : chain.steps[s].normal;
      ray.t_max = length;
    } else if (light.type == LightType::Directional) {
      ray.direction = -light.direction;
      ray.t_max = light.is_beam ? glm::dot(from - light.position, light.direction) : kInfinity;
    } else {
      const Vec3f way = light.position - from;
      ray.t_max = glm::length(way);
      ray.direction = way / ray.t_max;
    }
    const float step_m = way_.slack_m[lane];
    const float side = glm::dot(ray.direction, chain.steps[s].normal) < 0.0f ? -1.0f : 1.0f;
    ray.origin = from + side * step_m * chain.steps[s].normal;
    ray.t_max = std::max(0.0f, ray.t_max - (s > 0 ? 2.0f * step_m : 0.0f));
    return ray;
  }

  static void set_ray(RayPacket& packet, int i, const Ray& ray) {
    packet.origin_x[i] = ray.origin.x;
    packet.origin_y[i] = ray.origin.y;
    packet.origin_z[i] = ray.origin.z;
    packet.direction_x[i] = ray.direction.x;
    packet.direction_y[i] = ray.direction.y;
    packet.direction_z[i] = ray.direction.z;
    packet.t_max[i] = ray.t_max;
  }

  void add_shadow_packets(ShadowJob& job) {
    job.first_query = static_cast<std::uint32_t>(b_.shadow_packets.size());
    for (int block = 0; block * kPacketLanes < stride_; ++block)
      add_shadow_packet(job.lanes, block);
    stats_.shadow_rays += static_cast<std::uint64_t>(job.lanes.count());
  }

  // From just off the surface, on the side of the light, up to the light.
  Ray shadow_ray(int lane) const {
    const Vec3f direction = to_light_.direction.get(lane);
    const Vec3f outward = b_.at.outward.get(lane);
    const float side = glm::dot(direction, outward) < 0.0f ? -1.0f : 1.0f;
    const float offset_m = b_.at.offset_m[lane];
    Ray ray;
    ray.origin = b_.at.position.get(lane) + (side * offset_m) * outward;
    ray.direction = direction;
    // The start has come nearer to the light by this much, which counts where a facet is the end.
    ray.t_max = to_light_.distance_m[lane] - side * offset_m * glm::dot(outward, direction);
    return ray;
  }

  void add_shadow_packet(const LaneMask& lanes, int block) {
    RayPacket& packet = b_.shadow_packets.emplace_back();
    packet.active = lanes.block16(block);
    for (int i = 0; i < kPacketLanes; ++i) {
      set_ray(packet, i, shadow_ray(std::min(block * kPacketLanes + i, stride_ - 1)));
    }
  }

  const World& world_;
  std::span<const CameraSample> samples_;
  IntegratorStats& stats_;
  IntegratorScratch::Buffers& b_;
  FanRecorder& recorder_;
  const int stride_;
  LightGeometry to_light_;
  ChainWay way_;
  FogWork fog_;
};

}  // namespace HWY_NAMESPACE
}  // namespace abbe
HWY_AFTER_NAMESPACE();

#endif  // ABBE_INTEGRATE_DIRECT_LIGHT_INL_H_
