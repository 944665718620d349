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

#include "abbe/integrate/branching-inl.h"
#include "abbe/integrate/buffers.h"
#include "abbe/integrate/cost.h"
#include "abbe/integrate/fan_hits-inl.h"
#include "abbe/integrate/fan_queue.h"
#include "abbe/integrate/fog/fog_light-inl.h"
#include "abbe/integrate/integrator.h"
#include "abbe/integrate/light/direct_light-inl.h"
#include "abbe/integrate/recorder.h"
#include "abbe/integrate/surface/material_lanes-inl.h"
#include "abbe/integrate/surface/material_sample.h"
#include "abbe/integrate/surface/point_lanes-inl.h"
#include "abbe/integrate/surface/shade-inl.h"
#include "abbe/math/sampling.h"

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
        shadows_(world, samples, stats, buffers, recorder_),
        lamps_(world, settings.kernel, samples, buffers, shadows_),
        fog_(world, samples, shadows_),
        layers_(layers),
        stride_(world.lanes.lane_stride()),
        found_(world, buffers),
        branching_(world, settings, samples, stats, buffers, shading_) {}

  void run(std::span<float> radiance) {
    b_.local_light.assign(radiance.size(), 0.0f);
    b_.direct_light.assign(radiance.size(), 0.0f);
    std::fill(layers_.light_parts.begin(), layers_.light_parts.end(), 0.0f);
    std::fill(layers_.albedo.begin(), layers_.albedo.end(), 0.0f);
    FanQueue queue(b_.spare_lists, stats_);
    FanList first = queue.take_list();
    for (std::size_t i = 0; i < samples_.size(); ++i) start(first, static_cast<std::uint32_t>(i));
    queue.run(std::move(first), [&](const FanList& list, std::size_t begin, std::size_t end,
                                    FanList& next) { run_batch(list, begin, end, next); });
    for (std::size_t i = 0; i < radiance.size(); ++i) {
      radiance[i] = b_.local_light[i] + b_.direct_light[i];
    }
  }

 private:
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

  void run_batch(const FanList& list, std::size_t first, std::size_t last, FanList& next) {
    found_.find_hits(list, first, last);
    if (settings_.counts_cost) count_fan_cost(world_, list, first, last, first_hits_);
    shadows_.start_batch();
    for (std::size_t i = first; i < last; ++i) {
      const Fan& fan = list.fans[i];
      const std::uint32_t query = b_.first_query[i - first];
      found_.fetch_geometry(list, first, last, i);
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
    shadows_.resolve(layers_.light_parts);
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
    fog_.scatter(fan, fan.lanes, b_.at.position, b_.at.direction, b_.at.distance_m,
                 fog_throughput_);
  }

  void shade_spread(const Fan& fan, const FanList& list, std::uint32_t first_packet,
                    FanList& next) {
    found_.load_hits(fan, list, first_packet);
    const float* throughput = list.pool.data() + fan.data;
    if (world_.fog && fan.media.empty()) {
      const HitLanes& hits = found_.hits();
      std::copy(throughput, throughput + stride_, fog_throughput_.v);
      fog_.scatter(fan, fan.lanes, hits.origin, hits.direction, hits.t, fog_throughput_);
    }
    const LaneMask missed = found_.missed(fan.lanes);
    if (missed.any()) recorder_.miss(fan, list, missed);
    found_.for_each_group(fan.lanes - missed, throughput,
                          [&](const LaneMask& group, std::uint32_t surface, bool front) {
                            shade(fan, group, surface, front, next);
                          });
  }

  // Everything that a surface does to a group of lanes, which lie in b_.at.
  void shade(const Fan& fan, const LaneMask& lanes, std::uint32_t surface, bool front,
             FanList& next) {
    const D d;
    const int step = static_cast<int>(hn::Lanes(d));
    const int set = samples_[fan.sample].set;
    const std::uint32_t number = world_.geometry.surfaces[surface].material;
    const SurfaceMaterial& material = world_.materials[number];
    Interaction& at = b_.at;
    const int leader = lanes.front();
    const float path_length_m = fan.path_length_m + at.distance_m[leader];
    const bool wants_albedo = fan.depth == 0 && !layers_.albedo.empty();
    FillMaterial(d, world_, samples_[fan.sample], fan, lanes, material, path_length_m, b_.points,
                 !material.unlit || wants_albedo, at);

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

    branching_.begin_surface(surface);
    recorder_.arrive(fan, lanes, surface, front, at);
    const std::uint32_t record_number = recorder_.last();
    if (material.alpha_mode != AlphaMode::Opaque) {
      branching_.pass_through(fan, lanes, path_length_m, record_number, next);
    }
    const bool hidden = crossing == Crossing::Hidden;
    ShadeLanes(d, stride_, rows, material.index_is_infinite, hidden, crossing == Crossing::Thin, at,
               shading_);
    add_local_light(fan, material, hidden, set);
    if (wants_albedo) {
      const std::size_t place = std::size_t{fan.sample} * static_cast<std::size_t>(stride_);
      std::copy(at.base_color.v, at.base_color.v + stride_, layers_.albedo.data() + place);
    }
    if (material.unlit) return;
    recorder_.shade(crossing, rows, at, shading_);

    const bool rough = at.roughness[leader] >= kSmoothRoughness;
    if (!hidden) {
      if (rough || scatters()) {
        lamps_.send(fan, lanes, material, rows, shading_, rough, record_number);
      }
      // The coherent ray of a rough opaque dielectric is a faint blur that its lobe stands for.
      const bool coherent = !rough || at.metallic[leader] > 0.0f || at.transmission[leader] > 0.0f;
      if (!coherent) return;
      if (rough) use_microfacets(fan, lanes, rows, material, crossing);
    }
    branching_.branch(fan, lanes, crossing, behind, path_length_m, record_number, next);
  }

  // Whether the surface has a diffuse lobe: polished glass and metal show no lamp as a point.
  bool scatters() const {
    const D d;
    auto any = hn::Zero(d);
    for (int i = 0; i < stride_; i += static_cast<int>(hn::Lanes(d))) {
      any = hn::Max(any, hn::Load(d, shading_.diffuse.v + i));
    }
    return !hn::AllTrue(d, hn::Le(any, hn::Zero(d)));
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

  void keep_first_hit(const Fan& fan, const SurfacePoint& point, float distance_m) {
    FirstHit& hit = first_hits_[fan.sample];
    const Surface& surface = world_.geometry.surfaces[point.surface];
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
  ShadowQueue<D> shadows_;
  DirectLight<D> lamps_;
  FogLight<D> fog_;
  const SampleLayers& layers_;
  const int stride_;

  Shading shading_;
  FanHits<D> found_;
  Branching<D> branching_;
  LaneArray3 saved_normal_;
  LaneArray fog_throughput_;
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
