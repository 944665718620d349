/// Formulas of an index that have no type of their own.
#pragma once

#include <fmt/format.h>

#include <string>
#include <vector>

#include "base/constants.h"
#include "base/error.h"
#include "optics/dispersion.h"

namespace abbe {

/// n = function(λ in µm) as a table at 0.25 nm within 360 to 830 nm: between its points n is off by
/// n″·(0.25 nm)²/8, below 1e-6 for all that is transparent.
/// Errors: input Error at `where` when n is no number from 1 to 1000, as at a pole.
template <typename Function>
Dispersion tabulated_formula(const Function& n_of_um, const std::string& where) {
  constexpr double kLargest = 1000.0, kStep_nm = 0.25;
  std::vector<double> wavelengths_nm, n;
  for (double nm = kRangeMin_nm; nm <= kRangeMax_nm; nm += kStep_nm) {
    const double value = n_of_um(nm * 1e-3);
    if (!(value >= 1.0 && value <= kLargest)) {
      throw_input_error(where, fmt::format("a formula that gives n = {:g} at {} nm", value, nm),
                        "n from 1 to 1000 within 360 to 830 nm");
    }
    wavelengths_nm.push_back(nm);
    n.push_back(value);
  }
  return TabulatedIndex{
      Spectrum::tabulated(std::move(wavelengths_nm), std::move(n), OutsideTable::Clamp)};
}

}  // namespace abbe
