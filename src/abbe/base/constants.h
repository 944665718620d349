/// Numbers of the field that more than one module needs, each with its unit in its name.
#pragma once

#include <array>
#include <limits>

namespace abbe {

inline constexpr double kPi = 3.14159265358979323846;
inline constexpr float kInfinity = std::numeric_limits<float>::infinity();

/// The spectral range of the renderer: the CIE 1931 observer's table.
inline constexpr double kRangeMin_nm = 360.0;
inline constexpr double kRangeMax_nm = 830.0;

/// Luminous efficacy of monochromatic light of 540 THz, K_m in lm/W (CIE S 010).
inline constexpr double kLuminousEfficacy_lm_per_W = 683.002;

/// Fraunhofer and spectral lines by which glasses are measured.
inline constexpr double kLineF_nm = 486.1327;
inline constexpr double kLine_d_nm = 587.5618;
inline constexpr double kLineC_nm = 656.2725;

/// Largest number of wavelength lanes a camera sample may carry: 64 by choice and 64 spectral
/// lines.
inline constexpr int kMaxLanes = 128;

}  // namespace abbe
