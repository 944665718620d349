#include "abbe/optics/dispersion.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "abbe/base/constants.h"

namespace abbe {
namespace {

const SellmeierFormula kNBK7{
    0.0, {1.03961212, 0.231792344, 1.01046945}, {0.00600069867, 0.0200179144, 103.560653}};

TEST(Dispersion, sellmeier_gives_the_data_sheet_indices_of_n_bk7) {
  // SCHOTT's data sheet of N-BK7, five decimals.
  EXPECT_NEAR(refractive_index(kNBK7, 435.8343), 1.52668, 5e-6);
  EXPECT_NEAR(refractive_index(kNBK7, kLineF_nm), 1.52238, 5e-6);
  EXPECT_NEAR(refractive_index(kNBK7, 546.0740), 1.51872, 5e-6);
  EXPECT_NEAR(refractive_index(kNBK7, kLine_d_nm), 1.51680, 5e-6);
  EXPECT_NEAR(refractive_index(kNBK7, kLineC_nm), 1.51432, 5e-6);
  EXPECT_NEAR(abbe_number(kNBK7), 64.167, 5e-4);  // last printed digit
}

TEST(Dispersion, sellmeier_constant_term_is_added) {
  const SellmeierFormula shifted{0.25, {}, {}};
  EXPECT_DOUBLE_EQ(refractive_index(shifted, 500.0), std::sqrt(1.25));
}

TEST(Dispersion, polynomial_formula_gives_the_catalogue_index_of_bsc7) {
  const PolynomialFormula bsc7{
      2.2702566,
      {-0.0091988101, 0.011609706, -7.6123911e-05, 2.8558727e-05, -1.2566486e-06},
      {2, -2, -4, -6, -8}};
  EXPECT_NEAR(refractive_index(bsc7, kLine_d_nm), 1.51680, 5e-6);  // catalogue's decimals
  EXPECT_NEAR(abbe_number(bsc7), 64.2, 0.05);
}

TEST(Dispersion, formula_4_equals_its_written_out_form) {
  // Rutile, DeVore 1951: n² = 5.913 + 0.2441/(λ² − 0.0803).
  const RefractiveIndexInfoFormula4 rutile{{5.913, 0.2441, 0, 0.0803, 1, 0, 0, 0, 1}};
  const double squared_um2 = 0.5875618 * 0.5875618;
  EXPECT_NEAR(refractive_index(rutile, kLine_d_nm),
              std::sqrt(5.913 + 0.2441 / (squared_um2 - 0.0803)),
              1e-14);  // rounding
  // Further terms are powers.
  const RefractiveIndexInfoFormula4 longer{{5.0, 0, 0, 0, 0, 0, 0, 0, 0, 0.5, 2, 0.1, -2}};
  EXPECT_NEAR(refractive_index(longer, 500.0), std::sqrt(5.0 + 0.5 * 0.25 + 0.1 / 0.25), 1e-14);
}

TEST(Dispersion, cauchy_through_goes_through_what_it_was_given) {
  for (const auto& [n_d, V_d] : {std::pair{1.5168, 64.17}, std::pair{1.78472, 25.68}}) {
    const CauchyFormula cauchy = cauchy_through(n_d, V_d);
    EXPECT_NEAR(refractive_index(cauchy, kLine_d_nm), n_d, 1e-14);  // rounding
    EXPECT_NEAR(abbe_number(cauchy), V_d, 1e-10);
    EXPECT_NE(cauchy.c0, n_d);  // A is not the index
  }
}

TEST(Dispersion, abbe_number_of_khr_materials_dispersion_is_normative) {
  const AbbeNumber glass{1.5168, 64.17};
  EXPECT_NEAR(refractive_index(glass, 400.0),
              1.5168 + 0.5168 / 64.17 * (523655.0 / 160000.0 - 1.5168), 1e-14);
  EXPECT_NEAR(refractive_index(glass, kLine_d_nm), 1.5168, 1e-6);  // the formula's own constants
  EXPECT_NEAR(abbe_number(glass), 64.17, 0.01);
  // Never below 1.
  EXPECT_EQ(refractive_index(AbbeNumber{1.01, 0.01}, 830.0), 1.0);
}

TEST(Dispersion, constant_index_has_no_dispersion) {
  EXPECT_EQ(refractive_index(ConstantIndex{1.7}, 400.0), 1.7);
  EXPECT_FALSE(is_dispersive(ConstantIndex{1.7}));
  EXPECT_EQ(abbe_number(ConstantIndex{1.7}), std::numeric_limits<double>::infinity());
  EXPECT_TRUE(is_dispersive(kNBK7));
  EXPECT_FALSE(is_dispersive(AbbeNumber{1.5, std::numeric_limits<double>::infinity()}));
}

TEST(Dispersion, poles_and_negative_squares_are_clamped) {
  const SellmeierFormula pole{0.0, {1.0}, {0.25}};  // at 500 nm
  EXPECT_EQ(refractive_index(pole, 500.0), 1000.0);
  EXPECT_EQ(refractive_index(pole, 490.0), 1.0);  // n² < 0 below the pole
}

TEST(Dispersion, tabulated_index_is_linear_and_clamped) {
  const TabulatedIndex table{Spectrum::tabulated({400, 600}, {1.6, 1.5}, OutsideTable::Clamp)};
  EXPECT_DOUBLE_EQ(refractive_index(table, 500.0), 1.55);
  EXPECT_DOUBLE_EQ(refractive_index(table, 830.0), 1.5);
}

}  // namespace
}  // namespace abbe
