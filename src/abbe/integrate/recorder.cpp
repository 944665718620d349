#include "abbe/integrate/recorder.h"

#include <cmath>
#include <cstddef>
#include <utility>

namespace abbe {
namespace {

// Exact for small angles too, where the cosine has lost them.
float angle_between(const Vec3f& a, const Vec3f& b) {
  const Vec3d x(a);
  const Vec3d y(b);
  return static_cast<float>(std::atan2(glm::length(glm::cross(x, y)), glm::dot(x, y)));
}

}  // namespace

float FanRecorder::wavelength_nm(const Fan& fan, int lane) const {
  return world_.lanes.wavelength_nm(samples_[fan.sample].set, lane);
}

void FanRecorder::miss(const Fan& fan, const FanList& list, const LaneMask& missed) {
  if (records_ == nullptr) return;
  FanRecord record;
  record.parent = fan.parent_record;
  record.made_by = fan.made_by;
  record.was_spread = fan.spread;
  record.depth = fan.depth;
  record.weight = fan.weight;
  const int stride = world_.lanes.lane_stride();
  const float* pool = list.pool.data() + fan.data;
  const auto lane_vector = [&](int first_array, int lane) {
    const float* p = pool + first_array * stride + lane;
    return Vec3f(p[0], p[stride], p[2 * stride]);
  };
  for (int lane = 0; lane < world_.lanes.lane_count(); ++lane) {
    if (!missed.test(lane)) continue;
    LaneRecord& entry = record.lanes.emplace_back();
    entry.lane = lane;
    entry.wavelength_nm = wavelength_nm(fan, lane);
    entry.position = fan.spread ? lane_vector(1, lane) : fan.origin;
    entry.direction = fan.spread ? lane_vector(4, lane) : fan.direction;
    entry.throughput = pool[lane];
  }
  records_->push_back(std::move(record));
}

std::uint32_t FanRecorder::arrive(const Fan& fan, const SurfaceHit& hit,
                                  const LaneArray& throughput) {
  if (records_ == nullptr) return 0;
  FanRecord& record = records_->emplace_back();
  record.parent = fan.parent_record;
  record.made_by = fan.made_by;
  record.was_spread = fan.spread;
  record.depth = fan.depth;
  record.weight = fan.weight;
  record.is_hit = true;
  record.enters = hit.front;
  record.surface = hit.surface;
  for (int lane = 0; lane < world_.lanes.lane_count(); ++lane) {
    if (!hit.lanes.test(lane)) continue;
    LaneRecord& entry = record.lanes.emplace_back();
    entry.lane = lane;
    entry.wavelength_nm = wavelength_nm(fan, lane);
    entry.position = hit.position.get(lane);
    entry.direction = hit.direction.get(lane);
    entry.normal = hit.normal.get(lane);
    entry.throughput = throughput[lane];
  }
  return static_cast<std::uint32_t>(records_->size());
}

void FanRecorder::shade(std::uint32_t record_number, const MediumChange& change,
                        const BoundaryRows& rows, const SurfaceHit& hit, const MaterialLanes& at,
                        const SurfaceAnswer& answer) {
  if (record_number == 0) return;
  const Lobe* reflection = answer.lobe(FanOrigin::Reflected);
  const Lobe* refraction = answer.lobe(FanOrigin::Refracted);
  for (LaneRecord& entry : (*records_)[record_number - 1].lanes) {
    const int lane = entry.lane;
    const Vec3f normal = hit.normal.get(lane);
    entry.angle_incident_rad = angle_between(-hit.direction.get(lane), normal);
    entry.n_incident = rows.n_incident != nullptr ? rows.n_incident[lane] : 1.0f;
    entry.n_transmitted = rows.n_transmitted != nullptr ? rows.n_transmitted[lane] : 1.0f;
    entry.k_r = reflection != nullptr ? reflection->share[lane] : 0.0f;
    entry.k_t = refraction != nullptr ? refraction->share[lane] : 0.0f;
    if (refraction != nullptr && entry.k_t > 0.0f && !change.goes_straight()) {
      entry.angle_refracted_rad = angle_between(refraction->direction.get(lane), -normal);
    }
    entry.local_light = at.emission[lane];
  }
}

void FanRecorder::add_direct_light(std::uint32_t record, std::span<const float> light,
                                   std::span<const float> visibility) {
  if (records_ == nullptr || record == 0) return;
  const int lane_count = world_.lanes.lane_count();
  float total = 0.0f;
  for (std::size_t lane = 0; lane < static_cast<std::size_t>(lane_count); ++lane) {
    total += light[lane] * visibility[lane];
  }
  (*records_)[record - 1].direct_light += total / static_cast<float>(lane_count);
}

}  // namespace abbe
