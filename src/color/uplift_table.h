/// The table of smooth reflectances: its shape, shared by the program that makes it at build time
/// and the library that reads it.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

#include "color/uplift_fit.h"

namespace abbe {

/// Nodes along each of the table's three axes.
inline constexpr std::size_t kUpliftNodes = 36;

/// A colour is stored under its largest channel m, with the coordinates max, next/max and
/// after-next/max. Stored are angles θ in (0, π) at three wavelengths, S = (1 − cos θ)/2 being the
/// reflectance there, so that x = −cot θ: they depend almost linearly on the nodes, where the
/// coefficients run off to infinity at the gamut's faces.
/// Shape: [largest channel][max][next/max][after-next/max][wavelength].
inline constexpr std::size_t kUpliftTableSize = 3 * kUpliftNodes * kUpliftNodes * kUpliftNodes * 3;

/// Abscissas s = (λ − 595)/235 of 460, 540 and 610 nm.
inline constexpr std::array<double, 3> kUpliftStored_s{
    (460.0 - 595.0) / 235.0, (540.0 - 595.0) / 235.0, (610.0 - 595.0) / 235.0};

/// Wavelengths of the projection, 360 to 830 nm by 1.
inline constexpr std::size_t kUpliftWavelengths = 471;

/// Nodes are dense at both ends of an axis: t²(3 − 2t), and its inverse.
/// Domain: [0, 1].
inline double uplift_coordinate(double t) {
  return t * t * (3.0 - 2.0 * t);
}
inline double uplift_position(double coordinate) {
  return 0.5 - std::sin(std::asin(std::clamp(1.0 - 2.0 * coordinate, -1.0, 1.0)) / 3.0);
}

inline std::size_t uplift_index(std::size_t largest, std::size_t i, std::size_t j, std::size_t k) {
  return 3 * (((largest * kUpliftNodes + i) * kUpliftNodes + j) * kUpliftNodes + k);
}

/// Made at build time: the table, and the projection as red, green, blue weight of each wavelength.
extern const float kUpliftTable[kUpliftTableSize];
extern const double kUpliftProjection[kUpliftWavelengths * 3];

}  // namespace abbe
