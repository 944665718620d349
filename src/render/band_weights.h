/// From the lanes of a pixel's samples to spectral channels.
#pragma once

#include <span>
#include <vector>

#include "film/bands.h"
#include "spectrum/wavelength_set.h"

namespace abbe {

/// Mean spectral radiance per band, from lanes that fall where they fall.
///
/// A band's mean is estimated by the lanes of all samples of the pixel that lie in it, each with
/// its quadrature weight, over the sum of those weights: exact for light that is constant over the
/// band, however many lanes it got. That sum is known beforehand, since the sets of a pixel follow
/// from its hash. A band that no lane of the pixel reaches takes, sample by sample, the value
/// between the two lanes beside it. Lines add their strength over the band's width.
class BandWeights {
 public:
  BandWeights(const WavelengthQuadrature& quadrature, const BandOptions& bands,
              int samples_per_pixel);

  /// Prepares for a pixel. Shape: one set number per sample.
  void set_pixel(std::span<const int> sets);

  /// The contribution of one sample; their mean over the samples is the pixel's value.
  /// Shape:  radiance: lane_stride values; bands: one value per band.
  void apply(int set, std::span<const float> radiance, std::span<float> bands) const;

 private:
  const WavelengthQuadrature& quadrature_;
  BandOptions bands_;
  float samples_;
  std::vector<int> band_of_;  ///< Per set and lane; −1 outside all bands.
  std::vector<float> total_;  ///< Per band: Σ weight of the pixel's continuous lanes.
  std::vector<int> empty_;    ///< Bands without a lane.
};

}  // namespace abbe
