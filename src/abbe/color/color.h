/// Colour spaces between tristimulus values and linear RGB.
#pragma once

#include "abbe/math/vec.h"
#include "abbe/spectrum/observer.h"
#include "abbe/spectrum/spectrum.h"

namespace abbe {

/// Chromaticity of the white that development adapts to.
inline constexpr Vec2d kD65_xy{0.3127, 0.3290};

/// XYZ of a chromaticity at a luminance.
/// Domain: xy.y > 0.
Vec3d xyz_of_xy(const Vec2d& xy, double Y = 1.0);

/// Linear Rec.709 and XYZ relative to xy 0.3127, 0.3290; made from the primaries, not rounded.
Mat3d rec709_to_xyz();
Mat3d xyz_to_rec709();

/// Bradford and CAT16 linear adaptation from one white to another: matrices over XYZ.
/// Domain: whites of positive cone responses, in one scale.
/// Source: Lam 1985; Li et al., Color Research & Application 42(6), 2017.
Mat3d bradford_adaptation(const Vec3d& xyz_white_from, const Vec3d& xyz_white_to);
Mat3d cat16_adaptation(const Vec3d& xyz_white_from, const Vec3d& xyz_white_to);

/// How tristimulus values become RGB: the observer's integral of the reference white is adapted to
/// xy 0.3127, 0.3290 (CAT16), then turned into linear Rec.709.
struct Development {
  Mat3d xyz_to_rec709{
      1.0};  ///< Film XYZ (cd/m² scale) to linear Rec.709; D65 at 1 cd/m² gives 1, 1, 1.
  Mat3d rec709_to_xyz{1.0};  ///< Its inverse.
};
/// Shape:  `d65` in any scale.
Development development_for(const Observer& observer, const Spectrum& d65);

/// Linear Rec.709 of an emission in W·m⁻²·sr⁻¹·nm⁻¹: D65 at 1 cd/m² is 1, 1, 1.
Vec3d rec709_of_emission(const Spectrum& emission, const Observer& observer,
                         const Development& development);
/// Linear Rec.709 of a reflectance under D65: 1 everywhere is 1, 1, 1.
Vec3d rec709_of_reflectance(const Spectrum& reflectance, const Observer& observer,
                            const Spectrum& d65, const Development& development);

/// sRGB transfer curve, IEC 61966-2-1, and its inverse.
/// Domain: any; negative numbers on the line at black.
double srgb_encode(double linear);
double srgb_decode(double encoded);

/// CIE L*a*b* relative to a white, and the CIEDE2000 difference of two such triples.
/// Source: CIE 15:2018; Sharma, Wu & Dalal 2005.
Vec3d lab_of_xyz(const Vec3d& xyz, const Vec3d& xyz_white);
double delta_e2000(const Vec3d& lab_a, const Vec3d& lab_b);

}  // namespace abbe
