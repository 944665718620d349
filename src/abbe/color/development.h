/// From what a film has summed up to linear Rec.709: the observer, the white and the adaptation.
#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "abbe/color/color.h"

namespace abbe {

/// How one white is made to look like another.
enum class Adaptation {
  Cat16,     ///< Li et al. 2017.
  Bradford,  ///< Lam 1985.
  None,      ///< Not at all: tristimulus values as they are.
};

/// Names as on the command line. Errors: a usage Error that lists them.
Adaptation adaptation_from_name(const std::string& name);
std::string adaptation_name(Adaptation adaptation);

/// The light that is to look neutral.
struct White {
  std::string name;
  /// Lamps, each with its share of the illuminance.
  std::vector<std::pair<Spectrum, double>> lamps;
  std::optional<Vec2d> xy;  ///< A chromaticity instead.
};

/// How a film's sums are to become colours.
struct DevelopmentOptions {
  /// Whose eyes, or which camera, the film has; the CIE 1931 observer without one. Luminances of
  /// the scene are those of the CIE 1931 observer always.
  std::optional<Observer> observer = {};
  std::optional<White> white = {};  ///< D65 without one.
  Adaptation adaptation = Adaptation::Cat16;
};

/// From the responses of the observer to linear Rec.709: the white at 1 cd/m² becomes 1, 1, 1 (with
/// a white chromaticity, luminances are those that D65 is seen with). Without adaptation, what has
/// the tristimulus values of Rec.709's white does.
/// Shape:  `photometer` is the CIE 1931 observer; `d65` in any scale.
Mat3d responses_to_rec709(const DevelopmentOptions& options, const Observer& photometer,
                          const Spectrum& d65);

/// The same for linear Rec.709 that was made with D65 for white, as the RGB modes render it.
Mat3d rec709_to_rec709(const DevelopmentOptions& options, const Observer& photometer,
                       const Spectrum& d65);

/// The matrix that makes tristimulus values of a camera's responses: D65 exactly, and 125 smooth
/// reflectances under it with the least sum of squared errors; a camera whose sensitivities are
/// linear combinations of x̄, ȳ, z̄ exactly.
/// Errors: an input Error when the responses to them are not three independent ones.
struct SensorFit {
  Mat3d responses_to_xyz{1.0};
  double mean_delta_e2000 = 0.0;  ///< Of the reflectances, white at Y = 1.
  double max_delta_e2000 = 0.0;
};
SensorFit fit_sensor(const Observer& sensor, const Observer& photometer, const Spectrum& d65);

}  // namespace abbe
