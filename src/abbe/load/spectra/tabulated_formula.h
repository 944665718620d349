/// Formulas of an index that have no type of their own.
#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

#include "abbe/base/constants.h"
#include "abbe/optics/dispersion.h"

namespace abbe {

/// n = function(λ in µm) as a table at 0.25 nm within 360 to 830 nm: between its points n is off by
/// n″·(0.25 nm)²/8, below 1e-6 for all that is transparent. Limited to 1 to 1000, as at a pole.
template <typename Function>
Dispersion tabulated_formula(const Function& n_of_um) {
  constexpr double kLeast = 1.0, kLargest = 1000.0, kStep_nm = 0.25;
  std::vector<double> wavelengths_nm, n;
  for (double nm = kRangeMin_nm; nm <= kRangeMax_nm; nm += kStep_nm) {
    const double value = n_of_um(nm * 1e-3);
    wavelengths_nm.push_back(nm);
    n.push_back(std::isnan(value) ? kLeast : std::clamp(value, kLeast, kLargest));
  }
  return TabulatedIndex{
      Spectrum::tabulated(std::move(wavelengths_nm), std::move(n), OutsideTable::Clamp)};
}

/// n = c0 + c1·L + c2·L² + c3·λ² + c4·λ⁴ + c5·λ⁶ with L = 1/(λ² − 0.028), λ in µm.
/// Domain: six coefficients. Source: Herzberger, Colour Correction in Optical Systems, 1959.
inline Dispersion herzberger(const std::vector<double>& c) {
  return tabulated_formula([&](double um) {
    const double um2 = um * um, L = 1.0 / (um2 - 0.028);
    return c[0] + c[1] * L + c[2] * L * L + um2 * (c[3] + um2 * (c[4] + um2 * c[5]));
  });
}

}  // namespace abbe
