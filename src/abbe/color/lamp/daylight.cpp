#include "abbe/color/lamp/daylight.h"

#include <cmath>
#include <utility>
#include <vector>

namespace abbe {
namespace {

double to_three_decimals(double value) {
  return std::round(value * 1e3) / 1e3;
}

}  // namespace

Vec2d daylight_xy(double temperature_K) {
  const double t = 1e3 / temperature_K;
  const double x = temperature_K <= 7000.0 ? ((-4.6070 * t + 2.9678) * t + 0.09911) * t + 0.244063
                                           : ((-2.0064 * t + 1.9018) * t + 0.24748) * t + 0.237040;
  return {x, (-3.0 * x + 2.870) * x - 0.275};
}

Spectrum daylight(double temperature_K, const DaylightComponents& components) {
  const Vec2d xy = daylight_xy(temperature_K);
  const double M = 0.0241 + 0.2562 * xy.x - 0.7341 * xy.y;
  const double M1 = to_three_decimals((-1.3515 - 1.7703 * xy.x + 5.9114 * xy.y) / M);
  const double M2 = to_three_decimals((0.0300 - 31.4424 * xy.x + 30.0717 * xy.y) / M);
  std::vector<double> wavelengths_nm, values;
  for (const double nm : components.S0.table_points_nm()) {
    wavelengths_nm.push_back(nm);
    values.push_back(components.S0.value(nm) + M1 * components.S1.value(nm) +
                     M2 * components.S2.value(nm));
  }
  return Spectrum::tabulated(std::move(wavelengths_nm), std::move(values), OutsideTable::Zero);
}

}  // namespace abbe
