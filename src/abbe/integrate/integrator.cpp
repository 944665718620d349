#include "abbe/integrate/integrator.h"

#include <algorithm>

#include "abbe/integrate/buffers.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "abbe/integrate/integrator.cpp"
#include <hwy/foreach_target.h>

#include "abbe/integrate/tracer-inl.h"

#if HWY_ONCE
namespace abbe {

HWY_EXPORT(TraceSamples);

void IntegratorStats::add(const IntegratorStats& other) {
  camera_rays += other.camera_rays;
  reflected_rays += other.reflected_rays;
  refracted_rays += other.refracted_rays;
  passed_rays += other.passed_rays;
  shadow_rays += other.shadow_rays;
  united_fans += other.united_fans;
  spread_fans += other.spread_fans;
  for (std::size_t depth = 0; depth < kDepths; ++depth) {
    spread_fans_at[depth] += other.spread_fans_at[depth];
    spread_lanes_at[depth] += other.spread_lanes_at[depth];
  }
  peak_queued_fans = std::max(peak_queued_fans, other.peak_queued_fans);
  peak_queue_bytes = std::max(peak_queue_bytes, other.peak_queue_bytes);
  bent_light_seconds += other.bent_light_seconds;
  weight_started += other.weight_started;
  weight_lost_to_depth += other.weight_lost_to_depth;
  weight_lost_to_cutoff += other.weight_lost_to_cutoff;
}

IntegratorScratch::IntegratorScratch() : buffers_(std::make_unique<Buffers>()) {}
IntegratorScratch::IntegratorScratch(IntegratorScratch&&) noexcept = default;
IntegratorScratch::~IntegratorScratch() = default;

void trace_samples(const LitWorld& world, const IntegratorSettings& settings,
                   std::span<const CameraSample> samples, const SampleResults& results,
                   IntegratorStats& stats, IntegratorScratch& scratch) {
  HWY_DYNAMIC_DISPATCH(TraceSamples)
  (world, settings, samples, results, stats, scratch.buffers());
}

}  // namespace abbe
#endif  // HWY_ONCE
