/// The illumination equation, solved over fans of wavelengths in batches.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "abbe/caustics/lit_world.h"
#include "abbe/film/pixel_kernel.h"
#include "abbe/integrate/fan_origin.h"
#include "abbe/integrate/record.h"
#include "abbe/math/random.h"
#include "abbe/math/ray.h"

namespace abbe {

/// How far fans are followed.
struct IntegratorSettings {
  int max_depth = 16;    ///< Most surfaces a path may leave.
  float cutoff = 1e-4f;  ///< Weight below which a fan no longer branches, 0 to branch always.
  bool drop = false;     ///< Whitted's plain rule: below the cutoff a fan ends, its energy is lost.
  /// Whether rough metals give back what single scattering on their microfacets loses.
  bool multiple_scattering = false;
  /// For heat maps: whether the work of each sample is counted, every ray by itself.
  bool counts_cost = false;
  /// For comparison only: 0 lets spread fans travel as packets. Otherwise a fan that would spread
  /// splits into united fans of this many neighbouring lanes, which follow the middle one: 1 is a
  /// ray for each wavelength, more are clusters of wavelengths.
  /// Source: Evans & McCool, Stratified wavelength clusters for efficient spectral Monte Carlo
  ///         rendering, Graphics Interface 1999.
  int cluster_lanes = 0;
  PixelKernel kernel = {};  ///< What the camera samples of a pixel are drawn from.
};

/// Fans that are traced and shaded together.
inline constexpr std::size_t kBatchFans = 256;

/// Most fans that can wait in a thread's queue while `samples` are traced: a batch of fans has at
/// most a child of every lobe for each of its lanes and one more that passes, at every depth.
inline std::size_t queue_capacity(const IntegratorSettings& settings, std::size_t samples,
                                  int lane_count) {
  return samples + static_cast<std::size_t>(settings.max_depth) * kBatchFans * (kMaxLobes + 1) *
                       static_cast<std::size_t>(lane_count);
}

/// A ray that a camera has sent, with what it carries.
struct CameraSample {
  Vec3f origin{0.0f};
  Vec3f direction{0.0f, 0.0f, -1.0f};  ///< Unit length.
  float footprint_m = 0.0f;            ///< Width of the pixel's beam at the origin.
  float footprint_per_m = 0.0f;        ///< Growth of that width with distance.
  // For what can be averaged over the pixel: how origin and direction change per pixel to the right
  // and down, and where on the film the ray goes, seen from the pixel's centre. All zero: nothing
  // is averaged.
  std::array<Vec3f, 2> origin_per_px{Vec3f(0.0f), Vec3f(0.0f)};
  std::array<Vec3f, 2> direction_per_px{Vec3f(0.0f), Vec3f(0.0f)};
  Vec2f offset_px{0.0f};
  int set = 0;          ///< Wavelength set.
  SampleChance chance;  ///< What its random numbers belong to.
  float u_fog = 0.5f;   ///< In [0, 1): place in fog, stratified over the samples of a pixel.
};

/// What a camera ray met first, for extra channels.
struct FirstHit {
  bool is_hit = false;
  Vec3f position{0.0f};
  Vec3f normal{0.0f};
  Vec2f uv{0.0f};
  float distance_m = 0.0f;
  std::uint32_t object = 0;
  std::uint32_t material = 0;
  Vec3f albedo_rec709{0.0f};
  QueryCost cost;  ///< Of all the sample's rays, if it is counted.
};

/// Where the light of a sample came from, as seen from the surface that the camera ray met (through
/// partly transparent ones: the first that was not passed). Their sum is the radiance.
enum class LightPart : std::uint8_t {
  Direct,     ///< Of lamps, off that surface.
  Ambient,    ///< The ambient light there.
  Emitted,    ///< What the surface emits.
  Reflected,  ///< All that came by its reflected ray.
  Refracted,  ///< All that came by its refracted ray.
};
inline constexpr std::size_t kLightParts = 5;

/// Room for what is found along camera samples; all but radiance may be empty.
struct SampleResults {
  /// samples × lane_stride: per lane W·m⁻²·sr⁻¹·nm⁻¹ (of a line lane: without nm⁻¹); in RGB modes
  /// cd/m².
  std::span<float> radiance;
  std::span<FirstHit> first_hits = {};  ///< One per sample.
  std::span<float> light_parts = {};    ///< samples × kLightParts × lane_stride.
  std::span<float> albedo = {};         ///< samples × lane_stride: base colour of the first hit.
  std::vector<FanRecord>* records = nullptr;  ///< See record.h.
};

/// Counts of what was done, summed over threads by the caller.
struct IntegratorStats {
  std::uint64_t camera_rays = 0, reflected_rays = 0, refracted_rays = 0, passed_rays = 0,
                shadow_rays = 0;
  std::uint64_t united_fans = 0, spread_fans = 0;
  /// Spread fans and the lanes alive in them by depth, the last entry for all that is deeper.
  static constexpr std::size_t kDepths = 33;
  std::array<std::uint64_t, kDepths> spread_fans_at{}, spread_lanes_at{};
  std::uint64_t peak_queued_fans = 0;
  std::uint64_t peak_queue_bytes = 0;
  /// Thread time that paths of lamps' light over flat glass and mirrors took: where that light is
  /// found, not what stands on its way.
  double bent_light_seconds = 0.0;
  double weight_started = 0.0;         ///< Sum of the camera fans' weights.
  double weight_lost_to_depth = 0.0;   ///< Weight of children not followed at the depth limit.
  double weight_lost_to_cutoff = 0.0;  ///< With `drop`: weight of fans ended.

  void add(const IntegratorStats& other);
};

/// Working memory of one thread; reused from tile to tile.
class IntegratorScratch {
 public:
  IntegratorScratch();
  IntegratorScratch(IntegratorScratch&&) noexcept;
  ~IntegratorScratch();

  struct Buffers;
  Buffers& buffers() { return *buffers_; }

 private:
  std::unique_ptr<Buffers> buffers_;
};

/// Radiance that arrives along each camera sample, written to `results`.
/// The result of a sample does not depend on the others: its sums are taken in an order that
/// follows from its own fans alone.
void trace_samples(const LitWorld& world, const IntegratorSettings& settings,
                   std::span<const CameraSample> samples, const SampleResults& results,
                   IntegratorStats& stats, IntegratorScratch& scratch);

}  // namespace abbe
