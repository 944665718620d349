/// What two modes differ by, and why: numbers and maps of `abbe compare`.
#pragma once

#include <array>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "abbe/cli/diff_metrics.h"
#include "abbe/cli/study.h"
#include "abbe/report/attribution.h"
#include "abbe/world/causes.h"

namespace abbe {

/// An image against the spectral one.
struct ModeDifference {
  ColorMaps maps;
  double rmse = 0.0;  ///< Of linear R, G and B.
};

/// White is D65; 1, 1, 1 at `exposure_ev` is L* = 100. Differences are taken of linear Rec.709 as
/// the film has developed it, negative channels and all.
ModeDifference mode_difference(const Image& image, const Image& reference, double exposure_ev);

/// The linear R, G and B of an image, brightened.
Image exposed(const Image& image, double exposure_ev);

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
int most_frozen_wavelengths(const Scene& scene, const Spectrum& d65);

/// Renders what is needed into causes/ of the study. Nothing when interrupted.
std::optional<Causes> find_causes(Study& study, const std::vector<Cause>& acting,
                                  AttributionMethod method, const RenderSettings& settings,
                                  const Image& rgb, const ModeDifference& rgb_to_spectral,
                                  double exposure_ev);

/// Shares of pixels by ΔE2000, in the bins of histogram_edges(): the last one is open.
std::vector<double> histogram(const std::vector<float>& delta_e2000);
std::vector<double> histogram_edges();

}  // namespace abbe
