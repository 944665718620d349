/// The loop over batches of fans. Highway code, compiled once per instruction set.

#if defined(ABBE_INTEGRATE_TRACER_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef ABBE_INTEGRATE_TRACER_INL_H_
#undef ABBE_INTEGRATE_TRACER_INL_H_
#else
#define ABBE_INTEGRATE_TRACER_INL_H_
#endif

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "integrate/buffers.h"
#include "integrate/cost.h"
#include "integrate/direct_light-inl.h"
#include "integrate/integrator.h"
#include "integrate/material_lanes-inl.h"
#include "integrate/material_sample.h"
#include "integrate/recorder.h"
#include "integrate/shade-inl.h"
#include "integrate/surface_lanes-inl.h"
#include "math/sampling.h"

HWY_BEFORE_NAMESPACE();
namespace abbe {
namespace HWY_NAMESPACE {

template <class D>
class Tracer {
 public:
  Tracer(const World& world, const IntegratorSettings& settings,
         std::span<const CameraSample> samples, std::span<FirstHit> first_hits,
         IntegratorStats& stats, IntegratorScratch::Buffers& buffers,
         std::vector<FanRecord>* recorder, const SampleLayers& layers)
      : world_(world),
        settings_(settings),
        samples_(samples),
        first_hits_(first_hits),
        stats_(stats),
        b_(buffers),
        recorder_(world, samples, recorder),
        lamps_(world, samples, stats, buffers, recorder_),
        layers_(layers),
        stride_(world.lanes.lane_stride()) {}

  void run(std::span<float> radiance) {
    b_.local_light.assign(radiance.size(), 0.0f);
    b_.direct_light.assign(radiance.size(), 0.0f);
    std::fill(layers_.light_parts.begin(), layers_.light_parts.end(), 0.0f);
    std::fill(layers_.albedo.begin(), layers_.albedo.end(), 0.0f);
    FanList first = take_list();
    for (std::size_t i = 0; i < samples_.size(); ++i) start(first, static_cast<std::uint32_t>(i));
    run_deepest_first(std::move(first));
    for (std::size_t i = 0; i < radiance.size(); ++i) {
      radiance[i] = b_.local_light[i] + b_.direct_light[i];
    }
  }

 private:
  /// Fans waiting in one generation; those before `next` are done.
  struct Generation {
    FanList list;
    std::size_t next = 0;
  };

  FanList take_list() {
    if (b_.spare_lists.empty()) return {};
    FanList list = std::move(b_.spare_lists.back());
    b_.spare_lists.pop_back();
    list.clear();
    return list;
  }

  void start(FanList& list, std::uint32_t sample) {
    Fan fan;
    fan.origin = samples_[sample].origin;
    fan.direction = samples_[sample].direction;
    fan.lanes = LaneMask::first(world_.lanes.lane_count());
    fan.path = hash64(samples_[sample].seed);
    fan.sample = sample;
    fan.data = list.reserve_lanes(false, stride_);
    for (int lane = 0; lane < stride_; ++lane) {
      list.pool[fan.data + lane] = lane < world_.lanes.lane_count() ? 1.0f : 0.0f;
    }
    list.fans.push_back(fan);
    ++stats_.camera_rays;
    stats_.weight_started += 1.0;
  }

  // The deepest generation goes first: what waits is at most the children of one batch for every
  // depth. Fans of one sample stay together and in order, and where a sample is cut into batches
  // depends on its own fans alone: what it adds up to does not depend on the others.
  void run_deepest_first(FanList first) {
    std::vector<Generation> waiting;
    waiting.push_back({std::move(first)});
    std::size_t waiting_fans = samples_.size();
    while (!waiting.empty()) {
      Generation& deepest = waiting.back();
      const std::size_t end = batch_end(deepest.list.fans, deepest.next);
      FanList children = take_list();
      run_batch(deepest.list, deepest.next, end, children);
      waiting_fans += children.fans.size();
      stats_.peak_queued_fans = std::max<std::uint64_t>(stats_.peak_queued_fans, waiting_fans);
      waiting_fans -= end - deepest.next;
      deepest.next = end;
      if (end == deepest.list.fans.size()) {
        give_back(std::move(deepest.list));
        waiting.pop_back();
      }
      if (children.fans.empty()) {
        give_back(std::move(children));
      } else {
        waiting.push_back({std::move(children)});
      }
    }
    std::size_t bytes = 0;
    for (const FanList& spare : b_.spare_lists) bytes += spare.bytes();
    stats_.peak_queue_bytes = std::max<std::uint64_t>(stats_.peak_queue_bytes, bytes);
  }

  // Whole samples up to kBatchFans; a sample with more is cut at every kBatchFans of its own fans.
  static std::size_t batch_end(const std::vector<Fan>& fans, std::size_t begin) {
    std::size_t end = begin;
    while (end < fans.size() && end - begin < kBatchFans) {
      std::size_t sample_end = end + 1;
      while (sample_end < fans.size() && fans[sample_end].sample == fans[end].sample &&
             sample_end - end < kBatchFans) {
        ++sample_end;
      }
      if (end != begin && sample_end - begin > kBatchFans) break;
      end = sample_end;
    }
    return end;
  }

  void give_back(FanList list) { b_.spare_lists.push_back(std::move(list)); }

  void run_batch(const FanList& list, std::size_t first, std::size_t last, FanList& next) {
    find_hits(list, first, last);
    if (settings_.counts_cost) count_fan_cost(world_, list, first, last, first_hits_);
    lamps_.start_batch();
    for (std::size_t i = first; i < last; ++i) {
      const Fan& fan = list.fans[i];
      const std::uint32_t query = b_.first_query[i - first];
      if (fan.spread) {
        ++stats_.spread_fans;
        const auto depth = std::min<std::size_t>(fan.depth, IntegratorStats::kDepths - 1);
        ++stats_.spread_fans_at[depth];
        stats_.spread_lanes_at[depth] += static_cast<std::uint64_t>(fan.lanes.count());
        shade_spread(fan, list, query, next);
      } else {
        ++stats_.united_fans;
        shade_united(fan, list, b_.hits[query], next);
      }
    }
    if (settings_.counts_cost) count_shadow_cost(world_, b_, first_hits_);
    lamps_.resolve(layers_.light_parts);
  }

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
        packet.origin_x[lane] = fan.origin.x;
        packet.origin_y[lane] = fan.origin.y;
        packet.origin_z[lane] = fan.origin.z;
        packet.direction_x[lane] = fan.direction.x;
        packet.direction_y[lane] = fan.direction.y;
        packet.direction_z[lane] = fan.direction.z;
        packet.t_max[lane] = kInfinity;
        packet.common_origin &= fan.origin == list.fans[begin].origin;
      }
    }
    trace_packets();
    b_.hits.clear();
    for (std::size_t i = 0; i < last - first; ++i) {
      const HitPacket& packet = b_.packet_hits[i / kPacketLanes];
      const std::size_t lane = i % kPacketLanes;
      b_.first_query.push_back(static_cast<std::uint32_t>(i));
      b_.hits.push_back({packet.t[lane], packet.primitive[lane], packet.u[lane], packet.v[lane]});
    }
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
  }

  void shade_united(const Fan& fan, const FanList& list, const Hit& hit, FanList& next) {
    if (world_.fog && fan.media.empty()) scatter_united(fan, list, hit.t);
    if (!hit.is_hit()) {
      recorder_.miss(fan, list, fan.lanes);
      return;
    }
    SurfacePoint& point = b_.points[0];
    point = surface_point(world_, fan.origin, fan.direction, hit);
    Interaction& at = b_.at;
    Splat(D(), stride_, point.position, at.position);
    Splat(D(), stride_, fan.direction, at.direction);
    Splat(D(), stride_, point.normal, at.outward);
    const bool front = glm::dot(fan.direction, point.normal) < 0.0f;
    Splat(D(), stride_, front ? point.shading_normal : -point.shading_normal, at.normal);
    Splat(D(), stride_, point.offset_m, at.offset_m);
    Splat(D(), stride_, hit.t, at.distance_m);
    const float* throughput = list.pool.data() + fan.data;
    std::copy(throughput, throughput + stride_, at.throughput.v);
    if (fan.depth == 0 && !first_hits_.empty()) keep_first_hit(fan, point, hit.t);
    shade(fan, fan.lanes, point.surface, front, next);
  }

  // The fog on the way of a united fan; `at` is still free to hold its ray.
  void scatter_united(const Fan& fan, const FanList& list, float distance_m) {
    const D d;
    Splat(d, stride_, fan.origin, b_.at.position);
    Splat(d, stride_, fan.direction, b_.at.direction);
    Splat(d, stride_, distance_m, b_.at.distance_m);
    const float* throughput = list.pool.data() + fan.data;
    std::copy(throughput, throughput + stride_, fog_throughput_.v);
    lamps_.scatter(fan, fan.lanes, b_.at.position, b_.at.direction, b_.at.distance_m,
                   fog_throughput_);
  }

  void shade_spread(const Fan& fan, const FanList& list, std::uint32_t first_packet,
                    FanList& next) {
    const D d;
    load_hits(fan, list, first_packet);
    const LaneMask missed = LanesWith(d, stride_, hits_.primitive, kNoPrimitive, fan.lanes);
    if (world_.fog && fan.media.empty()) {
      const float* throughput = list.pool.data() + fan.data;
      std::copy(throughput, throughput + stride_, fog_throughput_.v);
      lamps_.scatter(fan, fan.lanes, hits_.origin, hits_.direction, hits_.t, fog_throughput_);
    }
    if (missed.any()) recorder_.miss(fan, list, missed);
    LaneMask left = fan.lanes - missed;
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
      gather_group(group, leader, front, list.pool.data() + fan.data);
      shade(fan, group, surface, front, next);
    }
  }

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

  // Geometry at the hits of `lanes`, primitive by primitive; most fans met only one.
  void find_surfaces(LaneMask left) {
    const D d;
    met_count_ = 0;
    met_front_ = LaneMask();
    const LaneMask lanes = left;
    while (left.any()) {
      const int leader = left.front();
      const std::uint32_t primitive = hits_.primitive[leader];
      const std::uint32_t surface = world_.primitive_surface[primitive];
      LaneMask filled;
      if (has_attributes(world_, world_.surfaces[surface])) {
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
    const bool is_triangle = primitive < world_.triangles.size();
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

  // Everything that a surface does to a group of lanes, which lie in b_.at.
  void shade(const Fan& fan, const LaneMask& lanes, std::uint32_t surface, bool front,
             FanList& next) {
    const D d;
    const int step = static_cast<int>(hn::Lanes(d));
    const int set = samples_[fan.sample].set;
    const std::uint32_t number = world_.surfaces[surface].material;
    const SurfaceMaterial& material = world_.materials[number];
    Interaction& at = b_.at;
    const int leader = lanes.front();
    const float path_length_m = fan.path_length_m + at.distance_m[leader];
    FillMaterial(d, world_, samples_[fan.sample], fan, lanes, material, path_length_m, b_.points,
                 at);

    // The medium of arrival and what lies behind the surface.
    Crossing crossing = Crossing::None;
    MediumStack behind = fan.media;
    bool unknown_inside = false;
    if (material.transmission == Transmission::ThinSheet) {
      crossing = Crossing::Thin;
    } else if (material.transmission == Transmission::Medium) {
      if (front) {
        crossing = Crossing::Enter;
        behind.push(number);
      } else {
        // A ray that began inside, unknown to its stack, still has to get out.
        unknown_inside = !fan.media.contains(number);
        const bool is_top = unknown_inside || fan.media.top() == number;
        crossing = is_top ? Crossing::Leave : Crossing::Hidden;
        behind.remove(number);
      }
    }
    const SurfaceMaterial* inside = unknown_inside      ? &material
                                    : fan.media.empty() ? nullptr
                                                        : &world_.materials[fan.media.top()];
    const auto index_row = [&](const SurfaceMaterial* medium) {
      return medium != nullptr ? world_.row(medium->index, set) : nullptr;
    };
    BoundaryRows rows;
    rows.n_medium = index_row(inside);
    rows.n_incident = rows.n_medium;
    rows.n_transmitted = index_row(&material);
    if (crossing == Crossing::Leave) {
      rows.n_transmitted = index_row(behind.empty() ? nullptr : &world_.materials[behind.top()]);
    }
    if (material.is_conductor) {
      rows.conductor_n = world_.row(material.conductor_n, set);
      rows.conductor_k = world_.row(material.conductor_k, set);
    }
    if (material.film) {
      rows.film_n = world_.row(material.film->index, set);
      rows.inverse_wavelength = world_.row(world_.inverse_wavelength, set);
    }
    if (inside != nullptr && inside->absorption_per_m) {
      const float* absorption = world_.row(*inside->absorption_per_m, set);
      for (int i = 0; i < stride_; i += step) {
        const auto depth = hn::Mul(hn::LoadU(d, absorption + i), hn::Load(d, at.distance_m.v + i));
        hn::Store(hn::Mul(hn::Load(d, at.throughput.v + i), ExpNegative(d, depth)), d,
                  at.throughput.v + i);
      }
    }

    if (world_.fog && fan.media.empty()) {
      FogAttenuate(d, stride_, world_.fog->extinction_per_m, at.distance_m, at.throughput);
    }

    recorder_.arrive(fan, lanes, surface, front, at);
    const std::uint32_t record_number = recorder_.last();
    if (material.alpha_mode != AlphaMode::Opaque) {
      pass_through(fan, lanes, path_length_m, record_number, next);
    }
    const bool hidden = crossing == Crossing::Hidden;
    ShadeLanes(d, stride_, rows, material.index_is_infinite, hidden, crossing == Crossing::Thin, at,
               shading_);
    add_local_light(fan, material, hidden, set);
    if (fan.depth == 0 && !layers_.albedo.empty()) {
      const std::size_t place = std::size_t{fan.sample} * static_cast<std::size_t>(stride_);
      std::copy(at.base_color.v, at.base_color.v + stride_, layers_.albedo.data() + place);
    }
    if (material.unlit) return;
    recorder_.shade(crossing, rows, at, shading_);

    const bool rough = at.roughness[leader] >= kSmoothRoughness;
    if (!hidden) {
      lamps_.send(fan, lanes, material, rows, shading_, rough, record_number);
      // The coherent ray of a rough opaque dielectric is a faint blur that its lobe stands for.
      const bool coherent = !rough || at.metallic[leader] > 0.0f || at.transmission[leader] > 0.0f;
      if (!coherent) return;
      if (rough) use_microfacets(fan, lanes, rows, material, crossing);
    }
    branch(fan, lanes, crossing, behind, path_length_m, record_number, next);
  }

  // Emission, and ambient light: k_a defaults to the albedo that diffuse reflection has.
  void add_local_light(const Fan& fan, const SurfaceMaterial& material, bool hidden, int set) {
    const bool ambient = world_.ambient && !hidden && !material.unlit;
    if (!material.emission && !ambient) return;
    const D d;
    float* sum = b_.local_light.data() + static_cast<std::size_t>(fan.sample) * stride_;
    const float* ambient_row = ambient ? world_.row(*world_.ambient, set) : nullptr;
    if (!layers_.light_parts.empty()) add_local_parts(fan, material, ambient_row);
    for (int i = 0; i < stride_; i += static_cast<int>(hn::Lanes(d))) {
      auto light = hn::Load(d, b_.at.emission.v + i);
      if (ambient) {
        const auto k_a = material.ambient_factor ? hn::Set(d, *material.ambient_factor)
                                                 : hn::Load(d, shading_.diffuse.v + i);
        light = hn::Add(light, hn::Mul(k_a, hn::LoadU(d, ambient_row + i)));
      }
      const auto throughput =
          hn::Mul(hn::Load(d, b_.at.throughput.v + i), hn::Load(d, shading_.inverse_n2.v + i));
      hn::StoreU(hn::Add(hn::LoadU(d, sum + i), hn::Mul(throughput, light)), d, sum + i);
    }
  }

  // The same light by its parts; apart, so that it costs nothing where nobody asks.
  void add_local_parts(const Fan& fan, const SurfaceMaterial& material, const float* ambient_row) {
    float* emitted =
        part_of(layers_.light_parts, fan.sample, fan.first_turn, LightPart::Emitted, stride_);
    float* ambient =
        part_of(layers_.light_parts, fan.sample, fan.first_turn, LightPart::Ambient, stride_);
    for (int lane = 0; lane < stride_; ++lane) {
      const float throughput = b_.at.throughput[lane] * shading_.inverse_n2[lane];
      emitted[lane] += throughput * b_.at.emission[lane];
      if (ambient_row == nullptr) continue;
      ambient[lane] +=
          throughput * material.ambient_factor.value_or(shading_.diffuse[lane]) * ambient_row[lane];
    }
  }

  // Replaces the directions of the coherent rays by those of one microfacet normal, drawn once for
  // all lanes, and weighs them with the share of light that its neighbours let by.
  void use_microfacets(const Fan& fan, const LaneMask& lanes, const BoundaryRows& rows,
                       const SurfaceMaterial& material, Crossing crossing) {
    const std::uint64_t bits = hash64(fan.path ^ 0x6d6963726f66ull);
    const Vec2f u{unit_float(static_cast<std::uint32_t>(bits)),
                  unit_float(static_cast<std::uint32_t>(bits >> 32))};
    Interaction& at = b_.at;
    LaneArray3& kept_normal = saved_normal_;
    kept_normal = at.normal;
    LaneArray alpha;
    const int last = fan.spread ? stride_ : 1;
    for (int lane = 0; lane < last; ++lane) {
      const int source =
          lane < world_.lanes.lane_count() && lanes.test(lane) ? lane : lanes.front();
      const float roughness = std::max(at.roughness[source], kSmoothRoughness);
      alpha[lane] = roughness * roughness;
      const Basis basis(kept_normal.get(source));
      Vec3f view = basis.to_local(-at.direction.get(source));
      view.z = std::max(view.z, 1e-4f);
      at.normal.set(lane,
                    basis.to_world(sample_visible_normal(glm::normalize(view), alpha[lane], u)));
    }
    if (!fan.spread) {
      Splat(D(), stride_, at.normal.get(0), at.normal);
      Splat(D(), stride_, alpha[0], alpha);
    }
    const D d;
    ShadeLanes(d, stride_, rows, material.index_is_infinite, false, crossing == Crossing::Thin, at,
               shading_);
    for (int lane = 0; lane < stride_; ++lane) {
      const Vec3f normal = kept_normal.get(lane);
      const float cos_reflected = glm::dot(shading_.reflected.get(lane), normal);
      const float cos_refracted = -glm::dot(shading_.refracted.get(lane), normal);
      shading_.k_r[lane] *=
          cos_reflected > 0.0f ? ggx_masking(std::min(cos_reflected, 1.0f), alpha[lane]) : 0.0f;
      shading_.k_t[lane] *=
          cos_refracted > 0.0f ? ggx_masking(std::min(cos_refracted, 1.0f), alpha[lane]) : 0.0f;
    }
    at.normal = kept_normal;
  }

  float weight_of(const LaneArray& throughput, int set) const {
    const float* importance = world_.importance.data() + static_cast<std::size_t>(set) * stride_;
    // Four sums whatever the width of vectors, so that a weight has the same bits on every level.
    const hn::CappedTag<float, 4> d;
    auto sums = hn::Zero(d);
    for (int i = 0; i < stride_; i += 4) {
      sums = hn::Add(sums, hn::Mul(hn::Load(d, throughput.v + i), hn::LoadU(d, importance + i)));
    }
    return hn::GetLane(hn::SumOfLanes(d, sums));
  }

  // The share of light that a partly transparent surface lets by goes straight on.
  void pass_through(const Fan& fan, const LaneMask& lanes, float path_length_m,
                    std::uint32_t record_number, FanList& next) {
    Interaction& at = b_.at;
    bool any = false;
    for (int lane = 0; lane < stride_; ++lane) {
      const float alpha = at.alpha[lane];
      reflected_[lane] = at.throughput[lane] * (1.0f - alpha);
      at.throughput[lane] *= alpha;
      any |= reflected_[lane] > 0.0f;
    }
    if (!any) return;
    const float weight = weight_of(reflected_, samples_[fan.sample].set);
    if (fan.depth >= settings_.max_depth) {
      stats_.weight_lost_to_depth += static_cast<double>(weight);
      return;
    }
    add_child(fan, lanes, FanOrigin::Passed, fan.media, at.direction, fan.spread, reflected_,
              weight, path_length_m, record_number, next);
  }

  // The reflected and the refracted child, or below the cutoff one of them for the whole fan.
  void branch(const Fan& fan, const LaneMask& lanes, Crossing crossing, const MediumStack& behind,
              float path_length_m, std::uint32_t record_number, FanList& next) {
    Interaction& at = b_.at;
    const int set = samples_[fan.sample].set;
    LaneArray& reflected = reflected_;
    LaneArray& refracted = refracted_;
    const bool refracts = crossing != Crossing::None;
    const D d;
    for (int i = 0; i < stride_; i += static_cast<int>(hn::Lanes(d))) {
      const auto throughput = hn::Load(d, at.throughput.v + i);
      hn::Store(hn::Mul(throughput, hn::Load(d, shading_.k_r.v + i)), d, reflected.v + i);
      const auto passed = hn::Mul(throughput, hn::Load(d, shading_.k_t.v + i));
      hn::Store(refracts ? passed : hn::Zero(d), d, refracted.v + i);
    }
    float reflected_weight = weight_of(reflected, set);
    float refracted_weight = refracts ? weight_of(refracted, set) : 0.0f;
    const float weight = reflected_weight + refracted_weight;
    if (!(weight > 0.0f)) return;
    if (fan.depth >= settings_.max_depth) {
      stats_.weight_lost_to_depth += static_cast<double>(weight);
      return;
    }
    if (settings_.drop) {
      const auto drop_faint = [&](float& child) {
        if (child >= settings_.cutoff) return;
        stats_.weight_lost_to_cutoff += static_cast<double>(child);
        child = 0.0f;
      };
      drop_faint(reflected_weight);
      drop_faint(refracted_weight);
    } else if (weight < settings_.cutoff && reflected_weight > 0.0f && refracted_weight > 0.0f) {
      // One random number for the whole fan, tied to its path: what noise this makes is the same in
      // all its lanes.
      const float u = unit_float(static_cast<std::uint32_t>(hash64(fan.path ^ 0x6272616e6368ull)));
      const float p = reflected_weight / weight;
      const bool take_reflected = u < p;
      LaneArray& kept = take_reflected ? reflected : refracted;
      const float scale = 1.0f / (take_reflected ? p : 1.0f - p);
      for (int lane = 0; lane < stride_; ++lane) kept[lane] *= scale;
      reflected_weight = take_reflected ? weight : 0.0f;
      refracted_weight = take_reflected ? 0.0f : weight;
    }
    if (refracted_weight > 0.0f) {
      const bool straight = crossing == Crossing::Thin || crossing == Crossing::Hidden;
      const bool spreads = fan.spread || (!straight && !same_in_all_lanes(lanes));
      if (spreads && settings_.cluster_lanes > 0) {
        add_clusters(fan, lanes, behind, refracted, path_length_m, record_number, next);
      } else {
        add_child(fan, lanes, FanOrigin::Refracted, behind, shading_.refracted, spreads, refracted,
                  refracted_weight, path_length_m, record_number, next);
      }
    }
    if (reflected_weight > 0.0f) {
      add_child(fan, lanes, FanOrigin::Reflected, fan.media, shading_.reflected, fan.spread,
                reflected, reflected_weight, path_length_m, record_number, next);
    }
  }

  // The refracted fan as clusters of neighbouring lanes, each along the way of its middle one.
  void add_clusters(const Fan& parent, const LaneMask& lanes, const MediumStack& behind,
                    const LaneArray& throughput, float path_length_m, std::uint32_t record_number,
                    FanList& next) {
    const D d;
    const int set = samples_[parent.sample].set;
    LaneArray3 direction;
    LaneArray cluster_throughput;
    for (int first = 0; first < world_.lanes.lane_count(); first += settings_.cluster_lanes) {
      const int last = std::min(first + settings_.cluster_lanes, world_.lanes.lane_count());
      LaneMask cluster;
      int middle = -1;
      Splat(d, stride_, 0.0f, cluster_throughput);
      for (int lane = first; lane < last; ++lane) {
        if (!lanes.test(lane) || !(throughput[lane] > 0.0f)) continue;
        cluster.set(lane);
        cluster_throughput[lane] = throughput[lane];
        if (middle < 0 || lane <= (first + last) / 2) middle = lane;
      }
      if (middle < 0) continue;
      Splat(d, stride_, shading_.refracted.get(middle), direction);
      add_child(parent, cluster, FanOrigin::Refracted, behind, direction, false, cluster_throughput,
                weight_of(cluster_throughput, set), path_length_m, record_number, next);
    }
  }

  // Whether a united fan stays united when it refracts: there is one index for all its lanes.
  bool same_in_all_lanes(const LaneMask& lanes) const {
    const float eta = shading_.eta_ti[lanes.front()];
    return LanesWith(D(), stride_, shading_.eta_ti.v, eta, lanes) == lanes;
  }

  void add_child(const Fan& parent, const LaneMask& lanes, FanOrigin made_by,
                 const MediumStack& media, const LaneArray3& directions, bool spread,
                 const LaneArray& throughput, float weight, float path_length_m,
                 std::uint32_t record_number, FanList& next) {
    const Interaction& at = b_.at;
    Fan fan;
    const D d;
    for (int i = 0; i < stride_; i += static_cast<int>(hn::Lanes(d))) {
      SetLanesFrom(d, hn::Gt(hn::Load(d, throughput.v + i), hn::Zero(d)), i, fan.lanes);
    }
    fan.lanes = fan.lanes & lanes;
    fan.path = hash64(parent.path + static_cast<std::uint64_t>(made_by));
    fan.sample = parent.sample;
    fan.weight = weight;
    fan.path_length_m = path_length_m;
    fan.depth = static_cast<std::uint16_t>(parent.depth + 1);
    fan.made_by = made_by;
    const bool turns = parent.first_turn == FanOrigin::Camera && made_by != FanOrigin::Passed;
    fan.first_turn = turns ? made_by : parent.first_turn;
    // A fan of one lane is one ray.
    fan.spread = spread && fan.lanes.count() > 1;
    fan.common_origin = fan.spread && !parent.spread;
    fan.media = media;
    fan.parent_record = record_number;
    fan.data = next.reserve_lanes(fan.spread, stride_);
    float* out = next.pool.data() + fan.data;
    const int step = static_cast<int>(hn::Lanes(d));
    for (int i = 0; i < stride_; i += step) {
      hn::StoreU(hn::IfThenElseZero(LanesFrom(d, fan.lanes, i), hn::Load(d, throughput.v + i)), d,
                 out + i);
    }
    if (fan.spread) {
      for (int i = 0; i < stride_; i += step) {
        const auto direction = Load3(d, directions, i);
        const auto outward = Load3(d, at.outward, i);
        const auto position = Load3(d, at.position, i);
        const auto inside = hn::Lt(Dot3(d, direction, outward), hn::Zero(d));
        const auto offset = hn::Load(d, at.offset_m.v + i);
        const auto signed_offset = hn::IfThenElse(inside, hn::Neg(offset), offset);
        const auto origin = Combine3(d, hn::Set(d, 1.0f), position, signed_offset, outward);
        hn::StoreU(origin.x, d, out + stride_ + i);
        hn::StoreU(origin.y, d, out + 2 * stride_ + i);
        hn::StoreU(origin.z, d, out + 3 * stride_ + i);
        hn::StoreU(direction.x, d, out + 4 * stride_ + i);
        hn::StoreU(direction.y, d, out + 5 * stride_ + i);
        hn::StoreU(direction.z, d, out + 6 * stride_ + i);
      }
    } else {
      const int lane = fan.lanes.front();
      const Vec3f outward = at.outward.get(lane);
      fan.direction = directions.get(lane);
      const float side = glm::dot(fan.direction, outward) < 0.0f ? -1.0f : 1.0f;
      fan.origin = at.position.get(lane) + (side * at.offset_m[lane]) * outward;
    }
    const std::uint64_t rays =
        fan.spread ? static_cast<std::uint64_t>(fan.lanes.count()) : std::uint64_t{1};
    switch (made_by) {
      case FanOrigin::Reflected:
        stats_.reflected_rays += rays;
        break;
      case FanOrigin::Refracted:
        stats_.refracted_rays += rays;
        break;
      default:
        stats_.passed_rays += rays;
        break;
    }
    next.fans.push_back(fan);
  }

  void keep_first_hit(const Fan& fan, const SurfacePoint& point, float distance_m) {
    FirstHit& hit = first_hits_[fan.sample];
    const Surface& surface = world_.surfaces[point.surface];
    const SurfaceMaterial& material = world_.materials[surface.material];
    const CameraSample& sample = samples_[fan.sample];
    hit.is_hit = true;
    hit.position = point.position;
    hit.normal =
        glm::dot(fan.direction, point.normal) < 0.0f ? point.shading_normal : -point.shading_normal;
    hit.uv = point.uv[0];
    hit.distance_m = distance_m;
    hit.object = surface.object;
    hit.material = surface.material;
    hit.albedo_rec709 = base_color_rec709(world_, material, point,
                                          sample.footprint_m + sample.footprint_per_m * distance_m);
  }

  const World& world_;
  const IntegratorSettings& settings_;
  std::span<const CameraSample> samples_;
  std::span<FirstHit> first_hits_;
  IntegratorStats& stats_;
  IntegratorScratch::Buffers& b_;
  FanRecorder recorder_;
  DirectLight<D> lamps_;
  const SampleLayers& layers_;
  const int stride_;

  Shading shading_;
  LaneArray reflected_, refracted_;  ///< Throughputs of the children being made.
  LaneArray3 saved_normal_;
  LaneArray fog_throughput_;

  // Of the spread fan being shaded: its hits, and the primitives that its lanes met.
  HitLanes hits_;
  SurfaceLanes met_;
  int met_count_ = 0;
  std::array<LaneMask, kMaxLanes> met_lanes_;
  std::array<std::uint32_t, kMaxLanes> met_surface_;
  LaneMask met_front_;
};

void TraceSamples(const World& world, const IntegratorSettings& settings,
                  std::span<const CameraSample> samples, std::span<float> radiance,
                  std::span<FirstHit> first_hits, IntegratorStats& stats,
                  IntegratorScratch::Buffers& buffers, std::vector<FanRecord>* recorder,
                  const SampleLayers& layers) {
  const auto trace = [&](auto d) {
    Tracer<decltype(d)>(world, settings, samples, first_hits, stats, buffers, recorder, layers)
        .run(radiance);
  };
  // The widest vector that divides the stride.
  switch (world.lanes.lane_stride()) {
    case 4:
      return trace(hn::CappedTag<float, 4>());
    case 8:
      return trace(hn::CappedTag<float, 8>());
    default:
      return trace(hn::CappedTag<float, 16>());
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace abbe
HWY_AFTER_NAMESPACE();

#endif  // ABBE_INTEGRATE_TRACER_INL_H_
