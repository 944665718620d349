/// Light from lamps: what would arrive at a batch of fans. Highway code, compiled once per
/// instruction set.

#if defined(ABBE_INTEGRATE_LIGHT_DIRECT_LIGHT_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef ABBE_INTEGRATE_LIGHT_DIRECT_LIGHT_INL_H_
#undef ABBE_INTEGRATE_LIGHT_DIRECT_LIGHT_INL_H_
#else
#define ABBE_INTEGRATE_LIGHT_DIRECT_LIGHT_INL_H_
#endif

#include <algorithm>
#include <array>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <span>

#include "abbe/caustics/flat/light/drawn_place.h"
#include "abbe/caustics/flat/light/known_misses.h"
#include "abbe/caustics/flat/light/parallel-inl.h"
#include "abbe/caustics/flat/light/point-inl.h"
#include "abbe/integrate/integrator.h"
#include "abbe/integrate/light/chain_gates-inl.h"
#include "abbe/integrate/light/emitted-inl.h"
#include "abbe/integrate/light/pixel.h"
#include "abbe/integrate/light/reflected_light-inl.h"
#include "abbe/integrate/light/shared_light-inl.h"
#include "abbe/optics/absorption-inl.h"
#include "abbe/world/light/lights-inl.h"

HWY_BEFORE_NAMESPACE();
namespace abbe {
namespace HWY_NAMESPACE {

/// The light of lamps on the surfaces of one batch.
template <class D>
class DirectLight {
 public:
  DirectLight(const LitWorld& world, const IntegratorSettings& settings,
              std::span<const CameraSample> samples, ShadowQueue<D>& shadows, KnownMisses& misses,
              IntegratorStats& stats)
      : world_(world),
        caustics_(world.caustics),
        settings_(settings),
        samples_(samples),
        shadows_(shadows),
        misses_(misses),
        stats_(stats),
        rays_may_bend_((world.visibility_bits & passing_bits(AtGlass::Passes)) != 0),
        stride_(world.lanes.lane_stride()) {
    misses_.start(caustics_.point.chains.size());
  }

  /// Notes the light of every lamp on a surface, to be resolved with the batch.
  void send(const LitSurface& surface) {
    const D d;
    const Fan& fan = surface.where.fan;
    const SurfaceHit& hit = surface.where.hit;
    if (hit.contact != nullptr && hit.contact->arrival == Nearby::Opaque) return;
    const int set = samples_[fan.sample].set;
    const float fog_per_m = world_.fog && fan.media.empty() ? world_.fog->extinction_per_m : 0.0f;
    LightGeometry to_light;
    for (const WorldLight& light : world_.lights) {
      if (light.extent) {
        send_extended(surface, light, fog_per_m, to_light);
        continue;
      }
      StraightLight(d, stride_, light, world_.row(light.row, set), hit.position, to_light);
      if (fog_per_m > 0.0f && light.has_distance()) {
        Attenuate(d, stride_, fog_per_m, to_light.distance_m, to_light.irradiance);
      }
      ShadowJob job;
      const auto lamp = static_cast<std::uint32_t>(&light - world_.lights.data());
      job.at_glass = rule_of(caustics_, lamp);
      if (!begin_job(surface, to_light, job)) continue;
      job.departure = departure_from(hit, job.lanes, to_light.direction);
      // Camera rays of neighbouring pixels mostly meet the same surface.
      shadows_.add(
          job, [&](int lane) { return shadow_ray(hit, to_light, lane); },
          fan.depth == 0 ? lamp : kIncoherent);
    }
    if (world_.environment) send_environment(surface, to_light);
    if (world_.emitters) send_emitters(surface, to_light);
    send_bent(surface);
  }

 private:
  static constexpr std::uint32_t kPlacesSeen = 4;
  // Of fewer chains all are followed.
  static constexpr std::size_t kManyChains = 32;
  // A chain that brings less than this share of its lamp's straight light brings little.
  static constexpr float kLittle = 0.01f;
  static constexpr float kLeastChance = 0.0625f;

  // Straight light of a lamp with an extent, of all lobes: no ray meets it.
  void send_extended(const LitSurface& surface, const WorldLight& light, float fog_per_m,
                     LightGeometry& to_light) {
    const D d;
    const Fan& fan = surface.where.fan;
    const SurfaceHit& hit = surface.where.hit;
    const CameraSample& sample = samples_[fan.sample];
    const auto lamp = static_cast<std::uint32_t>(&light - world_.lights.data());
    const Vec3f from = hit.position.get(hit.lanes.front());
    const float* row = world_.row(light.row, sample.set);
    const std::uint32_t count = fan.depth == 0 ? kPlacesSeen : 1;
    LaneArray radiance;
    WorldEmitters::Spot place;
    for (std::uint32_t number = 0; number < count; ++number) {
      const Vec2f u =
          random_2d(sample.chance, fan.path, Purpose::LightPoint, lamp * kPlacesSeen + number);
      if (light.is_parallel) {
        const SkyDiscRay ray = direction_to_disc(*light.extent, -light.direction, u);
        Splat(d, stride_, ray.direction, to_light.direction);
        Splat(d, stride_, kInfinity, to_light.distance_m);
        const float share = ray.irradiance / static_cast<float>(count);
        for (int lane = 0; lane < stride_; ++lane) to_light.irradiance[lane] = share * row[lane];
      } else {
        const auto spot = spot_on_lamp(*light.extent, light.position, light.direction, from, u);
        if (!spot) continue;
        for (int lane = 0; lane < stride_; ++lane) radiance[lane] = spot->radiance * row[lane];
        place = {.position = spot->position,
                 .normal = spot->normal,
                 .per_m2 = spot->per_m2 * static_cast<float>(count)};
        LightFromSpot(place, stride_, radiance, hit.position, to_light);
        cut_to_window(light, to_light);
        if (fog_per_m > 0.0f) {
          Attenuate(d, stride_, fog_per_m, to_light.distance_m, to_light.irradiance);
        }
      }
      ShadowJob job;
      job.at_glass = rule_of(caustics_, lamp);
      if (!begin_job(surface, to_light, job)) continue;
      job.departure = departure_from(hit, job.lanes, to_light.direction);
      shadows_.add(job, [&](int lane) {
        return light.is_parallel ? shadow_ray(hit, to_light, lane)
                                 : ray_to_spot(place, 0.0f, origin_of(hit, to_light, lane));
      });
    }
  }

  // What the lamp's range and cone leave.
  void cut_to_window(const WorldLight& light, LightGeometry& to_light) const {
    const D d;
    for (int i = 0; i < stride_; i += static_cast<int>(hn::Lanes(d))) {
      const auto cosine = Dot3(d, Load3(d, to_light.direction, i), Set3(d, -light.direction));
      const auto window = LampWindow(d, light, hn::Load(d, to_light.distance_m.v + i), cosine);
      hn::Store(hn::Mul(hn::Load(d, to_light.irradiance.v + i), window), d,
                to_light.irradiance.v + i);
    }
  }

  // Light from all around, straight through all glass.
  void send_environment(const LitSurface& surface, LightGeometry& to_light) {
    const D d;
    const Fan& fan = surface.where.fan;
    const SurfaceHit& hit = surface.where.hit;
    const CameraSample& sample = samples_[fan.sample];
    const LightSamples samples = light_samples_at(fan, surface.shaded);
    LaneArray density;
    LightCells::Seen seen;
    world_.environment->cells().look(
        lit_place(world_, hit, samples.rough, surface.shaded.behind != nullptr).normal, seen);
    for (std::uint32_t number = 0; number < samples.all; ++number) {
      const auto drawn = world_.environment->cells().draw(
          seen, random_2d(sample.chance, fan.path, Purpose::Environment, number));
      if (!drawn) continue;
      Splat(d, stride_, drawn->direction, to_light.direction);
      Splat(d, stride_, kInfinity, to_light.distance_m);
      world_.environment->radiance(world_.lanes, world_.rows, sample.set, drawn->direction,
                                   to_light.irradiance.v);
      Splat(d, stride_, drawn->density, density);
      for (int lane = 0; lane < stride_; ++lane) to_light.irradiance[lane] /= drawn->density;
      send_shared(surface, to_light, density, 0.0f, samples, number, std::nullopt,
                  [&](int lane) { return shadow_ray(hit, to_light, lane); });
    }
  }

  // Light of surfaces that shine, as that from all around.
  void send_emitters(const LitSurface& surface, LightGeometry& to_light) {
    const D d;
    const Fan& fan = surface.where.fan;
    const SurfaceHit& hit = surface.where.hit;
    const CameraSample& sample = samples_[fan.sample];
    const LightSamples samples = light_samples_at(fan, surface.shaded);
    const SharedRays lit = lit_place(world_, hit, samples.rough, surface.shaded.behind != nullptr);
    const auto first_item = static_cast<std::uint32_t>(world_.lights.size()) * kPlacesSeen;
    LaneArray radiance, density;
    for (std::uint32_t number = 0; number < samples.all; ++number) {
      std::optional<WorldEmitters::Spot> spot = world_.emitters->draw(
          {lit.place, lit.normal},
          random_2d(sample.chance, fan.path, Purpose::LightPoint, first_item + number));
      if (!spot) continue;
      const float rounding_m = EmissionAt(d, world_, *spot, sample.set, radiance);
      DimByCoat(world_, *spot, hit.position, surface.shaded.rows.n_medium, radiance);
      LightFromSpot(*spot, stride_, radiance, hit.position, to_light, &density);
      const float fog_per_m = world_.fog ? world_.fog->extinction_per_m : 0.0f;
      send_shared(
          surface, to_light, density, fog_per_m, samples, number,
          ShadowEnd{world_.geometry.surface_of(spot->primitive), spot->normal, rounding_m},
          [&](int lane) { return ray_to_spot(*spot, rounding_m, origin_of(hit, to_light, lane)); });
    }
  }

  // Notes light that the rays of rough lobes may find as well. Where there is something that such
  // rays do not pass straight, what those lobes send on is a job of its own, with the same shadow
  // ray.
  template <class RayOf>
  void send_shared(const LitSurface& surface, const LightGeometry& to_light,
                   const LaneArray& density, float fog_per_m, const LightSamples& samples,
                   std::uint32_t number, const std::optional<ShadowEnd>& shining,
                   const RayOf& ray_of) {
    const D d;
    const SurfaceHit& hit = surface.where.hit;
    LaneArray broad, rough, through;
    ReflectSharedLight(d, stride_, surface, to_light, density, samples, number, broad, rough,
                       through);
    const MediumStack* behind = surface.shaded.behind;
    const auto dim_by_fog = [&](const MediumStack& media, LaneArray& light) {
      if (!(fog_per_m > 0.0f) || !media.empty()) return;
      Attenuate(d, stride_, fog_per_m, to_light.distance_m, light);
    };
    dim_by_fog(surface.where.fan.media, broad);
    dim_by_fog(surface.where.fan.media, rough);
    ShadowJob job;
    if (behind != nullptr) {
      dim_by_fog(*behind, through);
      ShadowJob beyond;
      beyond.is_unbent = true;
      beyond.ends_on = shining;
      if (note(surface, through, beyond)) {
        beyond.media = *behind;
        beyond.departure = departure_from(hit, beyond.lanes, to_light.direction);
        shadows_.add(beyond, ray_of);
      }
    }
    if (rays_may_bend_) {
      ShadowJob unbent;
      unbent.is_unbent = true;
      unbent.ends_on = shining;
      const bool has_broad = note(surface, broad, job);
      const bool has_rough = note(surface, rough, unbent);
      if (has_broad && has_rough) job.lanes = unbent.lanes = job.lanes | unbent.lanes;
      const auto start = [&](ShadowJob& first) {
        first.departure = departure_from(hit, first.lanes, to_light.direction);
        shadows_.add(first, ray_of);
      };
      if (has_broad) start(job);
      if (has_broad && has_rough) {
        unbent.departure = job.departure;
        shadows_.add_beside(job, unbent);
      } else if (has_rough) {
        start(unbent);
      }
      return;
    }
    for (int i = 0; i < stride_; i += static_cast<int>(hn::Lanes(d))) {
      hn::Store(hn::Add(hn::Load(d, broad.v + i), hn::Load(d, rough.v + i)), d, broad.v + i);
    }
    if (!note(surface, broad, job)) return;
    job.departure = departure_from(hit, job.lanes, to_light.direction);
    shadows_.add(job, ray_of);
  }

  // Room for light that a surface sends on; false when no lane gets any.
  bool note(const LitSurface& surface, const LaneArray& light, ShadowJob& job) {
    std::copy_n(light.v, stride_, shadows_.reserve(job));
    return complete(surface, job);
  }

  // Room for the light of a lamp and what it adds; false when no lane gets any.
  bool begin_job(const LitSurface& surface, const LightGeometry& to_light, ShadowJob& job) {
    float* contribution = shadows_.reserve(job);
    ReflectLight(D(), stride_, surface, to_light, contribution);
    return complete(surface, job);
  }

  bool complete(const LitSurface& surface, ShadowJob& job) {
    const Fan& fan = surface.where.fan;
    if (!shadows_.keep_lit(job, surface.where.hit.lanes)) return false;
    job.sample = fan.sample;
    job.record = surface.where.record_number;
    job.media = fan.media;
    job.spread = fan.spread;
    job.first_turn = fan.first_turn;
    return true;
  }

  void send_parallel_chains(const LitSurface& surface, const ChainsNear& chains_near,
                            bool follows_all) {
    if (chains_near.parallel_count == 0) return;
    const Fan& fan = surface.where.fan;
    const SurfaceHit& hit = surface.where.hit;
    const int set = samples_[fan.sample].set;
    const Vec3f center = hit.position.get(hit.lanes.front());
    const float rounding_m = LargestOf(D(), stride_, hit.offset_m, hit.lanes);
    const float radius_m = radius_of(surface.where, center) + rounding_m;
    PixelOnSurface pixel;
    if (fan.depth == 0 && !fan.spread) {
      pixel = pixel_on_surface(samples_[fan.sample], settings_.kernel, surface.where.path_length_m,
                               hit.outward.get(0));
    }
    LightGeometry to_light;
    ChainPlaces met;
    const float reach_m = radius_m + pixel.reach_m;
    const std::vector<ParallelChain>& chains = caustics_.parallel.chains;
    const auto may = [&](std::uint32_t number, const Vec3f& place, float ball_m) {
      return may_light(chains[number], place, ball_m);
    };
    for (const std::uint32_t number : chains_near.parallel.near(center, reach_m, may)) {
      const ParallelChain& chain = chains[number];
      if (!may_light(chain, center, reach_m)) continue;
      if (!comes_in(chain.ends_in(), fan.media)) continue;
      const float times = follows_all ? 1.0f : times_followed(fan, number, chain.weight);
      if (times == 0.0f) continue;
      ParallelChainLight<D> light(world_, caustics_, chain, set);
      if (!light.run(hit.position, rounding_m, pixel, to_light, met)) continue;
      scale(times, to_light);
      LaneArray3 shift_m;
      if (light.is_shifted()) find_shifts(light, surface, to_light, shift_m);
      send_arrived(chain, surface, !chain.disperses && !fan.spread, to_light, met,
                   light.is_shifted() ? &shift_m : nullptr);
    }
  }

  // Light that comes over flat glass and mirrors, and how long that takes to find.
  void send_bent(const LitSurface& surface) {
    if (caustics_.parallel.chains.empty() && caustics_.point.chains.empty()) return;
    const auto start = std::chrono::steady_clock::now();
    const ChainsNear* of_place = nullptr;
    if (!caustics_.near_places.empty()) {
      const Fan& fan = surface.where.fan;
      of_place =
          &caustics_.near_places[drawn_place(caustics_, samples_[fan.sample].chance, fan.path)];
    }
    const ChainsNear& of_lamps = caustics_.near;
    const auto in_all = [&](std::size_t ChainsNear::*count) {
      return of_lamps.*count + (of_place != nullptr ? of_place->*count : 0);
    };
    const bool follows_parallel = follows_all_of(in_all(&ChainsNear::parallel_count));
    const bool follows_point = follows_all_of(in_all(&ChainsNear::point_count));
    for (const ChainsNear* near : {&of_lamps, of_place}) {
      if (near == nullptr) continue;
      send_parallel_chains(surface, *near, follows_parallel);
      send_point_chains(surface, *near, follows_point);
    }
    const std::chrono::duration<double> elapsed = std::chrono::steady_clock::now() - start;
    stats_.bent_light_seconds += elapsed.count();
  }

  void send_point_chains(const LitSurface& surface, const ChainsNear& chains_near,
                         bool follows_all) {
    if (chains_near.point_count == 0) return;
    const Fan& fan = surface.where.fan;
    const SurfaceHit& hit = surface.where.hit;
    const int set = samples_[fan.sample].set;
    const Vec3f center = hit.position.get(hit.lanes.front());
    const float rounding_m = LargestOf(D(), stride_, hit.offset_m, hit.lanes);
    const float radius_m = radius_of(surface.where, center) + rounding_m;
    LightGeometry to_light;
    ChainPlaces met;
    const PointChains& all = caustics_.point;
    const PointChainGroup* group = nullptr;
    PlaceInGroup place;
    LanesInGroup<D> places;  // Of a spread fan.
    LaneMask among;          // Those that the group may light.
    const auto may = [&](std::uint32_t number, const Vec3f& ball, float ball_m) {
      return may_light(all, all.chains[number], ball, ball_m);
    };
    // Chains of a group follow each other.
    for (const std::uint32_t number : chains_near.point.near(center, radius_m, may)) {
      const PointChain& chain = all.chains[number];
      if (group != &all.groups[chain.group]) {
        group = &all.groups[chain.group];
        among = {};
        if (comes_in(group->ends_in, fan.media) && may_light(*group, center, radius_m, place)) {
          among = fan.spread ? places.place(stride_, *group, hit.position, rounding_m, hit.lanes)
                             : hit.lanes;
        }
      }
      if (!among.any()) continue;
      LaneMask near = among;
      if (fan.spread) {
        near = places.in_bounds(stride_, all, chain, among);
        if (!near.any()) continue;
      } else if (!is_in_bounds(place, all, chain)) {
        continue;
      }
      const float times = follows_all ? 1.0f : times_followed(fan, number, share_at(chain, center));
      if (times == 0.0f || misses_.hold(number, center, radius_m)) continue;
      PointChainLight<D> light(world_, caustics_, chain, set);
      if (!light.run(hit.position, rounding_m, near, !fan.spread, to_light, met)) {
        misses_.add(number, light.middle(), light.miss());
        continue;
      }
      scale(times, to_light);
      send_arrived(chain, surface, light.is_one_path(), to_light, met, nullptr);
    }
  }

  // Of a lamp's straight light at a place, what a chain may bring, if its faces were mirrors.
  float share_at(const PointChain& chain, const Vec3f& place) const {
    const Vec3d unfolded = chain.fold * Vec3d(place - chain.origin) + chain.fold_shift;
    const Vec3d on_path = chain.lamp - unfolded;
    const Vec3f straight = caustics_.source_of(chain).position - place;
    return chain.kept * glm::dot(straight, straight) /
           static_cast<float>(glm::dot(on_path, on_path));
  }

  // Few chains are followed at all samples, and all where nothing is left to chance; what few
  // wavelengths get is not to depend on each other.
  bool follows_all_of(std::size_t chains) const {
    return chains < kManyChains || settings_.drop || settings_.cutoff == 0.0f ||
           world_.lanes.are_followed_apart();
  }

  // How often the light of a chain counts where it is followed now, or 0: of many chains those that
  // bring little are followed at some of the samples of a pixel, each by chances of its own.
  float times_followed(const Fan& fan, std::uint32_t number, float share) const {
    if (share >= kLittle) return 1.0f;
    // Halves of it, so that sixteen samples hold as many of each chain as they should.
    float chance = 0.5f;
    while (chance > kLeastChance && share < chance * kLittle) chance *= 0.5f;
    const float drawn = random_1d(samples_[fan.sample].chance, fan.path, Purpose::Light, number);
    return drawn < chance ? 1.0f / chance : 0.0f;
  }

  void scale(float times, LightGeometry& to_light) const {
    if (times == 1.0f) return;
    for (int lane = 0; lane < stride_; ++lane) to_light.irradiance[lane] *= times;
  }

  // Whether light of a chain that ends in a medium can come to a place in others.
  static bool comes_in(const std::optional<std::uint32_t>& ends_in, const MediumStack& media) {
    return !ends_in || media.owner() == ends_in;
  }

  // Of a sphere about `center` that holds the places of all lanes.
  float radius_of(const FanAtSurface& where, const Vec3f& center) const {
    if (!where.fan.spread) return 0.0f;
    return LargestDistance(D(), stride_, where.hit.position, where.hit.lanes, center);
  }

  // How far off a surface's places its light arrives. What cannot be seen from there, as behind a
  // wall that stands on it in the same pixel, is no place of it.
  void find_shifts(const ParallelChainLight<D>& light, const LitSurface& surface,
                   const LightGeometry& to_light, LaneArray3& shift_m) const {
    const SurfaceHit& hit = surface.where.hit;
    Vec3f asked(0.0f), answer(0.0f);
    for (int lane = 0; lane < stride_; ++lane) {
      const Vec3f shift = to_light.irradiance[lane] > 0.0f ? light.shift_m(lane) : Vec3f(0.0f);
      // Where all lanes go by one path they are shifted alike.
      if (shift != asked) {
        asked = shift;
        answer = is_seen(hit, lane, shift) ? shift : Vec3f(0.0f);
      }
      shift_m.set(lane, answer);
    }
  }

  bool is_seen(const SurfaceHit& hit, int lane, const Vec3f& shift) const {
    const float length_m = glm::length(shift);
    if (length_m == 0.0f) return true;
    const Vec3f from = off_surface(hit.position.get(lane), hit.outward.get(lane),
                                   hit.offset_m[lane], -hit.direction.get(lane));
    const std::array<Ray, 1> way{Ray{from, length_m, shift / length_m}};
    std::array<std::uint8_t, 1> is_blocked{};
    const auto anything = static_cast<QueryMask>(kOpaqueBit | kTransparentBit | kExactGlassBit);
    world_.accelerator->any_hits(std::span<const Ray>(way), anything, is_blocked);
    return is_blocked[0] == 0;
  }

  // Notes the light that a chain brings, on one path for all lanes or on one for each; it arrives
  // `shift_m` off the places of the surface, if that is given.
  void send_arrived(const ChainPath& chain, const LitSurface& surface, bool is_one_path,
                    const LightGeometry& to_light, const ChainPlaces& met,
                    const LaneArray3* shift_m) {
    ShadowJob job;
    if (!begin_job(surface, to_light, job)) return;
    job.spread = !is_one_path;
    job.at_glass = AtGlass::Ends;
    const auto place_of = [&](int lane) {
      const SurfaceHit& hit = surface.where.hit;
      const Vec3f shift = shift_m != nullptr ? shift_m->get(lane) : Vec3f(0.0f);
      return LitPlace{origin_of(hit, to_light, lane) + shift, hit.offset_m[lane]};
    };
    shadows_.add(job, [&](int lane) { return LastRay(chain, met, place_of(lane), lane); });
    AddGates(shadows_, world_, caustics_.source_of(chain), chain, met, job, place_of);
  }

  // Just off the surface, on the side that light comes from.
  static Vec3f origin_of(const SurfaceHit& hit, const LightGeometry& to_light, int lane) {
    return off_surface(hit.position.get(lane), hit.outward.get(lane), hit.offset_m[lane],
                       to_light.direction.get(lane));
  }

  // From there up to the light.
  static Ray shadow_ray(const SurfaceHit& hit, const LightGeometry& to_light, int lane) {
    const Vec3f direction = to_light.direction.get(lane);
    const Vec3f origin = origin_of(hit, to_light, lane);
    // The start has come nearer to the light.
    const float nearer_m = glm::dot(origin - hit.position.get(lane), direction);
    return {origin, to_light.distance_m[lane] - nearer_m, direction};
  }

  const World& world_;
  const FlatCaustics& caustics_;
  const IntegratorSettings& settings_;
  std::span<const CameraSample> samples_;
  ShadowQueue<D>& shadows_;
  KnownMisses& misses_;
  IntegratorStats& stats_;
  const bool rays_may_bend_;
  const int stride_;
};

}  // namespace HWY_NAMESPACE
}  // namespace abbe
HWY_AFTER_NAMESPACE();

#endif  // ABBE_INTEGRATE_LIGHT_DIRECT_LIGHT_INL_H_
