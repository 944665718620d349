/// Why the modes rgb and spectral differ.
#pragma once

#include <optional>
#include <vector>

#include "abbe/session/comparison/attribution.h"
#include "abbe/session/comparison/difference.h"
#include "abbe/session/study.h"
#include "abbe/world/causes.h"

namespace abbe {

/// The difference between the modes rgb and spectral, by cause.
struct Causes {
  std::vector<Cause> acting;
  AttributionMethod method = AttributionMethod::FirstAndLast;
  Attribution attribution;    ///< In the order of `acting`.
  std::vector<int> dominant;  ///< Index into `acting` per pixel, −1 where it cannot be seen.
  std::vector<float> whole;   ///< ΔE2000 of rgb against spectral.

  std::optional<std::size_t> index_of(Cause cause) const;
  double mean_whole() const;
};

/// Just noticeable, ΔE2000: below this no cause is called dominant.
inline constexpr double kLeastDeltaE = 1.0;

/// Wavelengths that a render with frozen causes can have at most: each takes three lanes, and so
/// does each line of the scene's lamps.
int max_frozen_wavelengths(const Scene& scene, const Spectrum& d65);

/// Renders what is needed into causes/ of the study. Nothing when interrupted.
std::optional<Causes> find_causes(Study& study, const std::vector<Cause>& acting,
                                  AttributionMethod method, const RenderSettings& settings,
                                  const Image& rgb, const ModeDifference& rgb_to_spectral,
                                  double exposure_ev);

}  // namespace abbe
