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
#include <utility>

#include "abbe/integrate/buffers.h"
#include "abbe/integrate/fan_contacts.h"
#include "abbe/integrate/surface/hit.h"
#include "abbe/integrate/surface/point_lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace abbe {
namespace HWY_NAMESPACE {

/// The hits of fans [first, first + first_query.size()) of a list.
struct BatchHits {
  std::size_t first = 0;
  std::span<const Hit> hits;                   ///< Of united fans.
  std::span<const HitPacket> packets;          ///< Of spread ones.
  std::span<const std::uint32_t> first_query;  ///< A fan's place in hits, or in packets its first.
  // Where surfaces may touch, as the buffers have them; else empty.
  std::span<const Contact> contacts;
  std::span<const std::uint32_t> hit_contacts, lane_contacts;

  std::uint32_t query_of(std::size_t fan) const { return first_query[fan - first]; }
  /// What a united fan met besides the surface; null: nothing.
  const Contact* contact_of(std::size_t fan) const {
    const std::uint32_t number = contacts.empty() ? 0 : hit_contacts[query_of(fan)];
    return number == 0 ? nullptr : &contacts[number];
  }
};

/// Where the fans of a batch meet surfaces, and which lanes of a spread fan go on together.
template <class D>
class FanHits {
 public:
  FanHits(const World& world, IntegratorScratch::Buffers& buffers)
      : world_(world), b_(buffers), stride_(world.lanes.lane_stride()) {}

  /// Asks for the hits of fans [first, last), which stand until it is asked again.
  BatchHits find_hits(const FanList& list, std::size_t first, std::size_t last) {
    if (list.fans[first].depth == 0) {
      find_camera_hits(list, first, last);
    } else {
      find_fan_hits(list, first, last);
    }
    if (world_.touching.empty())
      return {first, b_.hits, b_.packet_hits, b_.first_query, {}, {}, {}};
    settle_contacts(world_, list, first, last, b_);
    return {first,       b_.hits,         b_.packet_hits,  b_.first_query,
            b_.contacts, b_.hit_contacts, b_.lane_contacts};
  }

  /// Asks for the memory that shading the fans of a batch will read, of which `at` is next. Domain:
  /// for each of them in turn.
  void fetch_geometry(const FanList& list, const BatchHits& batch, std::size_t at) const {
    const Geometry& geometry = world_.geometry;
    if (geometry.triangles.size() + geometry.mesh_triangles.size() < kFewTriangles) return;
    const std::size_t last = batch.first + batch.first_query.size();
    const bool is_first = at == batch.first;
    for (std::size_t i = is_first ? at : at + 2 * kFansAhead; i <= at + 2 * kFansAhead; ++i) {
      if (i < last) fetch_triangles(list.fans[i], batch, i);
    }
    for (std::size_t i = is_first ? at : at + kFansAhead; i <= at + kFansAhead; ++i) {
      if (i < last) fetch_corners(list.fans[i], batch, i);
    }
  }

  /// The rays of a spread fan and their hits, lane by lane.
  HitLanes hits_of(const FanList& list, const BatchHits& batch, std::size_t number) const {
    HitLanes hits;
    const float* pool = list.pool.data() + list.fans[number].data;
    float* arrays[6] = {hits.origin.x.v,    hits.origin.y.v,    hits.origin.z.v,
                        hits.direction.x.v, hits.direction.y.v, hits.direction.z.v};
    for (int a = 0; a < 6; ++a) {
      std::copy(pool + (a + 1) * stride_, pool + (a + 2) * stride_, arrays[a]);
    }
    for (int block = 0; block * kPacketLanes < stride_; ++block) {
      const HitPacket& packet = batch.packets[batch.query_of(number) + block];
      const int begin = block * kPacketLanes;
      std::copy(packet.t, packet.t + kPacketLanes, hits.t.v + begin);
      std::copy(packet.u, packet.u + kPacketLanes, hits.u.v + begin);
      std::copy(packet.v, packet.v + kPacketLanes, hits.v.v + begin);
      std::copy(packet.primitive, packet.primitive + kPacketLanes, hits.primitive + begin);
    }
    if (!batch.contacts.empty()) {
      hits.contact = batch.lane_contacts.data() + kPacketLanes * batch.query_of(number);
    }
    return hits;
  }

  /// Lanes that met nothing.
  LaneMask missed(const HitLanes& hits, const LaneMask& lanes) const {
    return LanesWith(D(), stride_, hits.primitive, kNoPrimitive, lanes);
  }

  /// Calls visit(hit) for each group of lanes that met one surface from one side.
  /// Domain: all of `left` met something.
  template <class Visit>
  void for_each_group(const HitLanes& hits, LaneMask left, Visit&& visit) {
    find_surfaces(hits, left);
    while (left.any()) {
      const int leader = left.front();
      SurfaceHit hit;
      hit.primitives = hits.primitive;
      for (int m = 0; m < met_count_; ++m) {
        if (met_lanes_[m].test(leader)) hit.surface = met_surface_[m];
      }
      LaneMask group;
      for (int m = 0; m < met_count_; ++m) {
        if (met_surface_[m] == hit.surface) group = group | met_lanes_[m];
      }
      hit.front = met_front_.test(leader);
      hit.lanes = left & (hit.front ? group & met_front_ : group - met_front_);
      if (hits.contact != nullptr) keep_contact_of(leader, hits, hit);
      left = left - hit.lanes;
      gather_group(hits, hit);
      visit(std::as_const(hit));
    }
  }

  /// The hit of a united fan.
  SurfaceHit united_hit(const Fan& fan, const Hit& met, const SurfacePoint& point,
                        const Contact* contact) const {
    const D d;
    SurfaceHit hit;
    hit.contact = contact;
    hit.lanes = fan.lanes;
    hit.surface = point.surface;
    hit.front = glm::dot(fan.direction, point.normal) < 0.0f;
    hit.points = {&point, 1};
    hit.primitives = {&met.primitive, 1};
    Splat(d, stride_, point.position, hit.position);
    Splat(d, stride_, fan.direction, hit.direction);
    Splat(d, stride_, point.normal, hit.outward);
    Splat(d, stride_, hit.front ? point.shading_normal : -point.shading_normal, hit.normal);
    Splat(d, stride_, point.offset_m + (contact != nullptr ? contact->spread_m : 0.0f),
          hit.offset_m);
    Splat(d, stride_, met.t, hit.distance_m);
    return hit;
  }

 private:
  void find_fan_hits(const FanList& list, std::size_t first, std::size_t last) {
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
      world_.accelerator->closest_hits(std::span<const Ray>(b_.rays), kAllBits | kCullBack,
                                       std::span<Hit>(b_.hits));
    }
    trace_packets();
  }

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
  HWY_INLINE void for_each_triangle(const Fan& fan, const BatchHits& batch, std::size_t number,
                                    const Visit& visit) const {
    const auto is_triangle = [&](std::uint32_t primitive) {
      return primitive != kNoPrimitive && world_.geometry.is_triangle(primitive);
    };
    const std::uint32_t query = batch.query_of(number);
    if (!fan.spread) {
      if (is_triangle(batch.hits[query].primitive)) visit(batch.hits[query].primitive);
      return;
    }
    std::uint32_t before = kNoPrimitive;
    for (int block = 0; block * kPacketLanes < stride_; ++block) {
      for (const std::uint32_t primitive : batch.packets[query + block].primitive) {
        if (primitive != before && is_triangle(primitive)) visit(primitive);
        before = primitive;
      }
    }
  }

  void fetch_triangles(const Fan& fan, const BatchHits& batch, std::size_t number) const {
    for_each_triangle(fan, batch, number, [&](std::uint32_t triangle) {
      const Geometry& geometry = world_.geometry;
      if (geometry.is_shared(triangle)) {
        const PlacedNumbers::PlacedTriangle found = geometry.numbers.triangle_of(triangle);
        const MeshPlace& place = geometry.places[found.place];
        hwy::Prefetch(&geometry.mesh_triangles[geometry.meshes[place.mesh].first + found.triangle]);
        hwy::Prefetch(&geometry.place_surface[found.place]);
        hwy::Prefetch(&geometry.place_normals[found.place]);
        return;
      }
      hwy::Prefetch(&geometry.primitive_surface[triangle]);
      hwy::Prefetch(&geometry.triangles[triangle]);
    });
  }

  void fetch_corners(const Fan& fan, const BatchHits& batch, std::size_t number) const {
    for_each_triangle(fan, batch, number, [&](std::uint32_t triangle) {
      const LocatedTriangle located = world_.geometry.located(triangle);
      const Surface& surface = world_.geometry.surfaces[located.surface];
      for (const std::uint32_t corner : located.corners) {
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
    world_.accelerator->closest_hits(std::span<const RayPacket>(b_.packets), kAllBits | kCullBack,
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
  void find_surfaces(const HitLanes& hits, LaneMask left) {
    const D d;
    met_count_ = 0;
    met_front_ = LaneMask();
    const LaneMask lanes = left;
    while (left.any()) {
      const int leader = left.front();
      const std::uint32_t primitive = hits.primitive[leader];
      const std::uint32_t surface = world_.geometry.surface_of(primitive);
      LaneMask filled;
      if (has_attributes(world_, world_.geometry.surfaces[surface])) {
        filled = LanesWith(d, stride_, hits.primitive, primitive, left);
        find_points(hits, filled, primitive);
      } else {
        filled = FillSurfaceLanes(d, stride_, world_, hits, left, leader, met_);
      }
      met_lanes_[met_count_] = filled;
      met_surface_[met_count_] = surface;
      ++met_count_;
      left = left - filled;
    }
    for (int i = 0; i < stride_; i += static_cast<int>(hn::Lanes(d))) {
      const auto cosine = Dot3(d, Load3(d, hits.direction, i), Load3(d, met_.outward, i));
      SetLanesFrom(d, hn::Lt(cosine, hn::Zero(d)), i, met_front_);
    }
    met_front_ = met_front_ & lanes;
  }

  // The same lane by lane, where a triangle has attributes that differ from place to place.
  void find_points(const HitLanes& hits, const LaneMask& lanes, std::uint32_t primitive) {
    const bool is_triangle = world_.geometry.is_triangle(primitive);
    const TriangleFrame frame = is_triangle ? triangle_frame(world_, primitive) : TriangleFrame{};
    for (int lane = lanes.front(); lane < world_.lanes.lane_count(); ++lane) {
      if (!lanes.test(lane)) continue;
      const Hit hit{hits.t[lane], primitive, hits.u[lane], hits.v[lane]};
      SurfacePoint& point = points_[lane];
      point = is_triangle
                  ? triangle_point(world_, frame, hit)
                  : surface_point(world_, hits.origin.get(lane), hits.direction.get(lane), hit);
      met_.position.set(lane, point.position);
      met_.outward.set(lane, point.normal);
      met_.shading_normal.set(lane, point.shading_normal);
      met_.offset_m[lane] = point.offset_m;
    }
  }

  // Keeps the lanes that met the same besides as one of them.
  void keep_contact_of(int leader, const HitLanes& hits, SurfaceHit& hit) const {
    const std::uint32_t number = hits.contact[leader];
    hit.lanes = LanesWith(D(), stride_, hits.contact, number, hit.lanes);
    hit.contact = number == 0 ? nullptr : &b_.contacts[number];
  }

  // The geometry of a hit, of which surface, side and lanes are known. Other lanes take that of the
  // first, so that all numbers are sane.
  void gather_group(const HitLanes& hits, SurfaceHit& hit) {
    const D d;
    const int leader = hit.lanes.front();
    points_[leader].surface = hit.surface;
    hit.points_differ = has_attributes(world_, world_.geometry.surfaces[hit.surface]);
    hit.points = hit.points_differ ? std::span<const SurfacePoint>(points_)
                                   : std::span<const SurfacePoint>(&points_[leader], 1);
    const auto leader_position = Set3(d, met_.position.get(leader));
    const auto leader_direction = Set3(d, hits.direction.get(leader));
    const auto leader_outward = Set3(d, met_.outward.get(leader));
    const auto leader_shading = Set3(d, met_.shading_normal.get(leader));
    const float spread_m = hit.contact != nullptr ? hit.contact->spread_m : 0.0f;
    const auto leader_offset = hn::Set(d, met_.offset_m[leader]);
    const auto leader_distance = hn::Set(d, hits.t[leader]);
    const auto side = hn::Set(d, hit.front ? 1.0f : -1.0f);
    for (int i = 0; i < stride_; i += static_cast<int>(hn::Lanes(d))) {
      const auto member = LanesFrom(d, hit.lanes, i);
      const auto of_member = [&](const LaneArray3& own, const Vec3Of<D>& leading)
                                 HWY_ATTR { return Select3(d, member, Load3(d, own, i), leading); };
      Store3(d, of_member(met_.position, leader_position), hit.position, i);
      Store3(d, of_member(hits.direction, leader_direction), hit.direction, i);
      Store3(d, of_member(met_.outward, leader_outward), hit.outward, i);
      const auto shading = of_member(met_.shading_normal, leader_shading);
      Store3(
          d,
          Vec3Of<D>{hn::Mul(side, shading.x), hn::Mul(side, shading.y), hn::Mul(side, shading.z)},
          hit.normal, i);
      hn::Store(hn::Add(hn::IfThenElse(member, hn::Load(d, met_.offset_m.v + i), leader_offset),
                        hn::Set(d, spread_m)),
                d, hit.offset_m.v + i);
      hn::Store(hn::IfThenElse(member, hn::Load(d, hits.t.v + i), leader_distance), d,
                hit.distance_m.v + i);
    }
  }

  const World& world_;
  IntegratorScratch::Buffers& b_;
  const int stride_;

  // Room for the primitives that the lanes of one fan met, for for_each_group().
  SurfaceLanes met_;
  int met_count_ = 0;
  std::array<LaneMask, kMaxLanes> met_lanes_;
  std::array<std::uint32_t, kMaxLanes> met_surface_;
  LaneMask met_front_;
  std::array<SurfacePoint, kMaxLanes> points_;
};

}  // namespace HWY_NAMESPACE
}  // namespace abbe
HWY_AFTER_NAMESPACE();

#endif  // ABBE_INTEGRATE_FAN_HITS_INL_H_
