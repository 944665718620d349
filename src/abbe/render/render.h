/// Camera samples → integrator → film, tile by tile.
#pragma once

#include <functional>

#include "abbe/base/parallel.h"
#include "abbe/film/film.h"
#include "abbe/integrate/integrator.h"
#include "abbe/render/settings.h"
#include "abbe/scene/scene.h"
#include "abbe/world/world.h"

namespace abbe {

/// Told how far a render is, of the samples that it is expected to take; called from one thread at
/// a time.
using ProgressCallback = std::function<void(double fraction_done)>;

/// How many camera samples a render took, and what is left of noise.
struct SamplingReport {
  int passes = 1;
  double samples = 0.0;  ///< Of all pixels that were rendered, which may be more than the crop.
  double samples_per_pixel = 0.0;  ///< Mean.
  double noise = 0.0;              ///< RenderSettings::noise.
  // With it; in CIEDE2000, root mean square over pixels, as SampleAllocation judges it.
  double error = 0.0;        ///< Of all pixels.
  double worst_error = 0.0;  ///< Of the block of pixels that has most.
  double unfinished = 0.0;   ///< Share of pixels that wanted more samples than they may have.
};

/// What rendering took, and whether it came to its end.
struct RenderResult {
  IntegratorStats stats;
  double seconds = 0.0;
  std::size_t queue_capacity = 0;  ///< Most fans that could have waited on a thread.
  SamplingReport sampling;
  bool complete = true;  ///< False when cancelled: some samples are missing.
};

/// The film that render() adds to: the size, crop, channels and filter of the settings.
FilmOptions film_options(const RenderSettings& settings);

/// Renders a world through a camera: adds the camera samples of every pixel to a film, which is the
/// caller's to develop, to keep and to add to. What it gathers is the same, bit for bit, for any
/// number of threads; a crop has the same pixels as the whole image. A cancelled render leaves it
/// with what came until then. Samples are numbered from 0: the same render once more adds the same
/// samples again. `world.lanes.film_to_rec709()` develops it.
/// Errors: as check_agreement, before anything is rendered.
RenderResult render(const LitWorld& world, const Camera& camera, const RenderSettings& settings,
                    Film& film, const ProgressCallback& progress = {},
                    const CancelFlag* cancel = nullptr);

/// How render() integrates the light of camera samples.
IntegratorSettings integrator_settings(const RenderSettings& settings);

/// The camera sample of a pixel, as render() draws it. `offset_px` overrides the filter's offset.
CameraSample camera_sample(const World& world, const Camera& camera, const RenderSettings& settings,
                           const Vec2i& pixel, std::uint32_t sample,
                           std::optional<Vec2f> offset_px = std::nullopt);

}  // namespace abbe
