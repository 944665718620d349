#include "abbe/render/render.h"

#include <oneapi/tbb/enumerable_thread_specific.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <mutex>

#include "abbe/base/paged.h"
#include "abbe/film/filter.h"
#include "abbe/render/agreement.h"
#include "abbe/render/band_weights.h"
#include "abbe/render/extra_channels.h"
#include "abbe/render/sample_source.h"

namespace abbe {
namespace {

constexpr int kTileSize = 32;
/// Camera samples that are traced together: enough to fill batches, few enough to stay in cache.
constexpr std::size_t kWaveSamples = 512;

/// One thread's share of the work and its memory.
struct Worker {
  IntegratorScratch scratch;
  IntegratorStats stats;
  std::vector<CameraSample> samples;
  std::vector<Vec2i> pixels;
  std::vector<float> weights;
  std::vector<float> radiance;
  std::vector<FirstHit> first_hits;
  std::vector<float> light_parts, albedo;  ///< Per sample and lane, where they are asked for.
  std::vector<float> bands, reflectances, aovs, folded;
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
    for (const std::string& group : settings.aovs) {
      has_light_parts_ = has_light_parts_ || light_part_named(group);
      has_spectral_albedo_ = has_spectral_albedo_ || group == "spectralAlbedo";
    }
    if (!settings.bands) return;
    std::vector<int> sets;
    for (int s = 0; s < settings.samples_per_pixel; ++s) {
      sets.push_back(source_.set_of(static_cast<std::uint32_t>(s)));
    }
    band_weights_.emplace(*world.lanes.quadrature(), *settings.bands, sets);
  }

  RenderResult run(const ProgressCallback& progress, const CancelFlag* cancel) {
    const auto start = std::chrono::steady_clock::now();
    const std::vector<PixelRect> tiles = tiles_of(film_.crop());
    std::atomic<bool> complete{true};
    std::size_t pixels_done = 0;
    const double pixel_count = static_cast<double>(film_.crop().width()) * film_.crop().height();
    std::mutex progress_mutex;
    oneapi::tbb::enumerable_thread_specific<Worker> workers;
    parallel_for(0, tiles.size(), 1, [&](std::size_t i) {
      const auto stopped = [&] {
        return cancel != nullptr && cancel->load(std::memory_order_relaxed);
      };
      if (stopped() || !render_tile(tiles[i], workers.local(), stopped)) {
        complete.store(false, std::memory_order_relaxed);
        return;
      }
      let_go_of_pages();
      if (!progress) return;
      const std::scoped_lock lock(progress_mutex);
      pixels_done += static_cast<std::size_t>(tiles[i].width()) * tiles[i].height();
      progress(static_cast<double>(pixels_done) / pixel_count);
    });
    RenderResult result;
    for (const Worker& worker : workers) result.stats.add(worker.stats);
    result.complete = complete.load();
    result.queue_capacity = queue_capacity(integrator_, kWaveSamples, world_.lanes.lane_count());
    result.seconds =
        std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    return result;
  }

 private:
  // Tiles lie on a grid of the whole image, so that a crop cuts them but does not move them.
  static std::vector<PixelRect> tiles_of(const PixelRect& crop) {
    std::vector<PixelRect> tiles;
    for (int y = crop.y0 - crop.y0 % kTileSize; y < crop.y1; y += kTileSize) {
      for (int x = crop.x0 - crop.x0 % kTileSize; x < crop.x1; x += kTileSize) {
        tiles.push_back({std::max(x, crop.x0), std::max(y, crop.y0),
                         std::min(x + kTileSize, crop.x1), std::min(y + kTileSize, crop.y1)});
      }
    }
    return tiles;
  }

  template <typename Stopped>
  bool render_tile(const PixelRect& tile, Worker& worker, const Stopped& stopped) {
    for (int y = tile.y0; y < tile.y1; ++y) {
      for (int x = tile.x0; x < tile.x1; ++x) {
        for (int s = 0; s < settings_.samples_per_pixel; ++s) {
          const auto [sample, weight] = source_.sample({x, y}, static_cast<std::uint32_t>(s));
          worker.samples.push_back(sample);
          worker.pixels.push_back({x, y});
          worker.weights.push_back(weight);
          if (worker.samples.size() == kWaveSamples) {
            if (stopped()) return false;
            trace_wave(worker);
          }
        }
      }
    }
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
    worker.pixels.clear();
    worker.weights.clear();
  }

  void add_to_film(Worker& worker, std::size_t i) {
    const int stride = world_.lanes.lane_stride();
    const int set = worker.samples[i].set;
    const std::span<const float> radiance =
        std::span<const float>(worker.radiance).subspan(i * stride, stride);
    const Vec3d xyz = responses_of(set, radiance);
    fill_bands(set, world_.lanes.folded(set, radiance, worker.folded), worker.bands);
    worker.aovs.clear();
    for (const std::string& group : settings_.aovs) {
      if (const auto part = light_part_named(group)) {
        const std::span<const float> light =
            std::span<const float>(worker.light_parts)
                .subspan((i * kLightParts + *part) * stride, stride);
        const Vec3f rgb_rec709(world_.lanes.film_to_rec709() * responses_of(set, light));
        worker.aovs.insert(worker.aovs.end(), {rgb_rec709.x, rgb_rec709.y, rgb_rec709.z});
      } else if (group == "spectralAlbedo") {
        fill_bands(set, std::span<const float>(worker.albedo).subspan(i * stride, stride),
                   worker.reflectances);
        worker.aovs.insert(worker.aovs.end(), worker.reflectances.begin(),
                           worker.reflectances.end());
      } else {
        append_aov(group, worker.first_hits[i], view_, worker.aovs);
      }
    }
    film_.add(worker.pixels[i], worker.weights[i], Vec3f(xyz), worker.bands, worker.aovs);
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

  void fill_bands(int set, std::span<const float> lanes, std::vector<float>& bands) const {
    if (!settings_.wavelengths.exact_nm.empty()) {
      bands.assign(lanes.begin(), lanes.begin() + world_.lanes.quadrature()->lane_count());
      return;
    }
    if (!settings_.bands) return;
    bands.resize(static_cast<std::size_t>(settings_.bands->count()));
    band_weights_->apply(set, lanes, bands);
  }

  const LitWorld& world_;
  const RenderSettings& settings_;
  SampleSource source_;
  Film& film_;
  IntegratorSettings integrator_;
  Viewpoint view_;
  std::optional<BandWeights> band_weights_;
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
