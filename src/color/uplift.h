/// Smooth reflectances for RGB colours. Source: Jakob & Hanika, A Low-Dimensional Function Space
/// for Efficient Spectral Upsampling, CGF 38(2), 2019.
#pragma once

#include "math/vec.h"
#include "spectrum/spectrum.h"

namespace abbe {

/// The smooth reflectance whose colour under D65, seen by the CIE 1931 observer, is the given one.
/// Greys become constants; black and white are exactly 0 and 1 in single precision.
/// Domain: rgb_rec709 is clamped to [0, 1]. Round trip within ΔE00 1e-3.
SigmoidPolynomial uplift_rec709(const Vec3d& rgb_rec709);

/// The same by interpolation in the table made at build time: for textures, texel by texel.
/// Filter colours, then uplift: means of coefficients are not coefficients of means.
/// Shape:  three floats c0, c1, c2 in x = (c0·s + c1)·s + c2 with s = (λ_nm − 595)/235, in [−1, 1]:
///         normalised so that floats keep their precision.
/// Domain: clamped to [0, 1]. Round trip within ΔE00 0.05 for 999 of 1000 colours, on the faces of
///         the gamut too, and within 0.3 for all.
Vec3f uplift_rec709_from_table(const Vec3f& rgb_rec709);

/// The same polynomial in s = (λ_nm − 595)/235 and in λ_nm.
SigmoidPolynomial polynomial_in_nm(const Vec3d& coefficients_in_s);
Vec3d coefficients_in_s(const SigmoidPolynomial& polynomial);

/// The unbounded colour of a light or emission: scale = 2·max(rgb), S(rgb/scale)·scale·D65 where
/// D65 is scaled to 1 cd/m². Its luminance and colour are the RGB's; negative channels count as 0.
Spectrum uplift_emission_rec709(const Vec3d& rgb_rec709, const Spectrum& d65_at_1_cd_per_m2);

}  // namespace abbe
