#include "bench/embree_rival.h"

#include <embree3/rtcore.h>
#include <time.h>

#include <atomic>
#include <bit>
#include <chrono>
#include <vector>

namespace abbe::bench {

double thread_seconds() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

struct EmbreeScene::State {
  RTCDevice device = nullptr;
  RTCScene scene = nullptr;
  std::atomic<std::ptrdiff_t> bytes{0};
  std::vector<RTCRayHit> one;
  std::vector<RTCRayHit8> eight;
  std::vector<RTCRayHit16> sixteen;
  std::vector<std::int32_t> valid;
};

namespace {

bool count_bytes(void* state, ssize_t bytes, bool) {
  *static_cast<std::atomic<std::ptrdiff_t>*>(state) += bytes;
  return true;
}

// One lane of Embree's packet of any width.
template <typename RayHit>
void set_lane(RayHit& out, int lane, const RayPacket& in, int from) {
  const bool is_active = (in.active >> from & 1u) != 0;
  out.ray.org_x[lane] = in.origin_x[from];
  out.ray.org_y[lane] = in.origin_y[from];
  out.ray.org_z[lane] = in.origin_z[from];
  out.ray.dir_x[lane] = in.direction_x[from];
  out.ray.dir_y[lane] = in.direction_y[from];
  out.ray.dir_z[lane] = in.direction_z[from];
  out.ray.tnear[lane] = 0.0f;
  out.ray.tfar[lane] = is_active ? in.t_max[from] : -1.0f;
  out.ray.time[lane] = 0.0f;
  out.ray.mask[lane] = ~0u;
  out.ray.id[lane] = 0;
  out.ray.flags[lane] = 0;
  out.hit.geomID[lane] = RTC_INVALID_GEOMETRY_ID;
  out.hit.instID[0][lane] = RTC_INVALID_GEOMETRY_ID;
}

RTCRayHit one_ray(const RayPacket& in, int from) {
  RTCRayHit out{};
  out.ray = {in.origin_x[from],
             in.origin_y[from],
             in.origin_z[from],
             0.0f,
             in.direction_x[from],
             in.direction_y[from],
             in.direction_z[from],
             0.0f,
             in.t_max[from],
             ~0u,
             0,
             0};
  out.hit.geomID = RTC_INVALID_GEOMETRY_ID;
  out.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
  return out;
}

}  // namespace

EmbreeScene::EmbreeScene(const BenchScene& scene, bool robust) : state_(std::make_unique<State>()) {
  state_->device = rtcNewDevice(nullptr);
  rtcSetDeviceMemoryMonitorFunction(state_->device, count_bytes, &state_->bytes);
  state_->scene = rtcNewScene(state_->device);
  rtcSetSceneBuildQuality(state_->scene, RTC_BUILD_QUALITY_HIGH);
  if (robust) rtcSetSceneFlags(state_->scene, RTC_SCENE_FLAG_ROBUST);
  const RTCGeometry mesh = rtcNewGeometry(state_->device, RTC_GEOMETRY_TYPE_TRIANGLE);
  rtcSetSharedGeometryBuffer(mesh, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3,
                             scene.positions.data(), 0, sizeof(Vec3f), scene.positions.size());
  rtcSetSharedGeometryBuffer(mesh, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3,
                             scene.triangles.data(), 0, sizeof(Triangle), scene.triangles.size());
  rtcCommitGeometry(mesh);
  rtcAttachGeometry(state_->scene, mesh);
  rtcReleaseGeometry(mesh);
  const auto start = std::chrono::steady_clock::now();
  rtcCommitScene(state_->scene);
  build_seconds_ = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

EmbreeScene::~EmbreeScene() {
  rtcReleaseScene(state_->scene);
  rtcReleaseDevice(state_->device);
}

std::size_t EmbreeScene::bytes() const {
  const std::ptrdiff_t bytes = state_->bytes;
  return bytes > 0 ? static_cast<std::size_t>(bytes) : 0;
}

double EmbreeScene::trace(const RaySet& set, std::size_t first, std::size_t last, int lanes) {
  State& s = *state_;
  s.one.clear();
  s.eight.clear();
  s.sixteen.clear();
  s.valid.clear();
  for (std::size_t p = first; p < last; ++p) {
    const RayPacket& packet = set.packets[p];
    if (lanes == 16) s.sixteen.emplace_back();
    if (lanes == 8) s.eight.resize(s.eight.size() + 2);
    for (int lane = 0; lane < kPacketLanes; ++lane) {
      const bool is_active = (packet.active >> lane & 1u) != 0;
      if (lanes == 16) set_lane(s.sixteen.back(), lane, packet, lane);
      if (lanes == 8) set_lane(*(s.eight.end() - 2 + lane / 8), lane % 8, packet, lane);
      if (lanes == 1 && is_active) s.one.push_back(one_ray(packet, lane));
      s.valid.push_back(is_active ? -1 : 0);
    }
  }
  // Embree wants the masks of a packet aligned to its width.
  alignas(64) std::int32_t valid[16];
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  context.flags =
      set.is_coherent ? RTC_INTERSECT_CONTEXT_FLAG_COHERENT : RTC_INTERSECT_CONTEXT_FLAG_INCOHERENT;
  const double start = thread_seconds();
  for (RTCRayHit& ray : s.one) {
    set.is_occlusion ? rtcOccluded1(s.scene, &context, &ray.ray)
                     : rtcIntersect1(s.scene, &context, &ray);
  }
  for (std::size_t i = 0; i < s.eight.size(); ++i) {
    std::copy_n(s.valid.begin() + static_cast<std::ptrdiff_t>(i * 8), 8, valid);
    set.is_occlusion ? rtcOccluded8(valid, s.scene, &context, &s.eight[i].ray)
                     : rtcIntersect8(valid, s.scene, &context, &s.eight[i]);
  }
  for (std::size_t i = 0; i < s.sixteen.size(); ++i) {
    std::copy_n(s.valid.begin() + static_cast<std::ptrdiff_t>(i * 16), 16, valid);
    set.is_occlusion ? rtcOccluded16(valid, s.scene, &context, &s.sixteen[i].ray)
                     : rtcIntersect16(valid, s.scene, &context, &s.sixteen[i]);
  }
  const double seconds = thread_seconds() - start;
  hits_ = 0;
  const auto is_hit = [&](float t_far, unsigned id) {
    return set.is_occlusion ? t_far == -kInfinity : id != RTC_INVALID_GEOMETRY_ID;
  };
  for (const RTCRayHit& r : s.one) hits_ += is_hit(r.ray.tfar, r.hit.geomID) ? 1 : 0;
  for (std::size_t i = 0; i < s.valid.size() && lanes > 1; ++i) {
    if (s.valid[i] == 0) continue;
    if (lanes == 8) {
      hits_ += is_hit(s.eight[i / 8].ray.tfar[i % 8], s.eight[i / 8].hit.geomID[i % 8]) ? 1 : 0;
    } else {
      const RTCRayHit16& r = s.sixteen[i / 16];
      hits_ += is_hit(r.ray.tfar[i % 16], r.hit.geomID[i % 16]) ? 1 : 0;
    }
  }
  return seconds;
}

}  // namespace abbe::bench
