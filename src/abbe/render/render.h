/// Camera samples → integrator → film, tile by tile.
#pragma once

#include <functional>
#include <string>

#include "abbe/base/parallel.h"
#include "abbe/image/image.h"
#include "abbe/integrate/integrator.h"
#include "abbe/render/settings.h"
#include "abbe/scene/scene.h"
#include "abbe/world/world.h"

namespace abbe {

/// Told how far a render is; called from one thread at a time.
using ProgressCallback = std::function<void(double fraction_done)>;

struct RenderResult {
  Image image;
  IntegratorStats stats;
  double seconds = 0.0;
  std::size_t queue_capacity = 0;   ///< Most fans that could have waited on a thread.
  std::size_t dropped_samples = 0;  ///< Samples that were not finite.
  bool complete = true;             ///< False when cancelled: some pixels are missing.
};

/// Renders a world through a camera. The result is the same, bit for bit, for any number of
/// threads; a crop has the same pixels as the whole image. The image holds R, G, B (linear
/// Rec.709), spectral channels and AOVs; attributes are the caller's. Domain:
/// check_settings(settings) passes; `world` was made for the same mode and wavelengths.
RenderResult render(const World& world, const Camera& camera, const RenderSettings& settings,
                    const ProgressCallback& progress = {}, const CancelFlag* cancel = nullptr);

/// How render() integrates the light of camera samples.
IntegratorSettings integrator_settings(const RenderSettings& settings);

/// The camera sample of a pixel, as render() draws it. `offset_px` overrides the filter's offset.
CameraSample camera_sample(const World& world, const Camera& camera, const RenderSettings& settings,
                           const Vec2i& pixel, std::uint32_t sample,
                           std::optional<Vec2f> offset_px = std::nullopt);

}  // namespace abbe
