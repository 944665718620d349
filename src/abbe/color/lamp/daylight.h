/// CIE daylight of any correlated colour temperature.
#pragma once

#include "abbe/math/vec.h"
#include "abbe/spectrum/spectrum.h"

namespace abbe {

/// The mean of measured daylights and the two directions in which they differ most.
struct DaylightComponents {
  Spectrum S0, S1, S2;
};

inline constexpr double kWarmestDaylight_K = 4000.0;
inline constexpr double kCoolestDaylight_K = 25000.0;

/// S0 + M1 S1 + M2 S2, M1 and M2 rounded to three decimals as the standard has it; 100 at 560 nm.
/// D65 is that of 6503.62 K: 6500 K with the c2 of today, 0.014388 m·K.
/// Domain: temperature_K from 4000 to 25 000.
/// Source: CIE 15:2018, 4.1.2.
Spectrum daylight(double temperature_K, const DaylightComponents& components);

/// Its chromaticity x, y.
Vec2d daylight_xy(double temperature_K);

}  // namespace abbe
