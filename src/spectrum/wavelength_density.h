/// Where wavelengths are sampled more and where less.
#pragma once

#include <span>
#include <vector>

#include "spectrum/observer.h"
#include "spectrum/spectrum.h"

namespace abbe {

/// The continuous parts of lamps, each scaled to luminance 1, summed; 1 everywhere without any.
Spectrum lamp_mix(std::span<const Spectrum> lamps, const Observer& observer);

/// A probability density over wavelengths, linear between whole nanometres and the points of the
/// lamps' tables: what the observer sees of the lamps (x̄ + ȳ + z̄ times their mix), mixed with the
/// uniform density so that no wavelength is left out.
class WavelengthDensity {
 public:
  /// Domain: range within 360–830 nm.
  WavelengthDensity(const Spectrum& lamps, const Observer& observer, double range_min_nm,
                    double range_max_nm);

  /// The density in nm⁻¹; integrates to 1 over the range.
  double value(double wavelength_nm) const;
  /// The wavelength below which a share `u` of the mass lies.
  /// Domain: u in [0, 1].
  double quantile(double u) const;

 private:
  std::vector<double> wavelength_nm_;
  std::vector<double> density_per_nm_;
  std::vector<double> cumulative_;
};

}  // namespace abbe
