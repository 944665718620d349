/// The colours of the spectrum as a page can show them.
#pragma once

#include "abbe/math/vec.h"
#include "abbe/spectrum/observer.h"

namespace abbe {

/// Colours to draw wavelengths with. Every spectral colour is outside the gamut of the page: each
/// is moved along the line to grey until no channel is negative. The ends of the spectrum fade into
/// black, as the eye sees them.
class SpectrumColors {
 public:
  explicit SpectrumColors(const Observer& observer);

  /// Shape:  encoded sRGB.
  /// Units:  in [0, 1], the brightest wavelength's highest channel being 1.
  Vec3d at(double wavelength_nm) const;

  /// The same without fading: the colour at its brightest, for thin lines on paper.
  Vec3d bright_at(double wavelength_nm) const;

 private:
  const Observer& observer_;
  double brightest_ = 0.0;
};

}  // namespace abbe
