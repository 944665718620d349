/// Absorption along a path: Beer and Lambert's law.
#pragma once

#include "abbe/math/vec.h"

namespace abbe {

/// Largest absorption that a colour channel of 0 stands for, in m⁻¹: black after a micrometre.
inline constexpr double kLargestAbsorption_per_m = 1e9;

/// Fraction of light left after a distance, exp(−absorption · distance).
/// Domain: absorption_per_m >= 0, distance_m >= 0; no absorption leaves 1 at any distance.
double transmittance_after(double absorption_per_m, double distance_m);

/// Absorption coefficient of glTF's volume: the light is tinted by `attenuation_color` after
/// `attenuation_distance_m`, so σ = −ln(color)/distance.
/// Domain: color in [0, 1] (above 1 counts as 1), distance > 0; an infinite distance absorbs
///         nothing; a color of 0 gives kLargestAbsorption_per_m.
/// Source: Khronos, KHR_materials_volume.
double absorption_of_attenuation_per_m(double attenuation_color, double attenuation_distance_m);
Vec3d absorption_of_attenuation_per_m(const Vec3d& attenuation_color_rec709,
                                      double attenuation_distance_m);

}  // namespace abbe
