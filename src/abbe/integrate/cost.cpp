#include "abbe/integrate/cost.h"

namespace abbe {

void count_fan_cost(const World& world, const FanList& list, std::size_t first, std::size_t last,
                    std::span<FirstHit> first_hits) {
  const int stride = world.lanes.lane_stride();
  for (std::size_t i = first; i < last; ++i) {
    const Fan& fan = list.fans[i];
    QueryCost& cost = first_hits[fan.sample].cost;
    if (!fan.spread) {
      const Ray ray{fan.origin, kInfinity, fan.direction};
      world.accelerator->closest_hit_with_cost(ray, kAllBits | kCullBack, cost);
      continue;
    }
    const auto lane_vector = [&](int first_array, int lane) {
      const float* p = list.pool.data() + fan.data + first_array * stride + lane;
      return Vec3f(p[0], p[stride], p[2 * stride]);
    };
    for (int lane = 0; lane < world.lanes.lane_count(); ++lane) {
      if (!fan.lanes.test(lane)) continue;
      const Ray ray{lane_vector(1, lane), kInfinity, lane_vector(4, lane)};
      world.accelerator->closest_hit_with_cost(ray, kAllBits | kCullBack, cost);
    }
  }
}

void count_shadow_cost(const World& world, const ShadowBuffers& buffers,
                       std::span<FirstHit> first_hits) {
  for (const ShadowJob& job : buffers.jobs) {
    QueryCost& cost = first_hits[job.sample].cost;
    const ShadowQueries& queries = buffers.queries_of(job);
    const auto blocking = static_cast<QueryMask>(blocking_bits(job.at_glass) | kCullFront);
    if (!job.spread) {
      world.accelerator->any_hit_with_cost(queries.rays[job.first_query], blocking, cost);
      continue;
    }
    for (int lane = 0; lane < world.lanes.lane_count(); ++lane) {
      if (!job.lanes.test(lane)) continue;
      const auto block = static_cast<std::uint32_t>(lane / kPacketLanes);
      const Ray ray = ray_of(queries.packets[job.first_query + block], lane % kPacketLanes);
      world.accelerator->any_hit_with_cost(ray, blocking, cost);
    }
  }
}

}  // namespace abbe
