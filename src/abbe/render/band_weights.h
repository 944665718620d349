/// From the lanes of a pixel's samples to spectral channels.
#pragma once

#include <span>
#include <vector>

#include "abbe/film/bands.h"
#include "abbe/spectrum/wavelength_set.h"

namespace abbe {

/// Mean spectral radiance per band, from lanes that fall where they fall.
///
/// The lanes of all samples of a pixel together are the nodes of a function that is linear between
/// them; a band's mean is the mean of that function over the band. It is a fixed linear combination
/// of the lanes: exact for light that changes linearly with wavelength, however many lanes fall
/// into a band, and unbiased for the rest of what varies, since what a lane carries (terminated, or
/// weighted for the lanes that were not followed) enters with a weight that does not depend on it.
/// Beyond the outermost nodes the function is constant to the end of the rendered range, and 0
/// outside it. Lines add their strength over the band's width.
class BandWeights {
 public:
  /// Shape: one set number per sample of a pixel; the sets of all pixels are the same.
  BandWeights(const WavelengthQuadrature& quadrature, const BandOptions& bands,
              std::span<const int> sets);

  /// The contribution of one sample; their mean over the samples is the pixel's value.
  /// Shape:  radiance: lane_stride values; bands: one value per band.
  void apply(int set, std::span<const float> radiance, std::span<float> bands) const;

 private:
  struct Entry {
    int lane = 0;
    int band = 0;
    float weight = 0.0f;
  };
  std::vector<std::vector<Entry>> entries_;  ///< Per set; empty for sets that no sample has.
};

}  // namespace abbe
