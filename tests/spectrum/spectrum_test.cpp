#include "abbe/spectrum/spectrum.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "abbe/base/error.h"

namespace abbe {
namespace {

TEST(Spectrum, default_is_zero_everywhere) {
  EXPECT_EQ(Spectrum().value(550.0), 0.0);
  EXPECT_TRUE(Spectrum().is_lines_only());
  EXPECT_EQ(integral(Spectrum()), 0.0);
}

TEST(Spectrum, table_is_linear_between_points_and_obeys_its_rule_outside) {
  const std::vector<double> nm{400.0, 500.0, 520.0}, values{1.0, 3.0, 2.0};
  const Spectrum lamp = Spectrum::tabulated(nm, values, OutsideTable::Zero);
  const Spectrum paint = Spectrum::tabulated(nm, values, OutsideTable::Clamp);
  EXPECT_DOUBLE_EQ(lamp.value(450.0), 2.0);
  EXPECT_DOUBLE_EQ(lamp.value(515.0), 2.25);
  EXPECT_EQ(lamp.value(520.0), 2.0);
  EXPECT_EQ(lamp.value(399.9), 0.0);
  EXPECT_EQ(lamp.value(520.1), 0.0);
  EXPECT_EQ(paint.value(360.0), 1.0);
  EXPECT_EQ(paint.value(830.0), 2.0);
}

TEST(Spectrum, table_with_wavelengths_that_do_not_rise_is_an_input_error) {
  EXPECT_THROW(Spectrum::tabulated({400, 400}, {1, 1}, OutsideTable::Zero), Error);
  EXPECT_THROW(Spectrum::tabulated({}, {}, OutsideTable::Zero), Error);
  EXPECT_THROW(Spectrum::tabulated({400, 500}, {1}, OutsideTable::Zero), Error);
  EXPECT_THROW(Spectrum::tabulated({400, 500}, {1, std::nan("")}, OutsideTable::Zero), Error);
  try {
    Spectrum::tabulated({400, 500, 450}, {1, 1, 1}, OutsideTable::Zero);
    FAIL() << "no error";
  } catch (const Error& error) {
    EXPECT_THAT(error.what(), testing::HasSubstr("row 3"));
  }
}

TEST(Spectrum, blackbody_keeps_wiens_and_stefan_boltzmanns_laws) {
  // Wien: the maximum lies at b/T with b = 2.897771955e6 nm·K (CODATA 2018).
  const Spectrum sun = Spectrum::blackbody(5000.0);
  const double peak_nm = 2.897771955e6 / 5000.0;
  EXPECT_GT(sun.value(peak_nm), sun.value(peak_nm - 1.0));
  EXPECT_GT(sun.value(peak_nm), sun.value(peak_nm + 1.0));
  // Stefan and Boltzmann: radiance integrates to σT⁴/π, σ = 5.670374419e-8 W·m⁻²·K⁻⁴.
  double sum = 0.0;
  for (double nm = 50.0; nm < 200000.0; nm += 5.0) sum += 5.0 * sun.value(nm);
  // The tail beyond 200 µm is 2e-6 of the whole, the coarse sum errs less.
  EXPECT_NEAR(sum, 5.670374419e-8 * std::pow(5000.0, 4) / 3.14159265358979, 1e-5 * sum);
  EXPECT_THROW(Spectrum::blackbody(0.0), Error);
}

TEST(Spectrum, sigmoid_follows_its_formula) {
  const Spectrum curve = Spectrum::sigmoid({1e-4, -0.1, 24.0});
  const double x = 1e-4 * 550.0 * 550.0 - 0.1 * 550.0 + 24.0;
  // x is a small difference of large terms.
  EXPECT_NEAR(curve.value(550.0), 0.5 + x / (2.0 * std::sqrt(1.0 + x * x)), 1e-13);
}

TEST(Spectrum, lines_are_sorted_scaled_and_apart_from_the_continuous_part) {
  const Spectrum lamp = Spectrum::lines({{589.6, 1.0}, {589.0, 2.0}}).scaled(3.0);
  EXPECT_TRUE(lamp.is_lines_only());
  EXPECT_EQ(lamp.value(589.0), 0.0);
  ASSERT_EQ(lamp.lines().size(), 2u);
  EXPECT_EQ(lamp.lines()[0].wavelength_nm, 589.0);
  EXPECT_EQ(lamp.lines()[0].strength, 6.0);
  EXPECT_DOUBLE_EQ(integral(lamp), 9.0);
}

TEST(Spectrum, lines_outside_the_range_do_not_count) {
  EXPECT_EQ(integral(Spectrum::lines({{253.7, 10.0}, {1014.0, 5.0}, {546.1, 1.0}})), 1.0);
}

TEST(Spectrum, integral_of_a_product_of_linear_pieces_is_exact) {
  const Spectrum rising = Spectrum::tabulated({360, 830}, {0, 1}, OutsideTable::Zero);
  const Spectrum falling = Spectrum::tabulated({360, 830}, {1, 0}, OutsideTable::Zero);
  // ∫ t(1 − t) dt = 1/6 over 470 nm; summing 470 intervals costs some roundings.
  EXPECT_NEAR(integral(rising, falling), 470.0 / 6.0, 1e-11);
}

TEST(Spectrum, integral_of_a_lamp_that_ends_with_a_jump_is_exact) {
  const Spectrum lamp = Spectrum::tabulated({400.3, 700.7}, {1, 1}, OutsideTable::Zero);
  EXPECT_NEAR(integral(lamp), 300.4, 1e-11);  // rounding
}

TEST(Spectrum, integral_of_a_constant_is_the_width_of_the_range) {
  EXPECT_NEAR(integral(Spectrum::constant(2.0)), 940.0, 1e-10);  // rounding
}

TEST(Spectrum, product_scales_lines_by_the_other_factor) {
  const Spectrum lamp = Spectrum::lines({{546.1, 2.0}});
  const Spectrum paint = Spectrum::tabulated({500, 600}, {0.0, 1.0}, OutsideTable::Clamp);
  const Spectrum seen = product(paint, lamp);
  ASSERT_EQ(seen.lines().size(), 1u);
  EXPECT_NEAR(seen.lines()[0].strength, 0.922, 1e-12);  // rounding
  EXPECT_TRUE(seen.is_lines_only());
}

TEST(Spectrum, product_equals_the_factors_at_every_whole_nanometre) {
  const Spectrum a = Spectrum::sigmoid({2e-4, -0.2, 48.0});
  const Spectrum b = Spectrum::tabulated({400, 555.5, 700}, {1, 3, 2}, OutsideTable::Zero);
  const Spectrum ab = product(a, b);
  for (double nm = 400.0; nm <= 700.0; nm += 1.0) {
    EXPECT_NEAR(ab.value(nm), a.value(nm) * b.value(nm), 1e-14);  // rounding
  }
  EXPECT_NEAR(ab.value(555.5), a.value(555.5) * b.value(555.5), 1e-14);
  EXPECT_EQ(ab.value(399.0), 0.0);
  EXPECT_EQ(ab.value(701.0), 0.0);
}

TEST(Spectrum, product_with_one_changes_nothing) {
  const Spectrum lamp = Spectrum::tabulated({380, 500, 780}, {5, 1, 3}, OutsideTable::Zero);
  const Spectrum same = product(lamp, Spectrum::constant(1.0));
  EXPECT_NEAR(integral(same), integral(lamp), 1e-10);  // rounding
}

}  // namespace
}  // namespace abbe
