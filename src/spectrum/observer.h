/// Colour matching functions.
#pragma once

#include <string>

#include "math/vec.h"
#include "spectrum/spectrum.h"

namespace abbe {

/// Three sensitivities, for the CIE observers x̄, ȳ, z̄.
struct Observer {
  std::string id;  ///< "observer/cie1931-2deg".
  Spectrum x_bar, y_bar, z_bar;
};

/// Tristimulus values of a spectrum, K_m ∫ cmf(λ) S(λ) dλ over 360–830 nm, lines included. With S
/// in W·m⁻²·sr⁻¹·nm⁻¹, Y is the luminance in cd/m².
Vec3d xyz_of(const Spectrum& spectrum, const Observer& observer);

}  // namespace abbe
