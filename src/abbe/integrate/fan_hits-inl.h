/// Hits of the fans of a batch. Highway code, compiled once per instruction set.

#if defined(ABBE_INTEGRATE_FAN_HITS_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef ABBE_INTEGRATE_FAN_HITS_INL_H_
#undef ABBE_INTEGRATE_FAN_HITS_INL_H_
#else
#define ABBE_INTEGRATE_FAN_HITS_INL_H_
#endif

#include <hwy/cache_control.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <span>

#include "abbe/integrate/buffers.h"
#include "abbe/integrate/surface/point_lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace abbe {
namespace HWY_NAMESPACE {

/// Where the fans of a batch meet surfaces, and which lanes of a spread fan go on together.
template <class D>
class FanHits {
 public:
  FanHits(const World& world, IntegratorScratch::Buffers& buffers)
      : world_(world), b_(buffers), stride_(world.lanes.lane_stride()) {}

  /// Asks for the hits of fans [first, last): b_.first_query tells a fan's place in b_.hits, or of
  /// its first packet in b_.packet_hits.
  void find_hits(const FanList& list, std::size_t first, std::size_t last) {
    if (list.fans[first].depth == 0) return find_camera_hits(list, first, last);
    b_.rays.clear();
    b_.packets.clear();
    b_.first_query.clear();
    for (std::size_t i = first; i < last; ++i) {
      const Fan& fan = list.fans[i];
      if (!fan.spread) {
        b_.first_query.push_back(static_cast<std::uint32_t>(b_.rays.size()));
        b_.rays.push_back({fan.origin, kInfinity, fan.direction});
        continue;
      }
      b_.first_query.push_back(static_cast<std::uint32_t>(b_.packets.size()));
      const float* lanes = list.pool.data() + fan.data + stride_;
      for (int block = 0; block * kPacketLanes < stride_; ++block) {
        b_.packets.emplace_back();
        fill_packet(b_.packets.back(), lanes, block, fan);
      }
    }
    b_.hits.resize(b_.rays.size());
    if (!b_.rays.empty()) {
      world_.tree.closest_hits(std::span<const Ray>(b_.rays), kAllBits, std::span<Hit>(b_.hits));
    }
    trace_packets();
  }

  /// Asks for the memory that shading fans [first, last) will read, of which `at` is next. Domain:
  /// after find_hits(), for each of them in turn.
  void fetch_geometry(const FanList& list, std::size_t first, std::size_t last, std::size_t at) {
    if (world_.geometry.triangles.size() < kFewTriangles) return;
    for (std::size_t i = at == first ? at : at + 2 * kFansAhead; i <= at + 2 * kFansAhead; ++i) {
      if (i < last) fetch_triangles(list.fans[i], b_.first_query[i - first]);
    }
    for (std::size_t i = at == first ? at : at + kFansAhead; i <= at + kFansAhead; ++i) {
      if (i < last) fetch_corners(list.fans[i], b_.first_query[i - first]);
    }
  }

  /// Takes up the hits of a spread fan, of which for_each_group then gives the groups.
  void load_hits(const Fan& fan, const FanList& list, std::uint32_t first_packet) {
    const float* pool = list.pool.data() + fan.data;
    float* arrays[6] = {hits_.origin.x.v,    hits_.origin.y.v,    hits_.origin.z.v,
                        hits_.direction.x.v, hits_.direction.y.v, hits_.direction.z.v};
    for (int a = 0; a < 6; ++a) {
      std::copy(pool + (a + 1) * stride_, pool + (a + 2) * stride_, arrays[a]);
    }
    for (int block = 0; block * kPacketLanes < stride_; ++block) {
      const HitPacket& packet = b_.packet_hits[first_packet + block];
      const int begin = block * kPacketLanes;
      std::copy(packet.t, packet.t + kPacketLanes, hits_.t.v + begin);
      std::copy(packet.u, packet.u + kPacketLanes, hits_.u.v + begin);
      std::copy(packet.v, packet.v + kPacketLanes, hits_.v.v + begin);
      std::copy(packet.primitive, packet.primitive + kPacketLanes, hits_.primitive + begin);
    }
  }

  /// The hits of the fan taken up.
  const HitLanes& hits() const { return hits_; }

  /// Lanes of the fan taken up that met nothing.
  LaneMask missed(const LaneMask& lanes) const {
    return LanesWith(D(), stride_, hits_.primitive, kNoPrimitive, lanes);
  }

  /// Calls visit(lanes, surface, front) for each group of lanes that met one surface from one side,
  /// with what shading needs of them in b_.at.
  /// Domain: all of `left` met something; throughput per lane.
  template <class Visit>
  void for_each_group(LaneMask left, const float* throughput, Visit&& visit) {
    find_surfaces(left);
    while (left.any()) {
      const int leader = left.front();
      std::uint32_t surface = 0;
      for (int m = 0; m < met_count_; ++m) {
        if (met_lanes_[m].test(leader)) surface = met_surface_[m];
      }
      LaneMask group;
      for (int m = 0; m < met_count_; ++m) {
        if (met_surface_[m] == surface) group = group | met_lanes_[m];
      }
      const bool front = met_front_.test(leader);
      group = left & (front ? group & met_front_ : group - met_front_);
      left = left - group;
      gather_group(group, leader, front, throughput);
      visit(group, surface, front);
    }
  }

 private:
  // Rays of neighbouring camera samples go the same way: sixteen of them are a packet.
  void find_camera_hits(const FanList& list, std::size_t first, std::size_t last) {
    b_.packets.clear();
    b_.first_query.clear();
    for (std::size_t begin = first; begin < last; begin += kPacketLanes) {
      RayPacket& packet = b_.packets.emplace_back();
      const std::size_t count = std::min<std::size_t>(kPacketLanes, last - begin);
      packet.active = (1u << count) - 1u;
      packet.common_origin = true;
      for (std::size_t lane = 0; lane < kPacketLanes; ++lane) {
        // Lanes beyond the last repeat it: they are inactive, but have to be numbers.
        const Fan& fan = list.fans[begin + std::min(lane, count - 1)];
        set_ray(packet, static_cast<int>(lane), {fan.origin, kInfinity, fan.direction});
        packet.common_origin &= fan.origin == list.fans[begin].origin;
      }
    }
    trace_packets();
    b_.hits.clear();
    for (std::size_t i = 0; i < last - first; ++i) {
      b_.first_query.push_back(static_cast<std::uint32_t>(i));
      b_.hits.push_back(
          hit_of(b_.packet_hits[i / kPacketLanes], static_cast<int>(i % kPacketLanes)));
    }
  }

  // What a triangle has in memory takes reads that tell where the next are: those of fans so far
  // ahead are on their way, the first of them twice as far.
  static constexpr std::size_t kFansAhead = 2;
  // Fewer lie in the caches anyway.
  static constexpr std::size_t kFewTriangles = std::size_t{1} << 15;

  // Calls visit(triangle) for the triangles that a fan met, seldom twice for the same.
  template <class Visit>
  HWY_INLINE void for_each_triangle(const Fan& fan, std::uint32_t query, const Visit& visit) const {
    const auto triangles = static_cast<std::uint32_t>(world_.geometry.triangles.size());
    if (!fan.spread) {
      if (b_.hits[query].primitive < triangles) visit(b_.hits[query].primitive);
      return;
    }
    std::uint32_t before = kNoPrimitive;
    for (int block = 0; block * kPacketLanes < stride_; ++block) {
      for (const std::uint32_t primitive : b_.packet_hits[query + block].primitive) {
        if (primitive < triangles && primitive != before) visit(primitive);
        before = primitive;
      }
    }
  }

  void fetch_triangles(const Fan& fan, std::uint32_t query) const {
    for_each_triangle(fan, query, [&](std::uint32_t triangle) {
      hwy::Prefetch(&world_.geometry.primitive_surface[triangle]);
      hwy::Prefetch(&world_.geometry.triangles[triangle]);
    });
  }

  void fetch_corners(const Fan& fan, std::uint32_t query) const {
    for_each_triangle(fan, query, [&](std::uint32_t triangle) {
      const Surface& surface =
          world_.geometry.surfaces[world_.geometry.primitive_surface[triangle]];
      for (const std::uint32_t corner : world_.geometry.triangles[triangle]) {
        hwy::Prefetch(&world_.geometry.positions[corner]);
        if (surface.normals_offset) {
          hwy::Prefetch(
              &world_.geometry.normals[corner + *surface.normals_offset - surface.first_vertex]);
        }
      }
    });
  }

  void trace_packets() {
    b_.packet_hits.resize(b_.packets.size());
    if (b_.packets.empty()) return;
    world_.tree.closest_hits(std::span<const RayPacket>(b_.packets), kAllBits,
                             std::span<HitPacket>(b_.packet_hits));
  }

  void fill_packet(RayPacket& packet, const float* lanes, int block, const Fan& fan) const {
    const int begin = block * kPacketLanes;
    const int count = std::min(kPacketLanes, stride_ - begin);
    float* arrays[6] = {packet.origin_x,    packet.origin_y,    packet.origin_z,
                        packet.direction_x, packet.direction_y, packet.direction_z};
    for (int a = 0; a < 6; ++a) {
      const float* source = lanes + a * stride_ + begin;
      std::copy(source, source + count, arrays[a]);
      // Lanes beyond the fan repeat the first: they are inactive, but have to be numbers.
      std::fill(arrays[a] + count, arrays[a] + kPacketLanes, source[0]);
    }
    std::fill(packet.t_max, packet.t_max + kPacketLanes, kInfinity);
    packet.active = fan.lanes.block16(block);
    packet.common_origin = fan.common_origin;
    packet.inside = fan.inside;
  }
  // Geometry at the hits of `lanes`, primitive by primitive; most fans met only one.
  void find_surfaces(LaneMask left) {
    const D d;
    met_count_ = 0;
    met_front_ = LaneMask();
    const LaneMask lanes = left;
    while (left.any()) {
      const int leader = left.front();
      const std::uint32_t primitive = hits_.primitive[leader];
      const std::uint32_t surface = world_.geometry.primitive_surface[primitive];
      LaneMask filled;
      if (has_attributes(world_, world_.geometry.surfaces[surface])) {
        filled = LanesWith(d, stride_, hits_.primitive, primitive, left);
        find_points(filled, primitive);
      } else {
        filled = FillSurfaceLanes(d, stride_, world_, hits_, left, leader, met_);
        b_.points[leader].surface = surface;
      }
      met_lanes_[met_count_] = filled;
      met_surface_[met_count_] = surface;
      ++met_count_;
      left = left - filled;
    }
    for (int i = 0; i < stride_; i += static_cast<int>(hn::Lanes(d))) {
      const auto cosine = Dot3(d, Load3(d, hits_.direction, i), Load3(d, met_.outward, i));
      SetLanesFrom(d, hn::Lt(cosine, hn::Zero(d)), i, met_front_);
    }
    met_front_ = met_front_ & lanes;
  }

  // The same lane by lane, where a triangle has attributes that differ from place to place.
  void find_points(const LaneMask& lanes, std::uint32_t primitive) {
    const bool is_triangle = primitive < world_.geometry.triangles.size();
    const TriangleFrame frame = is_triangle ? triangle_frame(world_, primitive) : TriangleFrame{};
    for (int lane = lanes.front(); lane < world_.lanes.lane_count(); ++lane) {
      if (!lanes.test(lane)) continue;
      const Hit hit{hits_.t[lane], primitive, hits_.u[lane], hits_.v[lane]};
      SurfacePoint& point = b_.points[lane];
      point = is_triangle
                  ? triangle_point(world_, frame, hit)
                  : surface_point(world_, hits_.origin.get(lane), hits_.direction.get(lane), hit);
      met_.position.set(lane, point.position);
      met_.outward.set(lane, point.normal);
      met_.shading_normal.set(lane, point.shading_normal);
      met_.offset_m[lane] = point.offset_m;
    }
  }

  // The working set of shading for a group of lanes. Other lanes take the leader's geometry, so
  // that all numbers are sane, and no throughput.
  void gather_group(const LaneMask& group, int leader, bool front, const float* throughput) {
    const D d;
    Interaction& at = b_.at;
    const auto leader_position = Set3(d, met_.position.get(leader));
    const auto leader_direction = Set3(d, hits_.direction.get(leader));
    const auto leader_outward = Set3(d, met_.outward.get(leader));
    const auto leader_shading = Set3(d, met_.shading_normal.get(leader));
    const auto leader_offset = hn::Set(d, met_.offset_m[leader]);
    const auto leader_distance = hn::Set(d, hits_.t[leader]);
    const auto side = hn::Set(d, front ? 1.0f : -1.0f);
    for (int i = 0; i < stride_; i += static_cast<int>(hn::Lanes(d))) {
      const auto member = LanesFrom(d, group, i);
      Store3(d, Select3(d, member, Load3(d, met_.position, i), leader_position), at.position, i);
      Store3(d, Select3(d, member, Load3(d, hits_.direction, i), leader_direction), at.direction,
             i);
      Store3(d, Select3(d, member, Load3(d, met_.outward, i), leader_outward), at.outward, i);
      const auto shading = Select3(d, member, Load3(d, met_.shading_normal, i), leader_shading);
      Store3(
          d,
          Vec3Of<D>{hn::Mul(side, shading.x), hn::Mul(side, shading.y), hn::Mul(side, shading.z)},
          at.normal, i);
      hn::Store(hn::IfThenElse(member, hn::Load(d, met_.offset_m.v + i), leader_offset), d,
                at.offset_m.v + i);
      hn::Store(hn::IfThenElse(member, hn::Load(d, hits_.t.v + i), leader_distance), d,
                at.distance_m.v + i);
      hn::Store(hn::IfThenElseZero(member, hn::LoadU(d, throughput + i)), d, at.throughput.v + i);
    }
  }

  const World& world_;
  IntegratorScratch::Buffers& b_;
  const int stride_;

  // Of the spread fan taken up: its hits, and the primitives that its lanes met.
  HitLanes hits_;
  SurfaceLanes met_;
  int met_count_ = 0;
  std::array<LaneMask, kMaxLanes> met_lanes_;
  std::array<std::uint32_t, kMaxLanes> met_surface_;
  LaneMask met_front_;
};

}  // namespace HWY_NAMESPACE
}  // namespace abbe
HWY_AFTER_NAMESPACE();

#endif  // ABBE_INTEGRATE_FAN_HITS_INL_H_
