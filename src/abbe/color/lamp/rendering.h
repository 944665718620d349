/// How well a lamp shows colours.
#pragma once

#include <array>
#include <optional>

#include "abbe/color/lamp/daylight.h"
#include "abbe/spectrum/observer.h"

namespace abbe {

/// CIE's colour rendering indices of a lamp.
struct ColorRendering {
  double general = 0.0;              ///< Ra: the mean of the first eight.
  std::array<double, 14> special{};  ///< R1 to R14; 100 where a sample looks as it should.
  double reference_temperature_K = 0.0;
  bool reference_is_daylight = false;  ///< From 5000 K on; a black body below.
};

/// Differences of the fourteen test-colour samples under the lamp and under the reference of its
/// colour temperature, in CIE 1964 U*V*W*.
/// Domain: `observer` is the CIE 1931 observer.
/// Errors: none; nothing where the lamp has no correlated colour temperature.
/// Source: CIE 13.3-1995.
std::optional<ColorRendering> color_rendering(const Spectrum& lamp, const Observer& observer,
                                              const std::array<Spectrum, 14>& samples,
                                              const DaylightComponents& components);

}  // namespace abbe
