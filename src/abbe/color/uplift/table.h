/// The tables of smooth reflectances: their shape, shared by the program that makes them at build
/// time and the library that reads them.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>

#include "abbe/color/rgb_space.h"
#include "abbe/color/uplift/fit.h"

namespace abbe {

/// Nodes along each of the three axes of a table, which covers the cube [0, 1]³ of a linear RGB
/// space. A colour is stored under its largest channel m, with the coordinates max, next/max and
/// after-next/max. Stored are angles θ in (0, π) at three wavelengths, S = (1 − cos θ)/2 being the
/// reflectance there, so that x = −cot θ: they depend almost linearly on the nodes, where the
/// coefficients run off to infinity at the gamut's faces.
/// Shape: [largest channel][max][next/max][after-next/max][wavelength].
inline constexpr std::size_t kUpliftNodes = 40;
inline constexpr std::size_t kUpliftTableSize = 3 * kUpliftNodes * kUpliftNodes * kUpliftNodes * 3;

/// The spaces that have tables: Rec.709, whose faces many colours lie on, and ACEScg, which holds
/// all the others.
inline constexpr std::array<RgbSpace, 2> kUpliftSpaces{RgbSpace::Rec709, RgbSpace::AcesCg};

/// Abscissas s = (λ − 595)/235 of 460, 540 and 610 nm.
inline constexpr std::array<double, 3> kUpliftStored_s{
    (460.0 - 595.0) / 235.0, (540.0 - 595.0) / 235.0, (610.0 - 595.0) / 235.0};

/// Wavelengths of the projection: 360 to 830 nm by 1, and one without weight, to make them even.
inline constexpr std::size_t kUpliftWavelengths = 472;

/// Nodes are dense at both ends of an axis: t²/(t² + (1 − t)²), and its inverse.
/// Domain: [0, 1].
template <typename Real>
Real uplift_coordinate(Real t) {
  const Real a = t * t, b = (Real(1) - t) * (Real(1) - t);
  return a / (a + b);
}
template <typename Real>
Real uplift_position(Real coordinate) {
  const Real a = std::sqrt(coordinate), b = std::sqrt(Real(1) - coordinate);
  return a / (a + b);
}

inline constexpr std::size_t uplift_index(std::size_t largest, std::size_t i, std::size_t j,
                                          std::size_t k) {
  return 3 * (((largest * kUpliftNodes + i) * kUpliftNodes + j) * kUpliftNodes + k);
}

/// Rows of Mallett and Yuksel's basis.
inline constexpr std::size_t kMallettYukselRows = 81;
inline constexpr double kMallettYukselFirst_nm = 380.0, kMallettYukselStep_nm = 5.0;

/// Made at build time: a table for each of kUpliftSpaces; the projection as red, green, blue weight
/// (linear Rec.709) of each wavelength; and the basis, as red, green, blue at each of its own.
extern const float kUpliftTables[kUpliftSpaces.size()][kUpliftTableSize];
extern const double kUpliftProjection[kUpliftWavelengths * 3];
extern const double kMallettYukselBasis[kMallettYukselRows * 3];

}  // namespace abbe
