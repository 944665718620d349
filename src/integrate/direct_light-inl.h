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
#include "integrate/integrator.h"
#include "integrate/passage.h"
#include "integrate/recorder.h"
#include "integrate/shade-inl.h"

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
    for (const WorldLight& light : world_.lights) {
      const std::uint32_t data = static_cast<std::uint32_t>(b_.shadow_data.size());
      b_.shadow_data.resize(data + 2 * static_cast<std::size_t>(stride_), 1.0f);
      if (!LightLanes(d, stride_, light, world_.row(light.row, set), rows,
                      material.index_is_infinite, rough, b_.at, shading, to_light_,
                      b_.shadow_data.data() + data)) {
        b_.shadow_data.resize(data);
        continue;
      }
      ShadowJob job;
      job.sample = fan.sample;
      job.data = data;
      job.record = record_number;
      job.media = fan.media;
      job.spread = fan.spread;
      job.first_turn = fan.first_turn;
      const float* contribution = b_.shadow_data.data() + data;
      for (int lane = 0; lane < world_.lanes.lane_count(); ++lane) {
        if (lanes.test(lane) && contribution[lane] != 0.0f) job.lanes.set(lane);
      }
      if (!job.lanes.any()) {
        b_.shadow_data.resize(data);
        continue;
      }
      if (!fan.spread) {
        job.first_query = static_cast<std::uint32_t>(b_.shadow_rays.size());
        b_.shadow_rays.push_back(shadow_ray(0));
        ++stats_.shadow_rays;
      } else {
        job.first_query = static_cast<std::uint32_t>(b_.shadow_packets.size());
        for (int block = 0; block * kPacketLanes < stride_; ++block) {
          add_shadow_packet(job.lanes, block);
        }
        stats_.shadow_rays += static_cast<std::uint64_t>(job.lanes.count());
      }
      b_.shadow_jobs.push_back(job);
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
    for (const ShadowJob& job : b_.shadow_jobs) {
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
  // From just off the surface, on the side of the light, up to the light.
  Ray shadow_ray(int lane) const {
    const Vec3f direction = to_light_.direction.get(lane);
    const Vec3f outward = b_.at.outward.get(lane);
    const float side = glm::dot(direction, outward) < 0.0f ? -1.0f : 1.0f;
    const float offset_m = b_.at.offset_m[lane];
    Ray ray;
    ray.origin = b_.at.position.get(lane) + (side * offset_m) * outward;
    ray.direction = direction;
    ray.t_max = to_light_.distance_m[lane];
    return ray;
  }

  void add_shadow_packet(const LaneMask& lanes, int block) {
    RayPacket& packet = b_.shadow_packets.emplace_back();
    packet.active = lanes.block16(block);
    for (int i = 0; i < kPacketLanes; ++i) {
      const Ray ray = shadow_ray(std::min(block * kPacketLanes + i, stride_ - 1));
      packet.origin_x[i] = ray.origin.x;
      packet.origin_y[i] = ray.origin.y;
      packet.origin_z[i] = ray.origin.z;
      packet.direction_x[i] = ray.direction.x;
      packet.direction_y[i] = ray.direction.y;
      packet.direction_z[i] = ray.direction.z;
      packet.t_max[i] = ray.t_max;
    }
  }

  const World& world_;
  std::span<const CameraSample> samples_;
  IntegratorStats& stats_;
  IntegratorScratch::Buffers& b_;
  FanRecorder& recorder_;
  const int stride_;
  LightGeometry to_light_;
};

}  // namespace HWY_NAMESPACE
}  // namespace abbe
HWY_AFTER_NAMESPACE();

#endif  // ABBE_INTEGRATE_DIRECT_LIGHT_INL_H_
