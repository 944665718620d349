#include "abbe/color/lamp/daylight.h"

#include <gtest/gtest.h>

#include <cmath>

#include "abbe/color/lamp/lamp.h"
#include "abbe/load/spectra/catalogue.h"
#include "abbe/load/spectra/computed.h"

namespace abbe {
namespace {

TEST(Daylight, of_the_temperatures_of_the_standard_is_its_illuminants) {
  const Catalogue catalogue = Catalogue::standard();
  const DaylightComponents components = daylight_components(catalogue);
  // 5000, 5500, 6500 and 7500 K by the c2 of 1931 are these by that of 1986.
  const std::pair<const char*, double> illuminants[] = {
      {"D50", 5002.78}, {"D55", 5503.06}, {"D65", 6503.62}, {"D75", 7504.17}};
  for (const auto& [name, temperature_K] : illuminants) {
    const Spectrum made = daylight(temperature_K, components);
    const Spectrum published = catalogue.illuminant(name);
    for (double nm = 300.0; nm <= 830.0; nm += 10.0) {
      EXPECT_NEAR(made.value(nm), published.value(nm), 6e-4) << name << ' ' << nm;  // six digits
    }
  }
}

TEST(Daylight, has_the_chromaticity_and_the_temperature_of_its_name) {
  const Catalogue catalogue = Catalogue::standard();
  const Observer observer = catalogue.observer();
  for (const double temperature_K : {4000.0, 5000.0, 7000.0, 10000.0, 25000.0}) {
    const Vec3d xyz = xyz_of(daylight(temperature_K, daylight_components(catalogue)), observer);
    const Vec2d xy = xy_of_xyz(xyz), wanted = daylight_xy(temperature_K);
    // M1 and M2 rounded to three decimals, and sums at 1 nm in the place of tables at 5 nm.
    EXPECT_NEAR(xy.x, wanted.x, 3e-4) << temperature_K;
    EXPECT_NEAR(xy.y, wanted.y, 3e-4) << temperature_K;
    const auto nearest = correlated_temperature(xyz, observer);
    ASSERT_TRUE(nearest);
    // The cubic in 1/T is a fit; it errs by up to 1.5 % at 25 000 K.
    EXPECT_NEAR(nearest->temperature_K, temperature_K, 0.02 * temperature_K);
  }
}

}  // namespace
}  // namespace abbe
