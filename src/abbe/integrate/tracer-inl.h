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
#include "abbe/integrate/light/shared_light-inl.h"
#include "abbe/integrate/recorder.h"
#include "abbe/integrate/start_media.h"
#include "abbe/integrate/surface/material_lanes-inl.h"
#include "abbe/integrate/surface/material_sample.h"
#include "abbe/integrate/surface/microfacet_lanes-inl.h"
#include "abbe/integrate/surface/rebound-inl.h"
#include "abbe/math/random.h"
#include "abbe/optics/absorption-inl.h"

HWY_BEFORE_NAMESPACE();
namespace abbe {
namespace HWY_NAMESPACE {

template <class D>
class Tracer {
 public:
  Tracer(const LitWorld& world, const IntegratorSettings& settings,
         std::span<const CameraSample> samples, const SampleResults& results,
         IntegratorStats& stats, IntegratorScratch::Buffers& buffers)
      : world_(world),
        settings_(settings),
        samples_(samples),
        results_(results),
        stats_(stats),
        b_(buffers),
        recorder_(world, samples, results.records),
        shadows_(world, samples, stats, buffers.shadows, recorder_),
        lamps_(world, settings, samples, shadows_, buffers.misses, stats),
        fog_(world, samples, shadows_, buffers.misses),
        stride_(world.lanes.lane_stride()),
        found_(world, buffers),
        branching_(world, settings, samples, stats) {}

  void run() {
    const std::span<float> radiance = results_.radiance;
    b_.local_light.assign(radiance.size(), 0.0f);
    b_.shadows.direct_light.assign(radiance.size(), 0.0f);
    std::fill(results_.light_parts.begin(), results_.light_parts.end(), 0.0f);
    std::fill(results_.albedo.begin(), results_.albedo.end(), 0.0f);
    b_.camera_media.assign(samples_.size(), std::nullopt);
    FanQueue queue(b_.spare_lists, stats_);
    FanList first = queue.take_list();
    for (std::size_t i = 0; i < samples_.size(); ++i) start(first, static_cast<std::uint32_t>(i));
    queue.run(std::move(first), [&](const FanList& list, std::size_t begin, std::size_t end,
                                    FanList& next) { run_batch(list, begin, end, next); });
    for (std::size_t i = 0; i < radiance.size(); ++i) {
      radiance[i] = b_.local_light[i] + b_.shadows.direct_light[i];
    }
    for (std::size_t i = 0; i < samples_.size(); ++i) {
      if (b_.camera_media[i]) see_from(*b_.camera_media[i], i);
    }
  }

 private:
  void start(FanList& list, std::uint32_t sample) {
    Fan fan;
    fan.origin = samples_[sample].origin;
    fan.direction = samples_[sample].direction;
    fan.lanes = LaneMask::first(world_.lanes.lane_count());
    fan.sample = sample;
    fan.media = start_media(world_, fan.origin, fan.direction);
    fan.data = list.reserve_lanes(false, false, stride_);
    for (int lane = 0; lane < stride_; ++lane) {
      list.pool[fan.data + lane] = lane < world_.lanes.lane_count() ? 1.0f : 0.0f;
    }
    b_.camera_media[sample] = fan.media.owner();
    if (has_beams_) {
      list.beams.push_back(round_beam(fan.direction, samples_[sample].footprint_m,
                                      samples_[sample].footprint_per_m));
    }
    list.fans.push_back(fan);
    ++stats_.camera_rays;
    stats_.weight_started += 1.0;
  }

  // The camera sees the radiance in the medium that it stands in: n² times the basic one.
  void see_from(std::uint32_t medium, std::size_t sample) const {
    const D d;
    const float* n = world_.row(world_.materials[medium].index, samples_[sample].set);
    const auto scale = [&](std::span<float> all, std::size_t rows) HWY_ATTR {
      if (all.empty()) return;
      float* first = all.data() + sample * rows * static_cast<std::size_t>(stride_);
      for (std::size_t row = 0; row < rows; ++row) {
        for (int i = 0; i < stride_; i += static_cast<int>(hn::Lanes(d))) {
          float* to = first + row * static_cast<std::size_t>(stride_) + i;
          const auto index = hn::LoadU(d, n + i);
          hn::StoreU(hn::Mul(hn::LoadU(d, to), hn::Mul(index, index)), d, to);
        }
      }
    };
    scale(results_.radiance, 1);
    scale(results_.light_parts, kLightParts);
  }

  // A fan's path through the integrator, from here on: hits → surface → lobes → children, while
  // light from lamps waits in the shadow queue.
  void run_batch(const FanList& list, std::size_t first, std::size_t last, FanList& next) {
    const BatchHits batch = found_.find_hits(list, first, last);
    if (settings_.counts_cost) count_fan_cost(world_, list, first, last, results_.first_hits);
    shadows_.start_batch();
    for (std::size_t i = first; i < last; ++i) {
      const Fan& fan = list.fans[i];
      found_.fetch_geometry(list, batch, i);
      if (fan.spread) {
        ++stats_.spread_fans;
        const auto depth = std::min<std::size_t>(fan.depth, IntegratorStats::kDepths - 1);
        ++stats_.spread_fans_at[depth];
        stats_.spread_lanes_at[depth] += static_cast<std::uint64_t>(fan.lanes.count());
        follow_spread(list, batch, i, next);
      } else {
        ++stats_.united_fans;
        follow_united(list, batch, i, next);
      }
    }
    if (settings_.counts_cost) count_shadow_cost(world_, b_.shadows, results_.first_hits);
    shadows_.resolve(results_.light_parts);
  }

  void follow_united(const FanList& list, const BatchHits& batch, std::size_t number,
                     FanList& next) {
    const Fan& fan = list.fans[number];
    const Hit& met = batch.hits[batch.query_of(number)];
    const LaneArray throughput = throughput_of(list, fan);
    if (is_in_fog(fan)) {
      const D d;
      LaneArray3 origin, direction;
      LaneArray distance_m;
      Splat(d, stride_, fan.origin, origin);
      Splat(d, stride_, fan.direction, direction);
      Splat(d, stride_, met.t, distance_m);
      fog_.scatter(fan, fan.lanes, origin, direction, distance_m, throughput);
    }
    if (!met.is_hit()) {
      recorder_.miss(fan, list, fan.lanes);
      see_environment(list, fan, fan.lanes, throughput, [&](int) { return fan.direction; });
      return;
    }
    const SurfacePoint point = surface_point(world_, fan.origin, fan.direction, met);
    if (fan.depth == 0 && !results_.first_hits.empty()) keep_first_hit(fan, point, met.t);
    shade(list, fan, found_.united_hit(fan, met, point, batch.contact_of(number)), throughput,
          next);
  }

  void follow_spread(const FanList& list, const BatchHits& batch, std::size_t number,
                     FanList& next) {
    const Fan& fan = list.fans[number];
    const HitLanes hits = found_.hits_of(list, batch, number);
    const LaneArray throughput = throughput_of(list, fan);
    if (is_in_fog(fan)) {
      fog_.scatter(fan, fan.lanes, hits.origin, hits.direction, hits.t, throughput);
    }
    const LaneMask missed = found_.missed(hits, fan.lanes);
    if (missed.any()) {
      recorder_.miss(fan, list, missed);
      see_environment(list, fan, missed, throughput,
                      [&](int lane) { return hits.direction.get(lane); });
    }
    found_.for_each_group(hits, fan.lanes - missed, [&](const SurfaceHit& hit) {
      shade(list, fan, hit, among(throughput, hit.lanes), next);
    });
  }

  // Everything that a surface does to a group of lanes, of whose throughput this arrives.
  void shade(const FanList& list, const Fan& fan, const SurfaceHit& hit, const LaneArray& arriving,
             FanList& next) {
    const D d;
    LaneArray throughput = arriving;
    const CameraSample& sample = samples_[fan.sample];
    const SurfaceMaterial& material = material_of(world_, hit);
    const int leader = hit.lanes.front();
    const MediumChange change = change_at(world_, hit, fan.media);
    const BoundaryRows rows = boundary_rows(world_, material, change, sample.set);
    // A camera behind an open surface: only its rays know.
    if (fan.media.empty() && change.arrives_in && fan.first_turn == FanOrigin::Camera) {
      b_.camera_media[fan.sample] = change.arrives_in;
    }

    const float path_length_m = fan.path_length_m + hit.distance_m[leader];
    const bool wants_albedo = fan.depth == 0 && !results_.albedo.empty();
    const Beam* beam = list.beam_of(fan);
    const float footprint_m = beam != nullptr ? beam_width_m(moved(*beam, hit.distance_m[leader]),
                                                             hit.direction.get(leader))
                                              : 0.0f;
    MaterialLanes at =
        MaterialAt(d, world_, hit, footprint_m, sample.set, !material.unlit || wants_albedo);
    const bool hidden = change.crossing == Crossing::Hidden;
    // No std::optional: g++ clears one of 14 kB even where it stays empty.
    LayerLanes room_for_layers;
    LayerLanes* const layers = material.layers && !hidden ? &room_for_layers : nullptr;
    if (layers != nullptr) {
      *layers = {};
      FillLayers(d, world_, hit, footprint_m, sample.set, at, *layers);
      at.layers = layers;
    }
    absorb(fan, change, hit.distance_m, throughput);
    const FanAtSurface where{list, fan, hit, path_length_m, recorder_.arrive(fan, hit, throughput)};
    if (material.alpha_mode != AlphaMode::Opaque) {
      branching_.pass_by(where, at.alpha, throughput, next);
    }

    SurfaceAnswer answer = AnswerOf(d, stride_, change, rows, hit, at, nullptr);
    const bool rough = at.roughness[leader] >= kSmoothRoughness || is_brushed(layers, leader);
    if (layers != nullptr) {
      FillViewOfLayers(d, stride_, change, rows, hit, answer, *layers);
      LayOver(d, stride_, rows, hit, rough, *layers, answer);
      layers->coat_chance = CoatChance(hit, answer, *layers, rough);
      dim_emission(*layers, at.emission);
    }
    const LaneArray* emission = &at.emission;
    LaneArray shared_emission;
    if (fan.shared.any() && world_.emitters && material.lights_others) {
      SharesOfRays(world_, list, fan, hit, stride_, shared_emission);
      multiply(at.emission, shared_emission);
      emission = &shared_emission;
    }
    add_local_light(fan, material, *emission, answer,
                    layers != nullptr ? layers->ambient : answer.diffuse, throughput, hidden);
    if (wants_albedo) keep_albedo(fan, at.base_color);
    if (material.unlit) return;
    recorder_.shade(where.record_number, change, rows, hit, at, answer);
    if (hidden) return branching_.branch(where, throughput, answer, next);

    ReboundLanes room_for_rebound;
    ReboundLanes* rebound = nullptr;
    if (rough && settings_.multiple_scattering && at.metallic[leader] > 0.0f) {
      room_for_rebound = ReboundAt(d, stride_, rows, at, answer, hit.lanes);
      rebound = &room_for_rebound;
    }
    const bool coated = layers != nullptr && layers->has_coat;
    // Elsewhere the ray of a rough opaque dielectric is a faint blur that its lobe stands for.
    const bool coherent = !rough || at.metallic[leader] > 0.0f || at.transmission[leader] > 0.0f ||
                          coated || world_.shines_all_around;
    const bool has_rough_coat = layers != nullptr && layers->coat_is_rough;
    const bool goes_on = fan.depth < settings_.max_depth;
    const bool may_refract = rough && coherent && goes_on && shares_light(world_) &&
                             answer.lobe_count > 1 && scatters(at.transmission);
    const ShadedSurface shaded{
        hit,
        at,
        rows,
        answer,
        rough,
        has_rough_coat,
        (has_rough_coat || (rough && coherent)) && goes_on,
        rebound,
        may_refract ? &change.behind : nullptr,
        change.crossing == Crossing::Thin,
        scatters(answer.diffuse) || (layers != nullptr && scatters(layers->ambient))};
    if (rough || shaded.has_broad_lobe || has_rough_coat) {
      lamps_.send({where, shaded, throughput});
    }
    if (!coherent) return;
    if (!shaded.samples_rough_lobe) return branching_.branch(where, throughput, answer, next);
    std::array<LaneArray, 2> per_sr;
    branching_.branch(where, throughput, sampled_answer(where, change, shaded, per_sr), next);
  }

  // The answer with rays drawn for its rough lobes; `per_sr` holds their densities.
  SurfaceAnswer sampled_answer(const FanAtSurface& where, const MediumChange& change,
                               const ShadedSurface& surface, std::array<LaneArray, 2>& per_sr) {
    const D d;
    const Fan& fan = where.fan;
    const LayerLanes* layers = surface.at.layers;
    SurfaceAnswer answer;
    Lobe* sampled = &answer.lobes[0];
    if (surface.has_rough_lobe) {
      const MicrofacetLanes facets = SampleMicrofacets(
          d, stride_, surface.hit, surface.at, fan.spread, chance_of(fan, Purpose::Microfacet));
      answer = AnswerOf(d, stride_, change, surface.rows, surface.hit, surface.at, &facets);
      if (layers != nullptr && answer.lobe_count > 1) {
        multiply(layers->coat_through, answer.lobes[1].share);
      }
      // A smooth coat's own ray.
      for (std::size_t i = answer.lobe_count; i < surface.answer.lobe_count; ++i) {
        answer.lobes[answer.lobe_count++] = surface.answer.lobes[i];
      }
    } else {
      answer = surface.answer;
      sampled = &answer.lobes[answer.lobe_count++];
      sampled->made_by = FanOrigin::Reflected;
      sampled->order = 1;
      sampled->spreads = false;
      sampled->media = change.before;
    }
    sampled->is_sampled = true;
    sampled->is_straight = false;
    if (surface.rebound != nullptr || layers != nullptr) {
      ChooseRay(d, stride_, surface, fan.spread, chance_of(fan, Purpose::Rebound),
                random_1d(samples_[fan.sample].chance, fan.path, Purpose::Layer),
                chance_of(fan, Purpose::Microfacet, 1), *sampled);
    }
    if (has_beams_) fill_width(fan, surface, answer, *sampled);
    if (!shares_light(world_)) return answer;
    answer.rough_samples = light_samples_at(fan, surface).rough;
    answer.is_lit_from_behind = surface.behind != nullptr;
    for (int i = 0; i < stride_; i += static_cast<int>(hn::Lanes(d))) {
      hn::Store(SampledDensity(d, surface, i, Load3(d, sampled->direction, i)), d, per_sr[0].v + i);
    }
    sampled->per_sr = &per_sr[0];
    if (surface.behind == nullptr) return answer;
    Lobe& refracted = answer.lobes[1];
    for (int i = 0; i < stride_; i += static_cast<int>(hn::Lanes(d))) {
      const auto from = ScatteredFromBehind(d, surface, i, Load3(d, refracted.direction, i));
      hn::Store(from.density, d, per_sr[1].v + i);
    }
    refracted.per_sr = &per_sr[1];
    return answer;
  }

  // How much of their lobes the rays drawn by chance stand for.
  HWY_NOINLINE void fill_width(const Fan& fan, const ShadedSurface& surface, SurfaceAnswer& answer,
                               Lobe& sampled) const {
    const D d;
    const int lane = surface.hit.lanes.front();
    const int i = lane - lane % static_cast<int>(hn::Lanes(d));
    const std::uint32_t before = samples_[fan.sample].chance.index;
    LaneArray per_sr;
    hn::Store(SampledDensity(d, surface, i, Load3(d, sampled.direction, i)), d, per_sr.v + i);
    sampled.width_rad = lobe_width_rad(per_sr[lane], before);
    if (!surface.has_rough_lobe || answer.lobe_count < 2) return;
    Lobe& refracted = answer.lobes[1];
    if (refracted.made_by != FanOrigin::Refracted) return;
    hn::Store(ScatteredFromBehind(d, surface, i, Load3(d, refracted.direction, i)).density, d,
              per_sr.v + i);
    refracted.width_rad = lobe_width_rad(per_sr[lane], before);
  }

  void multiply(const LaneArray& by, LaneArray& values) const {
    const D d;
    for (int i = 0; i < stride_; i += static_cast<int>(hn::Lanes(d))) {
      hn::Store(hn::Mul(hn::Load(d, values.v + i), hn::Load(d, by.v + i)), d, values.v + i);
    }
  }

  // Whether a smooth surface is rough along one direction.
  static bool is_brushed(const LayerLanes* layers, int lane) {
    return layers != nullptr && layers->is_anisotropic &&
           layers->alpha_t[lane] > 1.01f * kSmoothRoughness * kSmoothRoughness;
  }

  // A coat is on top of what shines.
  void dim_emission(const LayerLanes& layers, LaneArray& emission) const {
    if (!layers.has_coat || layers.coat_is_behind) return;
    for (int lane = 0; lane < stride_; ++lane) {
      emission[lane] *= 1.0f - layers.coat[lane] * layers.coat_view[lane];
    }
  }

  // Light from all around, met by lanes that met nothing else: as it is outside of all bodies.
  template <class DirectionOf>
  void see_environment(const FanList& list, const Fan& fan, const LaneMask& lanes,
                       const LaneArray& throughput, const DirectionOf& direction_of) {
    if (!world_.environment) return;
    const bool is_background = fan.first_turn == FanOrigin::Camera;
    if (is_background && !world_.environment->is_visible()) return;
    const int set = samples_[fan.sample].set;
    float* sum = b_.local_light.data() + static_cast<std::size_t>(fan.sample) * stride_;
    float* emitted_part = part(fan, LightPart::Emitted);
    LaneArray light;
    Vec3f last(0.0f);
    float per_sr = 0.0f;
    bool any = false;
    for (int lane = 0; lane < world_.lanes.lane_count(); ++lane) {
      if (!lanes.test(lane)) continue;
      const Vec3f direction = direction_of(lane);
      if (!any || direction != last) {
        world_.environment->radiance(world_.lanes, world_.rows, set, direction, light.v);
        if (fan.shared.any()) per_sr = environment_density(fan.shared, direction);
        last = direction;
        any = true;
      }
      float arrived = throughput[lane] * light[lane];
      if (fan.shared.any()) {
        arrived *= share_of_ray(fan.shared, list.per_sr(fan, lane, stride_), per_sr);
      }
      sum[lane] += arrived;
      if (emitted_part != nullptr) emitted_part[lane] += arrived;
    }
  }

  // With which an environment was sampled for the surface that a fan has come from.
  float environment_density(const SharedRays& shared, const Vec3f& direction) const {
    return world_.environment->cells().density(shared.normal, shared.environment, direction);
  }

  bool is_in_fog(const Fan& fan) const { return world_.fog && fan.media.empty(); }

  LaneArray throughput_of(const FanList& list, const Fan& fan) const {
    LaneArray throughput;
    std::copy_n(list.pool.data() + fan.data, stride_, throughput.v);
    return throughput;
  }

  // Of other lanes nothing.
  LaneArray among(const LaneArray& throughput, const LaneMask& lanes) const {
    const D d;
    LaneArray kept;
    for (int i = 0; i < stride_; i += static_cast<int>(hn::Lanes(d))) {
      hn::Store(hn::IfThenElseZero(LanesFrom(d, lanes, i), hn::Load(d, throughput.v + i)), d,
                kept.v + i);
    }
    return kept;
  }

  // What the medium of arrival, or fog, takes on the segment that ends here.
  void absorb(const Fan& fan, const MediumChange& change, const LaneArray& distance_m,
              LaneArray& throughput) const {
    const D d;
    const SurfaceMaterial* medium =
        change.arrives_in ? &world_.materials[*change.arrives_in] : nullptr;
    if (medium != nullptr && medium->absorption_per_m) {
      const float* per_m = world_.row(*medium->absorption_per_m, samples_[fan.sample].set);
      Attenuate(d, stride_, per_m, distance_m, throughput);
    }
    if (is_in_fog(fan)) {
      Attenuate(d, stride_, world_.fog->extinction_per_m, distance_m, throughput);
    }
  }

  Vec2f chance_of(const Fan& fan, Purpose purpose, std::uint32_t item = 0) const {
    return random_2d(samples_[fan.sample].chance, fan.path, purpose, item);
  }

  void keep_albedo(const Fan& fan, const LaneArray& base_color) const {
    const std::size_t place = std::size_t{fan.sample} * static_cast<std::size_t>(stride_);
    std::copy_n(base_color.v, stride_, results_.albedo.data() + place);
  }

  // Whether a surface of that albedo has a broad lobe: polished glass and metal show no lamp as a
  // point.
  bool scatters(const LaneArray& albedo) const {
    const D d;
    auto any = hn::Zero(d);
    for (int i = 0; i < stride_; i += static_cast<int>(hn::Lanes(d))) {
      any = hn::Max(any, hn::Load(d, albedo.v + i));
    }
    return !hn::AllTrue(d, hn::Le(any, hn::Zero(d)));
  }

  // Emission, and ambient light: k_a defaults to the albedo of what no ray stands for.
  void add_local_light(const Fan& fan, const SurfaceMaterial& material, const LaneArray& emission,
                       const SurfaceAnswer& answer, const LaneArray& albedo,
                       const LaneArray& throughput, bool hidden) {
    const bool ambient = world_.ambient && !hidden && !material.unlit;
    if (!material.emission && !ambient) return;
    const D d;
    const int set = samples_[fan.sample].set;
    float* sum = b_.local_light.data() + static_cast<std::size_t>(fan.sample) * stride_;
    const float* ambient_row = ambient ? world_.row(*world_.ambient, set) : nullptr;
    float* emitted_part = part(fan, LightPart::Emitted);
    float* ambient_part = part(fan, LightPart::Ambient);
    for (int i = 0; i < stride_; i += static_cast<int>(hn::Lanes(d))) {
      auto light = hn::Load(d, emission.v + i);
      const auto basic =
          hn::Mul(hn::Load(d, throughput.v + i), hn::Load(d, answer.inverse_n2.v + i));
      const auto add = [&](auto value, float* to) HWY_ATTR {
        hn::StoreU(hn::Add(hn::LoadU(d, to + i), hn::Mul(basic, value)), d, to + i);
      };
      if (emitted_part != nullptr) add(light, emitted_part);
      if (ambient) {
        const auto k_a = material.ambient_factor ? hn::Set(d, *material.ambient_factor)
                                                 : hn::Load(d, albedo.v + i);
        const auto ambient_light = hn::LoadU(d, ambient_row + i);
        if (ambient_part != nullptr) {
          const auto part = hn::Mul(hn::Mul(basic, k_a), ambient_light);
          hn::StoreU(hn::Add(hn::LoadU(d, ambient_part + i), part), d, ambient_part + i);
        }
        light = hn::Add(light, hn::Mul(k_a, ambient_light));
      }
      add(light, sum);
    }
  }

  // Where a part of a fan's light belongs, where anybody asks for parts.
  float* part(const Fan& fan, LightPart kind) const {
    if (results_.light_parts.empty()) return nullptr;
    return part_of(results_.light_parts, fan.sample, fan.first_turn, kind, stride_);
  }

  void keep_first_hit(const Fan& fan, const SurfacePoint& point, float distance_m) {
    FirstHit& hit = results_.first_hits[fan.sample];
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
  const SampleResults& results_;
  IntegratorStats& stats_;
  IntegratorScratch::Buffers& b_;
  FanRecorder recorder_;
  ShadowQueue<D> shadows_;
  DirectLight<D> lamps_;
  FogLight<D> fog_;
  const int stride_;
  const bool has_beams_ = !world_.textures.empty();

  FanHits<D> found_;
  Branching<D> branching_;
};

void TraceSamples(const LitWorld& world, const IntegratorSettings& settings,
                  std::span<const CameraSample> samples, const SampleResults& results,
                  IntegratorStats& stats, IntegratorScratch::Buffers& buffers) {
  const auto trace = [&](auto d) {
    Tracer<decltype(d)>(world, settings, samples, results, stats, buffers).run();
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
