/// Quantities as functions of wavelength: a continuous part and, for lamps, spectral lines.
#pragma once

#include <memory>
#include <span>
#include <variant>
#include <vector>

namespace abbe {

/// A line of a lamp: all its power at one wavelength. The strength has the unit of the continuous
/// part times nm.
struct SpectralLine {
  double wavelength_nm = 0.0;
  double strength = 0.0;
};

/// What a table says outside its wavelengths.
enum class OutsideTable {
  Zero,   ///< Lamps: no light where none was measured.
  Clamp,  ///< Reflectances, n and k: the nearest value.
};

/// Jakob and Hanika's smooth reflectance: S(λ) = ½ + x/(2√(1 + x²)), x = c0 λ² + c1 λ + c2, λ in
/// nm. Always in [0, 1]. Source: Jakob & Hanika, CGF 38(2), 2019.
struct SigmoidPolynomial {
  double c0 = 0.0, c1 = 0.0, c2 = 0.0;
};

/// An immutable spectrum; cheap to copy.
class Spectrum {
 public:
  /// The spectrum that is 0 everywhere.
  Spectrum() = default;

  /// The same value at every wavelength.
  static Spectrum constant(double value);
  /// Linear between the points.
  /// Domain: at least one point; wavelengths finite and strictly increasing, values finite.
  /// Errors: an input Error that names the offending row (its place is left to the caller).
  static Spectrum tabulated(std::vector<double> wavelength_nm, std::vector<double> values,
                            OutsideTable outside);
  /// Planck's law, spectral radiance in W·m⁻²·sr⁻¹·nm⁻¹. Source: CODATA 2018 constants.
  static Spectrum blackbody(double temperature_K);
  static Spectrum sigmoid(const SigmoidPolynomial& polynomial);
  /// Nothing but lines, in any order.
  static Spectrum lines(std::vector<SpectralLine> lines);

  /// The continuous part at a wavelength.
  double value(double wavelength_nm) const;
  /// The lines, by rising wavelength.
  std::span<const SpectralLine> lines() const;
  /// Whether the continuous part is zero everywhere.
  bool is_lines_only() const;
  /// The wavelengths of its table, between which it is linear; empty when it has none.
  std::span<const double> table_points_nm() const;

  /// This spectrum times a factor.
  Spectrum scaled(double factor) const;

 private:
  friend Spectrum product(const Spectrum& a, const Spectrum& b);
  struct Data;
  std::shared_ptr<const Data> data_;
};

/// a·b. Tabulated at 1 nm over 360–830 nm and at the points of both tables; lines of a are scaled
/// by b's continuous part and the other way round (two sets of lines do not multiply).
Spectrum product(const Spectrum& a, const Spectrum& b);

/// ∫ weight(λ) S(λ) dλ over 360–830 nm, plus Σ weight·strength over the lines in range: two points
/// of Gauss and Legendre between neighbours of the union of the 1 nm grid and the table points,
/// exact for products of linear pieces, and for a lamp that ends with a jump at the edge of its
/// table.
double integral(const Spectrum& spectrum);
double integral(const Spectrum& spectrum, const Spectrum& weight);

}  // namespace abbe
