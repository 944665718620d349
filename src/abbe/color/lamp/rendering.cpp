#include "abbe/color/lamp/rendering.h"

#include <cmath>

#include "abbe/color/lamp/lamp.h"

namespace abbe {
namespace {

// Responses of von Kries' adaptation in the u, v diagram.
struct Responses {
  double c, d;
};

Responses responses_of(const Vec2d& uv) {
  return {(4.0 - uv.x - 10.0 * uv.y) / uv.y, (1.708 * uv.y + 0.404 - 1.481 * uv.x) / uv.y};
}

// W*, U*, V* relative to a white.
Vec3d wuv_of(double Y, const Vec2d& uv, const Vec2d& uv_white) {
  const double W = 25.0 * std::cbrt(Y) - 17.0;
  return {W, 13.0 * W * (uv.x - uv_white.x), 13.0 * W * (uv.y - uv_white.y)};
}

}  // namespace

std::optional<ColorRendering> color_rendering(const Spectrum& lamp, const Observer& observer,
                                              const std::array<Spectrum, 14>& samples,
                                              const DaylightComponents& components) {
  const Vec3d xyz_lamp = xyz_of(lamp, observer);
  const auto nearest = correlated_temperature(xyz_lamp, observer);
  constexpr double kDaylightFrom_K = 5000.0;
  if (!nearest || nearest->temperature_K > kCoolestDaylight_K) return std::nullopt;
  ColorRendering result;
  result.reference_temperature_K = nearest->temperature_K;
  result.reference_is_daylight = nearest->temperature_K >= kDaylightFrom_K;
  const Spectrum reference = result.reference_is_daylight
                                 ? daylight(nearest->temperature_K, components)
                                 : Spectrum::blackbody(nearest->temperature_K);
  const Vec3d xyz_reference = xyz_of(reference, observer);
  const Vec2d uv_lamp = uv_1960_of_xyz(xyz_lamp), uv_reference = uv_1960_of_xyz(xyz_reference);
  const Responses of_lamp = responses_of(uv_lamp), of_reference = responses_of(uv_reference);
  for (std::size_t i = 0; i < samples.size(); ++i) {
    const Vec3d under_lamp = xyz_of(product(lamp, samples[i]), observer);
    const Vec3d under_reference = xyz_of(product(reference, samples[i]), observer);
    const Responses seen = responses_of(uv_1960_of_xyz(under_lamp));
    const double c = of_reference.c / of_lamp.c * seen.c, d = of_reference.d / of_lamp.d * seen.d;
    const double below = 16.518 + 1.481 * c - d;
    const Vec2d adapted{(10.872 + 0.404 * c - 4.0 * d) / below, 5.520 / below};
    const Vec3d difference = wuv_of(100.0 * under_lamp.y / xyz_lamp.y, adapted, uv_reference) -
                             wuv_of(100.0 * under_reference.y / xyz_reference.y,
                                    uv_1960_of_xyz(under_reference), uv_reference);
    result.special[i] = 100.0 - 4.6 * glm::length(difference);
    constexpr double kGeneral = 8.0;
    if (static_cast<double>(i) < kGeneral) result.general += result.special[i] / kGeneral;
  }
  return result;
}

}  // namespace abbe
