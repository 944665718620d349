/// What stands between lamps and the places they light. Highway code, compiled once per instruction
/// set.

#if defined(ABBE_INTEGRATE_LIGHT_SHADOW_QUEUE_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef ABBE_INTEGRATE_LIGHT_SHADOW_QUEUE_INL_H_
#undef ABBE_INTEGRATE_LIGHT_SHADOW_QUEUE_INL_H_
#else
#define ABBE_INTEGRATE_LIGHT_SHADOW_QUEUE_INL_H_
#endif

#include <algorithm>
#include <bit>
#include <cstdint>
#include <span>

#include "abbe/integrate/integrator.h"
#include "abbe/integrate/light/shadow_jobs.h"
#include "abbe/integrate/light/transmittance.h"
#include "abbe/integrate/recorder.h"
#include "abbe/math/lanes-inl.h"

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

/// Light that waits to know what blocks it: the shadow rays of one batch.
template <class D>
class ShadowQueue {
 public:
  ShadowQueue(const World& world, std::span<const CameraSample> samples, IntegratorStats& stats,
              ShadowBuffers& buffers, FanRecorder& recorder)
      : world_(world),
        samples_(samples),
        stats_(stats),
        b_(buffers),
        recorder_(recorder),
        stride_(world.lanes.lane_stride()) {}

  void start_batch() {
    b_.jobs.clear();
    b_.data.clear();
    for (ShadowQueries& queries : b_.queries) {
      queries.rays.clear();
      queries.ray_lamps.clear();
      queries.packets.clear();
    }
  }

  /// Room for the light of a job, per lane; its visibility starts at 1.
  float* reserve(ShadowJob& job) {
    job.data = static_cast<std::uint32_t>(b_.data.size());
    b_.data.resize(job.data + 2 * static_cast<std::size_t>(stride_), 1.0f);
    return b_.data.data() + job.data;
  }

  /// Keeps the lanes of `among` that the job's light is anything in; without any, gives its room
  /// back and returns false.
  bool keep_lit(ShadowJob& job, const LaneMask& among) {
    const D d;
    const float* light = b_.data.data() + job.data;
    for (int i = 0; i < stride_; i += static_cast<int>(hn::Lanes(d))) {
      SetLanesFrom(d, hn::Ne(hn::LoadU(d, light + i), hn::Zero(d)), i, job.lanes);
    }
    job.lanes = job.lanes & among;
    if (!job.lanes.any()) b_.data.resize(job.data);
    return job.lanes.any();
  }

  /// Asks what blocks a job: ray_of(lane) is its shadow ray, one for all lanes or, where
  /// job.spread, one for each. A lamp is given where the next such ray to it is a neighbour.
  template <class RayOf>
  void add(ShadowJob& job, RayOf&& ray_of, std::uint32_t lamp = kIncoherent) {
    ShadowQueries& queries = b_.queries_of(job);
    if (!job.spread) {
      job.first_query = static_cast<std::uint32_t>(queries.rays.size());
      queries.rays.push_back(ray_of(job.lanes.front()));
      queries.ray_lamps.push_back(lamp);
      ++stats_.shadow_rays;
    } else {
      job.first_query = static_cast<std::uint32_t>(queries.packets.size());
      for (int block = 0; block * kPacketLanes < stride_; ++block) {
        RayPacket& packet = queries.packets.emplace_back();
        packet.active = job.lanes.block16(block);
        for (int i = 0; i < kPacketLanes; ++i) {
          set_ray(packet, i, ray_of(std::min(block * kPacketLanes + i, stride_ - 1)));
        }
      }
      stats_.shadow_rays += static_cast<std::uint64_t>(job.lanes.count());
    }
    b_.jobs.push_back(job);
  }

  /// A job with the shadow rays of one that was added, for the same lanes.
  void add_beside(const ShadowJob& other, ShadowJob& job) {
    job.first_query = other.first_query;
    b_.jobs.push_back(job);
  }

  /// All shadow rays of the batch, and the light they let through, also by its parts where there is
  /// room for them.
  void resolve(std::span<float> light_parts) {
    if (b_.jobs.empty()) return;
    for (std::size_t rule = 0; rule < kAtGlassRules; ++rule) {
      ask(b_.queries[rule], blocking_bits(static_cast<AtGlass>(rule)));
    }
    for (const ShadowJob& job : b_.jobs) {
      const ShadowQueries& queries = b_.queries_of(job);
      float* visibility = b_.data.data() + job.data + stride_;
      for (int lane = 0; lane < stride_; ++lane) {
        const bool blocked =
            job.spread ? (queries.packet_occluded[job.first_query + lane / kPacketLanes] >>
                          (lane % kPacketLanes)) &
                             1u
                       : queries.ray_occluded[job.first_query] != 0;
        visibility[lane] = blocked ? 0.0f : 1.0f;
      }
    }
    attenuate_by_transparent(world_, samples_, b_, stats_);
    const D d;
    for (const ShadowJob& gate : b_.jobs) {
      if (!gate.gate_of) continue;
      const float* open = b_.data.data() + gate.data + stride_;
      float* visibility = b_.data.data() + *gate.gate_of + stride_;
      for (int lane = 0; lane < stride_; ++lane) visibility[lane] *= open[lane];
    }
    for (const ShadowJob& job : b_.jobs) {
      if (job.gate_of) continue;
      const float* light = b_.data.data() + job.data;
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
  void ask(ShadowQueries& queries, VisibilityMask blocking) const {
    ask(queries.packets, blocking, queries.packet_occluded);
    const auto is_coherent = [](std::uint32_t lamp) { return lamp != kIncoherent; };
    if (!std::any_of(queries.ray_lamps.begin(), queries.ray_lamps.end(), is_coherent)) {
      return ask(queries.rays, blocking, queries.ray_occluded);
    }
    CoherentShadowRays& coherent = b_.coherent;
    coherent.sort(queries.rays, queries.ray_lamps, world_.lights.size());
    ask(coherent.packets, blocking, coherent.packet_occluded);
    ask(coherent.others, blocking, coherent.other_occluded);
    queries.ray_occluded.resize(queries.rays.size());
    for (std::size_t p = 0; p < coherent.packets.size(); ++p) {
      for (std::uint32_t lanes = coherent.packets[p].active; lanes != 0; lanes &= lanes - 1) {
        const auto lane = static_cast<std::size_t>(std::countr_zero(lanes));
        queries.ray_occluded[coherent.numbers[p * kPacketLanes + lane]] =
            static_cast<std::uint8_t>((coherent.packet_occluded[p] >> lane) & 1u);
      }
    }
    for (std::size_t i = 0; i < coherent.others.size(); ++i) {
      queries.ray_occluded[coherent.other_numbers[i]] = coherent.other_occluded[i];
    }
  }

  template <class Query, class Answer>
  void ask(const std::vector<Query>& queries, VisibilityMask blocking,
           std::vector<Answer>& occluded) const {
    occluded.resize(queries.size());
    if (queries.empty()) return;
    // Rays begin where light arrives.
    const auto mask = static_cast<QueryMask>(blocking | kCullFront);
    world_.accelerator->any_hits(std::span<const Query>(queries), mask,
                                 std::span<Answer>(occluded));
  }

  const World& world_;
  std::span<const CameraSample> samples_;
  IntegratorStats& stats_;
  ShadowBuffers& b_;
  FanRecorder& recorder_;
  const int stride_;
};

}  // namespace HWY_NAMESPACE
}  // namespace abbe
HWY_AFTER_NAMESPACE();

#endif  // ABBE_INTEGRATE_LIGHT_SHADOW_QUEUE_INL_H_
