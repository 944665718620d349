/// Light from lamps: what would arrive at a batch of fans. Highway code, compiled once per
/// instruction set.

#if defined(ABBE_INTEGRATE_LIGHT_DIRECT_LIGHT_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef ABBE_INTEGRATE_LIGHT_DIRECT_LIGHT_INL_H_
#undef ABBE_INTEGRATE_LIGHT_DIRECT_LIGHT_INL_H_
#else
#define ABBE_INTEGRATE_LIGHT_DIRECT_LIGHT_INL_H_
#endif

#include <algorithm>
#include <span>

#include "abbe/integrate/buffers.h"
#include "abbe/integrate/fog/fog-inl.h"
#include "abbe/integrate/integrator.h"
#include "abbe/integrate/light/chain_gates-inl.h"
#include "abbe/integrate/light/point_chains-inl.h"
#include "abbe/integrate/surface/shade-inl.h"

HWY_BEFORE_NAMESPACE();
namespace abbe {
namespace HWY_NAMESPACE {

/// The light of lamps on the surfaces of one batch.
template <class D>
class DirectLight {
 public:
  DirectLight(const World& world, const PixelKernel& kernel, std::span<const CameraSample> samples,
              const IntegratorScratch::Buffers& buffers, ShadowQueue<D>& shadows)
      : world_(world),
        kernel_(kernel),
        samples_(samples),
        b_(buffers),
        shadows_(shadows),
        stride_(world.lanes.lane_stride()) {}

  /// Notes the light of every lamp on the lanes that lie in the buffers' interaction, to be
  /// resolved with the batch.
  void send(const Fan& fan, const LaneMask& lanes, const SurfaceMaterial& material,
            const BoundaryRows& rows, const Shading& shading, bool rough,
            std::uint32_t record_number) {
    const D d;
    const int set = samples_[fan.sample].set;
    const float fog_per_m = world_.fog && fan.media.empty() ? world_.fog->extinction_per_m : 0.0f;
    for (const WorldLight& light : world_.lights) {
      StraightLight(d, stride_, light, world_.row(light.row, set), b_.at.position, to_light_);
      if (fog_per_m > 0.0f && HasDistance(light)) {
        FogAttenuate(d, stride_, fog_per_m, to_light_.distance_m, to_light_.irradiance);
      }
      ShadowJob job;
      job.ends_at_glass = light.has_chains;
      if (!begin_job(fan, lanes, material, rows, shading, rough, record_number, job)) continue;
      // Camera rays of neighbouring pixels mostly meet the same surface.
      const auto lamp = static_cast<std::uint32_t>(&light - world_.lights.data());
      shadows_.add(
          job, [&](int lane) { return shadow_ray(lane); }, fan.depth == 0 ? lamp : kUnrelated);
    }
    if (!world_.chains.empty() || !world_.point_chains.chains.empty()) {
      send_chains(fan, lanes, material, rows, shading, rough, record_number);
    }
  }

 private:
  // Room for the light of a lamp and what it adds; false when no lane gets any.
  bool begin_job(const Fan& fan, const LaneMask& lanes, const SurfaceMaterial& material,
                 const BoundaryRows& rows, const Shading& shading, bool rough,
                 std::uint32_t record_number, ShadowJob& job) {
    const D d;
    float* contribution = shadows_.reserve(job);
    ReflectLight(d, stride_, rows, material.index_is_infinite, rough, b_.at, shading, to_light_,
                 contribution);
    if (!shadows_.keep_lit(job, lanes)) return false;
    job.sample = fan.sample;
    job.record = record_number;
    job.media = fan.media;
    job.spread = fan.spread;
    job.first_turn = fan.first_turn;
    return true;
  }

  void send_chains(const Fan& fan, const LaneMask& lanes, const SurfaceMaterial& material,
                   const BoundaryRows& rows, const Shading& shading, bool rough,
                   std::uint32_t record_number) {
    const D d;
    const int set = samples_[fan.sample].set;
    const Vec3f center = b_.at.position.get(lanes.front());
    const float radius_m =
        fan.spread ? LargestDistance(d, stride_, b_.at.position, lanes, center) : 0.0f;
    PixelOnSurface pixel;
    if (fan.depth == 0 && !fan.spread) {
      pixel = pixel_on_surface(samples_[fan.sample], kernel_,
                               fan.path_length_m + b_.at.distance_m[0], b_.at.outward.get(0));
    }
    for (const Chain& chain : world_.chains) {
      if (!may_light(chain, center, radius_m + pixel.reach_m)) continue;
      if (chain.ends_inside &&
          (fan.media.empty() || fan.media.top() != chain.steps.back().material)) {
        continue;
      }
      if (!LightOnChain(d, world_, chain, set, b_.at.position, pixel, to_light_, way_)) continue;
      send_arrived(chain, fan, lanes, material, rows, shading, rough, record_number);
    }
    for (const PointChainGroup& group : world_.point_chains.groups) {
      if (group.ends_inside && (fan.media.empty() || fan.media.top() != group.material)) continue;
      PlaceInGroup place;
      if (!may_light(group, center, radius_m, place)) continue;
      if (!is_in_bounds(place, group.reach, group.slope)) continue;
      const LaneMask among =
          fan.spread ? places_.place(stride_, group, b_.at.position, lanes) : lanes;
      if (!among.any()) continue;
      for (std::uint32_t c = group.first_chain; c < group.first_chain + group.chain_count; ++c) {
        const PointChain& chain = world_.point_chains.chains[c];
        LaneMask near = among;
        if (fan.spread) {
          near = places_.in_bounds(stride_, world_.point_chains, chain, among);
          if (!near.any()) continue;
        } else if (!is_in_bounds(place, world_.point_chains, chain)) {
          continue;
        }
        PointChainLight<D> light(world_, chain, set);
        if (!light.run(b_.at.position, near, !fan.spread, to_light_, way_)) continue;
        send_arrived(chain, fan, lanes, material, rows, shading, rough, record_number);
      }
    }
  }

  // Notes the light that a chain brings, which lies in to_light_ and way_.
  void send_arrived(const ChainPath& chain, const Fan& fan, const LaneMask& lanes,
                    const SurfaceMaterial& material, const BoundaryRows& rows,
                    const Shading& shading, bool rough, std::uint32_t record_number) {
    ShadowJob job;
    if (!begin_job(fan, lanes, material, rows, shading, rough, record_number, job)) return;
    job.spread = true;
    job.ends_at_glass = true;
    shadows_.add(job, [&](int lane) {
      return LastRay(chain, way_, origin_off_surface(lane, to_light_.direction.get(lane)), lane);
    });
    AddGates(shadows_, world_, chain, way_, job);
  }

  // Just off the surface, on the side that a direction points to.
  Vec3f origin_off_surface(int lane, const Vec3f& direction) const {
    const Vec3f outward = b_.at.outward.get(lane);
    const float side = glm::dot(direction, outward) < 0.0f ? -1.0f : 1.0f;
    return b_.at.position.get(lane) + (side * b_.at.offset_m[lane]) * outward;
  }

  // From there up to the light.
  Ray shadow_ray(int lane) const {
    const Vec3f direction = to_light_.direction.get(lane);
    const Vec3f origin = origin_off_surface(lane, direction);
    // The start has come nearer to the light.
    const float nearer_m = glm::dot(origin - b_.at.position.get(lane), direction);
    return {origin, to_light_.distance_m[lane] - nearer_m, direction};
  }

  const World& world_;
  const PixelKernel& kernel_;
  std::span<const CameraSample> samples_;
  const IntegratorScratch::Buffers& b_;
  ShadowQueue<D>& shadows_;
  const int stride_;
  LightGeometry to_light_;
  ChainWay way_;
  LanesInGroup<D> places_;  ///< Of a spread fan.
};

}  // namespace HWY_NAMESPACE
}  // namespace abbe
HWY_AFTER_NAMESPACE();

#endif  // ABBE_INTEGRATE_LIGHT_DIRECT_LIGHT_INL_H_
