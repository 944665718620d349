#include "abbe/render/render.h"

#include <oneapi/tbb/enumerable_thread_specific.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <mutex>

#include "abbe/base/paged.h"
#include "abbe/color/color.h"
#include "abbe/film/filter.h"
#include "abbe/render/agreement.h"
#include "abbe/render/allocation.h"
#include "abbe/render/band_weights.h"
#include "abbe/render/extra_channels.h"
#include "abbe/render/sample_source.h"

namespace abbe {
namespace {

constexpr int kTileSize = 32;
/// Camera samples that are traced together: enough to fill batches, few enough to stay in cache.
constexpr std::size_t kWaveSamples = 512;

/// A camera sample on its way to the film.
struct Destination {
  Vec2i pixel{0};
  float weight = 1.0f;
  int step = 0, half = 0;  ///< Of SampleAllocation, if there is one.
};

/// One thread's share of the work and its memory.
struct Worker {
  IntegratorScratch scratch;
  IntegratorStats stats;
  std::vector<CameraSample> samples;
  std::vector<Destination> destinations;
  std::vector<float> radiance;
  std::vector<FirstHit> first_hits;
  std::vector<float> light_parts, albedo;  ///< Per sample and lane, where they are asked for.
  std::vector<float> bands, reflectances, aovs, folded;
};

double area_of(const PixelRect& rect) {
  return static_cast<double>(rect.width()) * rect.height();
}

/// How far all tiles are, for people.
class Pace {
 public:
  /// `first_samples`: of all tiles, in the first pass.
  Pace(const ProgressCallback& tell, double first_samples)
      : tell_(tell), first_samples_(first_samples) {}

  /// Says that samples of a tile have been taken, and that more are wanted there later.
  void advance(double taken, double wanted) {
    if (!tell_) return;
    const std::scoped_lock lock(mutex_);
    taken_ += taken;
    later_ += wanted;
    // As long as first samples are under way, tiles to come are taken for such as those before.
    const double share_known = std::min(taken_ / first_samples_, 1.0);
    fraction_ = std::max(fraction_, taken_ / (first_samples_ + later_ / share_known));
    tell_(fraction_);
  }

 private:
  const ProgressCallback& tell_;
  double first_samples_, taken_ = 0.0, later_ = 0.0, fraction_ = 0.0;
  std::mutex mutex_;
};

class Renderer {
 public:
  Renderer(const LitWorld& world, const Camera& camera, const RenderSettings& settings, Film& film)
      : world_(world),
        settings_(settings),
        source_(world, camera, settings),
        film_(film),
        integrator_(integrator_settings(settings)),
        view_{world.geometry.origin_m, Vec3f(Vec3d(camera.to_world[3])),
              Vec3f(-glm::normalize(Vec3d(camera.to_world[2])))} {
    if (settings.noise > 0.0) {
      allocation_.emplace(settings, film.options(), rec709_to_xyz() * world.lanes.film_to_rec709());
    }
    for (const std::string& group : settings.aovs) {
      has_light_parts_ = has_light_parts_ || light_part_named(group);
      has_spectral_albedo_ = has_spectral_albedo_ || group == "spectralAlbedo";
    }
    if (!settings.bands) return;
    // The wavelengths of the samples that come together divide the spectrum.
    const auto add_weights = [&](int begin, int end) {
      std::vector<int> sets;
      for (int s = begin; s < end; ++s) {
        sets.push_back(source_.set_of(static_cast<std::uint32_t>(s)));
      }
      band_weights_.emplace_back(*world.lanes.quadrature(), *settings.bands, sets);
    };
    if (!allocation_) {
      add_weights(0, settings.samples_per_pixel);
      return;
    }
    for (const SampleAllocation::Step& step : allocation_->steps()) {
      add_weights(step.begin, step.end);
    }
  }

  RenderResult run(const ProgressCallback& progress, const CancelFlag* cancel) {
    const auto start = std::chrono::steady_clock::now();
    const PixelRect region = allocation_ ? allocation_->region() : film_.crop();
    const int first = allocation_ ? allocation_->steps().front().end : settings_.samples_per_pixel;
    std::vector<PixelRect> tiles = divided(region, kTileSize);
    Pace pace(progress, area_of(region) * first);
    RenderResult result;
    std::vector<double> wanted(tiles.size(), 0.0);  // Samples that are still to come.
    result.complete = sweep(tiles, 0, cancel, [&](std::size_t i) {
      const double taken = area_of(tiles[i]) * first;
      if (allocation_) wanted[i] = decide(tiles[i]) - taken;
      pace.advance(taken, wanted[i]);
    });
    std::vector<PixelRect> rest;
    std::vector<double> of_rest;
    for (std::size_t i = 0; i < tiles.size(); ++i) {
      if (!(wanted[i] > 0.0)) continue;
      rest.push_back(tiles[i]);
      of_rest.push_back(wanted[i]);
    }
    if (result.complete && !rest.empty()) {
      ++result.sampling.passes;
      result.complete =
          sweep(rest, 1, cancel, [&](std::size_t i) { pace.advance(of_rest[i], 0.0); });
    }
    for (const Worker& worker : workers_) result.stats.add(worker.stats);
    result.queue_capacity = queue_capacity(integrator_, kWaveSamples, world_.lanes.lane_count());
    report(region, result);
    result.seconds =
        std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    return result;
  }

 private:
  // Parts of a region on a grid of the whole image, so that a crop cuts them but does not move
  // them.
  static std::vector<PixelRect> divided(const PixelRect& region, int size) {
    std::vector<PixelRect> parts;
    for (int y = region.y0 - region.y0 % size; y < region.y1; y += size) {
      for (int x = region.x0 - region.x0 % size; x < region.x1; x += size) {
        parts.push_back({std::max(x, region.x0), std::max(y, region.y0),
                         std::min(x + size, region.x1), std::min(y + size, region.y1)});
      }
    }
    return parts;
  }

  // Traces what the pixels of tiles want in a pass, in parallel; `done` is called after each.
  // Returns whether it came to its end.
  template <typename Done>
  bool sweep(const std::vector<PixelRect>& tiles, int pass, const CancelFlag* cancel,
             const Done& done) {
    std::atomic<bool> complete{true};
    const auto stopped = [&] {
      return cancel != nullptr && cancel->load(std::memory_order_relaxed);
    };
    parallel_for(0, tiles.size(), 1, [&](std::size_t i) {
      if (stopped() || !render_tile(tiles[i], pass, workers_.local(), stopped)) {
        complete.store(false, std::memory_order_relaxed);
        return;
      }
      let_go_of_pages();
      done(i);
    });
    return complete.load();
  }

  double decide(const PixelRect& tile) {
    double samples = 0.0;
    for (const PixelRect& block : divided(tile, SampleAllocation::kBlock_px)) {
      samples += allocation_->decide(block);
    }
    return samples;
  }

  void report(const PixelRect& region, RenderResult& result) const {
    SamplingReport& report = result.sampling;
    const double pixels = area_of(region);
    report.samples = static_cast<double>(result.stats.camera_rays);
    report.samples_per_pixel = report.samples / pixels;
    report.noise = settings_.noise;
    if (!allocation_ || !result.complete) return;
    double squared_error = 0.0, worst = 0.0;
    for (const PixelRect& block : divided(region, SampleAllocation::kBlock_px)) {
      const SampleAllocation::BlockError error = allocation_->error(block);
      squared_error += error.squared;
      report.unfinished += error.unfinished / pixels;
      worst = std::max(worst, error.squared / area_of(block));
    }
    report.error = std::sqrt(squared_error / pixels);
    report.worst_error = std::sqrt(worst);
  }

  template <typename Stopped>
  bool render_tile(const PixelRect& tile, int pass, Worker& worker, const Stopped& stopped) {
    for (int y = tile.y0; y < tile.y1; ++y) {
      for (int x = tile.x0; x < tile.x1; ++x) {
        if (!render_pixel({x, y}, pass, worker, stopped)) return false;
      }
    }
    trace_wave(worker);
    return true;
  }

  template <typename Stopped>
  bool render_pixel(const Vec2i& pixel, int pass, Worker& worker, const Stopped& stopped) {
    if (!allocation_) {
      for (int s = 0; s < settings_.samples_per_pixel; ++s) {
        if (!add_sample(s, {.pixel = pixel}, worker, stopped)) return false;
      }
      return true;
    }
    const std::vector<SampleAllocation::Step>& steps = allocation_->steps();
    const int end = pass == 0 ? 1 : allocation_->steps_wanted(pixel);
    for (int i = pass; i < end; ++i) {
      const SampleAllocation::Step& step = steps[static_cast<std::size_t>(i)];
      for (int s = step.begin; s < step.end; ++s) {
        const Destination to{.pixel = pixel, .step = i, .half = step.half_of(s)};
        if (!add_sample(s, to, worker, stopped)) return false;
      }
    }
    return true;
  }

  // Queues a sample, and traces those that wait once they are enough.
  template <typename Stopped>
  bool add_sample(int index, const Destination& to, Worker& worker, const Stopped& stopped) {
    const auto [sample, weight] = source_.sample(to.pixel, static_cast<std::uint32_t>(index));
    worker.samples.push_back(sample);
    worker.destinations.push_back(to);
    worker.destinations.back().weight = weight;
    if (worker.samples.size() < kWaveSamples) return true;
    if (stopped()) return false;
    trace_wave(worker);
    return true;
  }

  void trace_wave(Worker& worker) {
    const std::size_t count = worker.samples.size();
    if (count == 0) return;
    const int stride = world_.lanes.lane_stride();
    worker.radiance.resize(count * stride);
    worker.first_hits.assign(settings_.aovs.empty() ? 0 : count, FirstHit{});
    worker.light_parts.resize(has_light_parts_ ? count * kLightParts * stride : 0);
    worker.albedo.resize(has_spectral_albedo_ ? count * stride : 0);
    trace_samples(world_, integrator_, worker.samples,
                  {worker.radiance, worker.first_hits, worker.light_parts, worker.albedo},
                  worker.stats, worker.scratch);
    for (std::size_t i = 0; i < count; ++i) add_to_film(worker, i);
    worker.samples.clear();
    worker.destinations.clear();
  }

  void add_to_film(Worker& worker, std::size_t i) {
    const int stride = world_.lanes.lane_stride();
    const int set = worker.samples[i].set;
    const Destination& to = worker.destinations[i];
    const std::span<const float> radiance =
        std::span<const float>(worker.radiance).subspan(i * stride, stride);
    const Vec3d xyz = responses_of(set, radiance);
    if (allocation_) {
      allocation_->add(to.pixel, to.half, Vec3f(xyz));
      if (!film_.crop().contains(to.pixel)) return;
    }
    fill_bands(to.step, set, world_.lanes.folded(set, radiance, worker.folded), worker.bands);
    worker.aovs.clear();
    for (const std::string& group : settings_.aovs) {
      if (const auto part = light_part_named(group)) {
        const std::span<const float> light =
            std::span<const float>(worker.light_parts)
                .subspan((i * kLightParts + *part) * stride, stride);
        const Vec3f rgb_rec709(world_.lanes.film_to_rec709() * responses_of(set, light));
        worker.aovs.insert(worker.aovs.end(), {rgb_rec709.x, rgb_rec709.y, rgb_rec709.z});
      } else if (group == "spectralAlbedo") {
        fill_bands(to.step, set, std::span<const float>(worker.albedo).subspan(i * stride, stride),
                   worker.reflectances);
        worker.aovs.insert(worker.aovs.end(), worker.reflectances.begin(),
                           worker.reflectances.end());
      } else {
        append_aov(group, worker.first_hits[i], view_, worker.aovs);
      }
    }
    film_.add(to.pixel, to.weight, Vec3f(xyz), worker.bands, worker.aovs);
  }

  // What the film's observer makes of radiance on the lanes of a set.
  Vec3d responses_of(int set, std::span<const float> radiance) const {
    const int stride = world_.lanes.lane_stride();
    const float* weights = world_.xyz_weights.data() + static_cast<std::size_t>(set) * 3 * stride;
    Vec3d xyz(0.0);
    for (int lane = 0; lane < world_.lanes.lane_count(); ++lane) {
      const double value = static_cast<double>(radiance[lane]);
      xyz.x += static_cast<double>(weights[lane]) * value;
      xyz.y += static_cast<double>(weights[stride + lane]) * value;
      xyz.z += static_cast<double>(weights[2 * stride + lane]) * value;
    }
    return xyz;
  }

  void fill_bands(int step, int set, std::span<const float> lanes,
                  std::vector<float>& bands) const {
    if (!settings_.wavelengths.exact_nm.empty()) {
      bands.assign(lanes.begin(), lanes.begin() + world_.lanes.quadrature()->lane_count());
      return;
    }
    if (!settings_.bands) return;
    bands.resize(static_cast<std::size_t>(settings_.bands->count()));
    band_weights_[static_cast<std::size_t>(step)].apply(set, lanes, bands);
  }

  const LitWorld& world_;
  const RenderSettings& settings_;
  SampleSource source_;
  Film& film_;
  IntegratorSettings integrator_;
  Viewpoint view_;
  std::optional<SampleAllocation> allocation_;
  std::vector<BandWeights> band_weights_;  ///< Of the samples of each step.
  oneapi::tbb::enumerable_thread_specific<Worker> workers_;
  bool has_light_parts_ = false;
  bool has_spectral_albedo_ = false;
};

// The filter along one axis; with negative lobes it leaves the average to the samples, for no light
// is less than none.
PixelKernel kernel_of(const Filter& filter) {
  PixelKernel kernel;
  if (filter.is_negative_anywhere()) return kernel;
  kernel.radius_px = filter.radius_px();
  for (int i = 0; i <= PixelKernel::kCells; ++i) {
    const double place = 2.0 * i / PixelKernel::kCells - 1.0;
    kernel.cumulated[static_cast<std::size_t>(i)] =
        static_cast<float>(filter.share_below(place * kernel.radius_px));
  }
  return kernel;
}

}  // namespace

IntegratorSettings integrator_settings(const RenderSettings& settings) {
  return {.max_depth = settings.max_depth,
          .cutoff = static_cast<float>(settings.cutoff),
          .drop = settings.drop,
          .multiple_scattering = settings.multiple_scattering,
          .counts_cost =
              std::find(settings.aovs.begin(), settings.aovs.end(), "cost") != settings.aovs.end(),
          .cluster_lanes = settings.cluster_lanes,
          .kernel = kernel_of(Filter::named(settings.filter))};
}

FilmOptions film_options(const RenderSettings& settings) {
  FilmOptions options{.full_size = settings.size,
                      .crop = settings.crop,
                      .bands = settings.bands,
                      .lines_nm = settings.wavelengths.exact_nm,
                      .weight_magnitude = Filter::named(settings.filter).weight_magnitude()};
  for (const std::string& group : settings.aovs) {
    for (const std::string& name : aov_channel_names(group, settings)) {
      options.aovs.push_back(aov_channel(name));
    }
  }
  return options;
}

RenderResult render(const LitWorld& world, const Camera& camera, const RenderSettings& settings,
                    Film& film, const ProgressCallback& progress, const CancelFlag* cancel) {
  check_agreement(world, camera, settings, film);
  return Renderer(world, camera, settings, film).run(progress, cancel);
}

CameraSample camera_sample(const World& world, const Camera& camera, const RenderSettings& settings,
                           const Vec2i& pixel, std::uint32_t sample,
                           std::optional<Vec2f> offset_px) {
  return SampleSource(world, camera, settings).sample(pixel, sample, offset_px).sample;
}

}  // namespace abbe
