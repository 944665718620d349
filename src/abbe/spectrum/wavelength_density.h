/// Where wavelengths are sampled more and where less.
#pragma once

#include <span>
#include <vector>

#include "abbe/spectrum/narrow_bands.h"
#include "abbe/spectrum/observer.h"
#include "abbe/spectrum/spectrum.h"

namespace abbe {

/// The continuous parts of lamps, each scaled to luminance 1, summed; 1 everywhere without any.
Spectrum lamp_mix(std::span<const Spectrum> lamps, const Observer& observer);

/// A probability density over wavelengths, linear between whole nanometres and the points of the
/// lamps' tables.
///
/// The fine structure of the lamps counts in full, so that a peak gets its share of samples: their
/// mix is divided by itself smoothed. What the observer sees of the smoothed mix, (x̄ + ȳ + z̄) times
/// it, counts by a power below 1: a set of few wavelengths integrates best when the integrand over
/// the density fades out over several strata at both ends, as a periodic function does, instead of
/// stopping short. A share of the uniform density leaves no wavelength out.
class WavelengthDensity {
 public:
  /// Domain: range within 360–830 nm.
  WavelengthDensity(const Spectrum& lamps, const Observer& observer, double range_min_nm,
                    double range_max_nm);

  /// This density with bands that share a mass evenly, where they have less; the rest scaled. A
  /// band with the mass of a stratum has one point of a set, whatever the shift, and outside of
  /// bands the points are as evenly apart as they were.
  /// Domain: rising bands within the range, at least one, none overlapping; share in [0, 1).
  WavelengthDensity with_bands(std::span<const NarrowBand> bands, double share) const;

  /// The density in nm⁻¹; integrates to 1 over the range.
  double value(double wavelength_nm) const;
  /// The wavelength below which a share `u` of the mass lies.
  /// Domain: u in [0, 1].
  double quantile(double u) const;
  /// The share of the mass below a wavelength: the inverse of quantile().
  double share_below(double wavelength_nm) const;
  /// The mean of a spectrum over an interval, weighted by the density.
  /// Domain: low_nm < high_nm, both in the range.
  double mean(const Spectrum& spectrum, double low_nm, double high_nm) const;

 private:
  WavelengthDensity() = default;
  /// Integrates the density into cumulative_; returns its mass.
  double accumulate();
  /// Scales what is accumulated to mass 1.
  void normalise();
  /// The number of the upper end of the piece that has a wavelength.
  std::size_t piece(double wavelength_nm) const;

  std::vector<double> wavelength_nm_;
  std::vector<double> density_per_nm_;
  std::vector<double> cumulative_;
};

}  // namespace abbe
