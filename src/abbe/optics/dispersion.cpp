#include "abbe/optics/dispersion.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "abbe/base/constants.h"

namespace abbe {
namespace {

constexpr double kSmallestIndex = 1.0;
constexpr double kLargestIndex = 1000.0;

// Every overload gives n; the ones that state n² give its root, or NaN where it has none.

double index_of(const ConstantIndex& constant, double) {
  return constant.n;
}

double index_of(const SellmeierFormula& formula, double wavelength_nm) {
  const double squared_um2 = wavelength_nm * wavelength_nm * 1e-6;
  double n_squared = 1.0 + formula.A;
  const std::size_t terms = std::min(formula.B.size(), formula.C.size());
  for (std::size_t k = 0; k < terms; ++k) {
    n_squared += formula.B[k] * squared_um2 / (squared_um2 - formula.C[k]);
  }
  return std::sqrt(n_squared);
}

double sum_of_powers(const std::vector<double>& c, const std::vector<double>& p, double x) {
  double sum = 0.0;
  for (std::size_t i = 0; i < std::min(c.size(), p.size()); ++i) sum += c[i] * std::pow(x, p[i]);
  return sum;
}

double index_of(const PolynomialFormula& formula, double wavelength_nm) {
  return std::sqrt(formula.c0 + sum_of_powers(formula.c, formula.p, wavelength_nm * 1e-3));
}

double index_of(const RefractiveIndexInfoFormula4& formula, double wavelength_nm) {
  const std::vector<double>& c = formula.coefficients;
  const auto coefficient = [&c](std::size_t i) { return i < c.size() ? c[i] : 0.0; };
  const double x_um = wavelength_nm * 1e-3;
  double n_squared = coefficient(0);
  for (const std::size_t first : {std::size_t{1}, std::size_t{5}}) {
    if (coefficient(first) == 0.0) continue;
    n_squared += coefficient(first) * std::pow(x_um, coefficient(first + 1)) /
                 (x_um * x_um - std::pow(coefficient(first + 2), coefficient(first + 3)));
  }
  for (std::size_t i = 9; i < c.size(); i += 2) {
    n_squared += c[i] * std::pow(x_um, coefficient(i + 1));
  }
  return std::sqrt(n_squared);
}

double index_of(const CauchyFormula& formula, double wavelength_nm) {
  return formula.c0 + sum_of_powers(formula.c, formula.p, wavelength_nm * 1e-3);
}

double index_of(const AbbeNumber& glass, double wavelength_nm) {
  if (!std::isfinite(glass.V_d) || glass.V_d == 0.0) return glass.n_d;
  return glass.n_d +
         (glass.n_d - 1.0) / glass.V_d * (523655.0 / (wavelength_nm * wavelength_nm) - 1.5168);
}

double index_of(const TabulatedIndex& table, double wavelength_nm) {
  return table.n.value(wavelength_nm);
}

}  // namespace

double refractive_index(const Dispersion& dispersion, double wavelength_nm) {
  const double n =
      std::visit([&](const auto& formula) { return index_of(formula, wavelength_nm); }, dispersion);
  if (std::isnan(n)) return kSmallestIndex;
  return std::clamp(n, kSmallestIndex, kLargestIndex);
}

double abbe_number(const Dispersion& dispersion) {
  const double n_d = refractive_index(dispersion, kLine_d_nm);
  const double difference =
      refractive_index(dispersion, kLineF_nm) - refractive_index(dispersion, kLineC_nm);
  if (difference == 0.0) return std::numeric_limits<double>::infinity();
  return (n_d - 1.0) / difference;
}

std::optional<double> breakdown_nm(const Dispersion& dispersion) {
  // Those of one index, and KHR_materials_dispersion, which is limited by definition.
  if (std::holds_alternative<ConstantIndex>(dispersion) ||
      std::holds_alternative<AbbeNumber>(dispersion)) {
    return std::nullopt;
  }
  constexpr double kStep_nm = 0.25, kJump = 0.5;
  double before = refractive_index(dispersion, kRangeMin_nm);
  for (double nm = kRangeMin_nm; nm <= kRangeMax_nm; nm += kStep_nm) {
    const double n = refractive_index(dispersion, nm);
    if (n <= kSmallestIndex || n >= kLargestIndex || std::abs(n - before) > kJump) return nm;
    before = n;
  }
  return std::nullopt;
}

bool is_dispersive(const Dispersion& dispersion) {
  const double first = refractive_index(dispersion, kRangeMin_nm);
  for (double nm = kRangeMin_nm; nm <= kRangeMax_nm; nm += 5.0) {
    if (refractive_index(dispersion, nm) != first) return true;
  }
  return false;
}

CauchyFormula cauchy_through(double n_d, double V_d) {
  constexpr double kLineF_um = kLineF_nm * 1e-3;
  constexpr double kLine_d_um = kLine_d_nm * 1e-3;
  constexpr double kLineC_um = kLineC_nm * 1e-3;
  const double B_um2 =
      (n_d - 1.0) / (V_d * (1.0 / (kLineF_um * kLineF_um) - 1.0 / (kLineC_um * kLineC_um)));
  return {n_d - B_um2 / (kLine_d_um * kLine_d_um), {B_um2}, {-2.0}};
}

}  // namespace abbe
