/// What is said of a lamp: its white point and the temperature of the black body nearest to it.
#pragma once

#include <optional>

#include "abbe/math/vec.h"
#include "abbe/spectrum/observer.h"
#include "abbe/spectrum/spectrum.h"

namespace abbe {

/// Chromaticity x, y of tristimulus values.
/// Errors: none; 0, 0 for black.
Vec2d xy_of_xyz(const Vec3d& xyz);

/// Chromaticity u, v of 1960, in which distances to the Planckian locus are measured.
/// Domain: tristimulus values that are not all 0.
Vec2d uv_1960_of_xyz(const Vec3d& xyz);

/// The black body whose colour is nearest to a lamp's in the CIE 1960 u, v diagram.
struct CorrelatedTemperature {
  double temperature_K = 0.0;
  double duv = 0.0;  ///< Distance in u, v; above the Planckian locus (greenish) positive.
};

/// Domain: tristimulus values of the CIE 1931 observer, which is `observer`.
/// Errors: none; nothing further than 0.05 from the locus, where CIE gives no temperature, nor
///         outside 1000 to 100 000 K.
/// Source: CIE 15:2018, 9.4.
std::optional<CorrelatedTemperature> correlated_temperature(const Vec3d& xyz,
                                                            const Observer& observer);

}  // namespace abbe
