/// Fitting smooth reflectances to colours: the part that the library and the maker of its table
/// share.
#pragma once

#include <array>
#include <vector>

#include "abbe/math/vec.h"

namespace abbe {

/// Coefficients of x(s) = (c0·s + c1)·s + c2 with s = (λ_nm − 595)/235, so that s runs over [−1,
/// 1]. S = ½ + x/(2√(1 + x²)) is the reflectance.
struct NormalisedSigmoid {
  Vec3d c{0.0};
};

/// From |x| = 4096 on, single precision makes the reflectance exactly 0 or 1.
inline constexpr double kSaturated = 4096.0;

/// How reflectances become linear Rec.709 under a lamp: a sum over equidistant wavelengths.
/// Σ weights = (1, 1, 1), so that the reflectance 1 is white.
struct ReflectanceProjection {
  std::vector<double> s;                             ///< Abscissas, an even number of them.
  std::array<std::vector<double>, 3> weight_rec709;  ///< As many, by channel.

  Vec3d rec709(const NormalisedSigmoid& reflectance) const;
};

/// The constant reflectance, in [0, 1].
NormalisedSigmoid constant_reflectance(double value);

/// The reflectance whose colour is nearest to the given one in CIE L*a*b*, found from `start` by
/// Levenberg and Marquardt's method.
/// Domain: any colour; the nearest where no reflectance has it.
NormalisedSigmoid fit_reflectance(const Vec3d& rgb_rec709, const ReflectanceProjection& projection,
                                  const NormalisedSigmoid& start);

/// The nearest in L*a*b* of MacAdam's optimal colours, which are 1 in a band and 0 outside or the
/// other way round: for a colour that no reflectance has, the nearest of all.
NormalisedSigmoid nearest_optimal_color(const Vec3d& rgb_rec709,
                                        const ReflectanceProjection& projection);

/// Squared distance in L*a*b* of a reflectance's colour, and the distance from which on a fit has
/// missed: such a colour is impossible, or nearly so.
double squared_miss_in_lab(const NormalisedSigmoid& reflectance, const Vec3d& rgb_rec709,
                           const ReflectanceProjection& projection);
inline constexpr double kMissedInLab = 0.01;

/// The same from the grey of the colour's luminance, in steps where one stride does not arrive.
NormalisedSigmoid fit_reflectance(const Vec3d& rgb_rec709, const ReflectanceProjection& projection);

}  // namespace abbe
