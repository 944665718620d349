/// The index of refraction as a function of wavelength.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "abbe/spectrum/spectrum.h"

namespace abbe {

/// The same index at every wavelength.
struct ConstantIndex {
  double n = 1.5;
};

/// n² = 1 + A + Σ B_k λ²/(λ² − C_k), λ in µm, C in µm² (refractiveindex.info formulas 1 and 2).
struct SellmeierFormula {
  double A = 0.0;
  std::vector<double> B, C;
};

/// n² = c0 + Σ c_i λ^p_i (formula 3; Schott's AGF formula 1 is one of these).
struct PolynomialFormula {
  double c0 = 1.0;
  std::vector<double> c, p;
};

/// n² = c0 + c1 λ^p1/(λ² − c2^p2) + c3 λ^p3/(λ² − c4^p4) + Σ c_i λ^p_i (formula 4): the
/// coefficients in the order of refractiveindex.info, absent ones left out at the end.
struct RefractiveIndexInfoFormula4 {
  std::vector<double> coefficients;
};

/// n = c0 + Σ c_i λ^p_i (formula 5); A + B/λ² + C/λ⁴ is a case of it.
struct CauchyFormula {
  double c0 = 1.5;
  std::vector<double> c, p;
};

/// KHR_materials_dispersion: n(λ) = max(n_d + (n_d − 1)/V_d · (523655/λ² − 1.5168), 1), λ in nm.
struct AbbeNumber {
  double n_d = 1.5;
  double V_d = 60.0;
};

/// Measured n, linear in nm, clamped outside.
struct TabulatedIndex {
  Spectrum n;
};

/// How an index of refraction depends on wavelength. Relative to air, as catalogues state it.
using Dispersion =
    std::variant<ConstantIndex, SellmeierFormula, PolynomialFormula, RefractiveIndexInfoFormula4,
                 CauchyFormula, AbbeNumber, TabulatedIndex>;

/// n at a wavelength.
/// Domain: 360–830 nm; at a pole or where n² < 1 the result is clamped to [1, 1000].
double refractive_index(const Dispersion& dispersion, double wavelength_nm);

/// V_d = (n_d − 1)/(n_F − n_C); infinity when the index does not depend on wavelength.
double abbe_number(const Dispersion& dispersion);

/// The first wavelength within 360 to 830 nm at which a formula gives no index: at a pole, or where
/// n² is below 1. Nothing for one that holds throughout.
/// Domain: poles so narrow that n is itself again 0.25 nm further on are overlooked.
std::optional<double> breakdown_nm(const Dispersion& dispersion);

/// Whether the index differs between wavelengths.
bool is_dispersive(const Dispersion& dispersion);

/// The two-term Cauchy formula through n_d and V_d: B = (n_d − 1)/(V_d (λ_F⁻² − λ_C⁻²)),
/// A = n_d − B/λ_d².
CauchyFormula cauchy_through(double n_d, double V_d);

}  // namespace abbe
