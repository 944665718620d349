/// The camera samples of a render.
#pragma once

#include <cstdint>
#include <optional>

#include "abbe/film/filter.h"
#include "abbe/integrate/integrator.h"
#include "abbe/render/camera_rays.h"
#include "abbe/render/settings.h"
#include "abbe/world/world.h"

namespace abbe {

/// A camera sample, and how it counts in its pixel.
struct WeightedSample {
  CameraSample sample;
  float weight = 1.0f;  ///< FilterSample::weight.
};

/// Draws the camera samples of a render.
class SampleSource {
 public:
  /// Shape: world and settings have to live as long as the source.
  SampleSource(const World& world, const Camera& camera, const RenderSettings& settings);

  /// The wavelength set of a sample, the same in every pixel; 0 in RGB modes.
  int set_of(std::uint32_t index) const;

  /// Sample number `index` of a pixel. `offset_px` overrides the filter's offset.
  WeightedSample sample(const Vec2i& pixel, std::uint32_t index,
                        const std::optional<Vec2f>& offset_px = std::nullopt) const;

 private:
  const World& world_;
  const RenderSettings& settings_;
  CameraRays rays_;
  Filter filter_;
};

}  // namespace abbe
