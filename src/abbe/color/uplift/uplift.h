/// Spectra for RGB colours.
#pragma once

#include <string>

#include "abbe/math/vec.h"
#include "abbe/spectrum/spectrum.h"

namespace abbe {

/// How an RGB colour becomes a spectrum.
enum class Uplift {
  /// The smoothest of simple shapes, for all colours that a reflectance can have. Source: Jakob &
  /// Hanika, A Low-Dimensional Function Space for Efficient Spectral Upsampling, CGF 38(2), 2019.
  JakobHanika,
  /// A sum of three curves, linear in RGB: Rec.709 only, other colours are clamped to it. Source:
  /// Mallett & Yuksel, Spectral Primary Decomposition for Rendering with sRGB Reflectance, 2019.
  MallettYuksel,
};

/// Names as on the command line. Errors: a usage Error that lists them.
Uplift uplift_from_name(const std::string& name);
std::string uplift_name(Uplift uplift);
/// The publication, and the gamut that it is for.
std::string uplift_title(Uplift uplift);

/// The reflectance whose colour under D65, seen by the CIE 1931 observer, is the given one.
/// Domain: any colour; with channels outside [0, 1] one beyond the gamut of Rec.709.
Spectrum uplift_reflectance(Uplift uplift, const Vec3d& rgb_rec709);

/// The unbounded colour of a light or emission: scale = 2·max(rgb), S(rgb/scale)·scale·D65 where
/// D65 is scaled to 1 cd/m². Its luminance and colour are the RGB's; 0 unless a channel is above 0.
Spectrum uplift_emission(Uplift uplift, const Vec3d& rgb_rec709,
                         const Spectrum& d65_at_1_cd_per_m2);

/// Jakob and Hanika's reflectance. Greys become constants; black and white are exactly 0 and 1 in
/// single precision.
/// Domain: any colour; the nearest in L*a*b* where no reflectance has it. Round trip within ΔE00
///         0.002 for colours a tenth inside the solid of object colours, all of Rec.709 among them.
SigmoidPolynomial uplift_rec709(const Vec3d& rgb_rec709);

/// The same by interpolation in the tables made at build time: for textures, texel by texel.
/// Filter colours, then uplift: means of coefficients are not coefficients of means.
/// Shape:  three floats c0, c1, c2 in x = (c0·s + c1)·s + c2 with s = (λ_nm − 595)/235, in [−1, 1]:
///         normalised so that floats keep their precision.
/// Domain: any colour; what ACEScg does not hold is clamped to it. Round trip within ΔE00 0.05, on
///         the faces of Rec.709 too, and in wider gamuts for colours a tenth inside the solid.
Vec3f uplift_rec709_from_table(const Vec3f& rgb_rec709);

/// The same polynomial in s = (λ_nm − 595)/235 and in λ_nm.
SigmoidPolynomial polynomial_in_nm(const Vec3d& coefficients_in_s);
Vec3d coefficients_in_s(const SigmoidPolynomial& polynomial);

/// Mallett and Yuksel's curves of red, green and blue at a wavelength: a colour's reflectance is
/// its scalar product with them.
Vec3d mallett_yuksel_basis(double wavelength_nm);

}  // namespace abbe
