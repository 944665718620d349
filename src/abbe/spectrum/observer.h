/// Colour matching functions.
#pragma once

#include <string>

#include "abbe/math/vec.h"
#include "abbe/spectrum/spectrum.h"

namespace abbe {

/// Three sensitivities, for the CIE observers x̄, ȳ, z̄; for a camera those of its channels.
struct Observer {
  std::string id;  ///< "observer/cie1931-2deg".
  Spectrum x_bar, y_bar, z_bar;
  /// What makes tristimulus values of the three responses: the identity for colour matching
  /// functions, a fit for a camera (color/development.h).
  Mat3d responses_to_xyz{1.0};
};

/// Tristimulus values of a spectrum, K_m ∫ cmf(λ) S(λ) dλ over 360–830 nm, lines included. With S
/// in W·m⁻²·sr⁻¹·nm⁻¹, Y is the luminance in cd/m² (of the CIE 1931 observer).
Vec3d xyz_of(const Spectrum& spectrum, const Observer& observer);

/// The three responses themselves, K_m ∫ sensitivity(λ) S(λ) dλ.
Vec3d responses_of(const Spectrum& spectrum, const Observer& observer);

}  // namespace abbe
