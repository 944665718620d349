#include "color/uplift.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include "color/color.h"
#include "load/catalogue.h"

namespace abbe {
namespace {

struct Data {
  Observer observer;
  Spectrum d65;
  Development development;
};

const Data& data() {
  static const Data result = [] {
    const Catalogue catalogue = Catalogue::standard();
    Data made{catalogue.observer(), catalogue.illuminant("D65"), {}};
    made.d65 = made.d65.scaled(1.0 / xyz_of(made.d65, made.observer).y);
    made.development = development_for(made.observer, made.d65);
    return made;
  }();
  return result;
}

// Through the general integrals, which share no code with the fit's own sums.
Vec3d color_of(const SigmoidPolynomial& polynomial) {
  return rec709_of_reflectance(Spectrum::sigmoid(polynomial), data().observer, data().d65,
                               data().development);
}

SigmoidPolynomial from_table(const Vec3d& rgb_rec709) {
  return polynomial_in_nm(Vec3d(uplift_rec709_from_table(Vec3f(rgb_rec709))));
}

double difference(const Vec3d& first_rec709, const Vec3d& second_rec709) {
  const Vec3d white = xyz_of_xy(kD65_xy);
  return delta_e2000(lab_of_xyz(rec709_to_xyz() * first_rec709, white),
                     lab_of_xyz(rec709_to_xyz() * second_rec709, white));
}

// Colours evenly spread in encoded sRGB, and as many on the faces and edges of the gamut.
std::vector<Vec3d> colors(int count) {
  std::mt19937 random(20190500);
  std::uniform_real_distribution<double> uniform;
  std::vector<Vec3d> result;
  for (int i = 0; i < count; ++i) {
    Vec3d rgb_rec709;
    for (int channel = 0; channel < 3; ++channel)
      rgb_rec709[channel] = srgb_decode(uniform(random));
    if (i % 4 == 1) rgb_rec709[i / 4 % 3] = 0.0;
    if (i % 4 == 3) rgb_rec709[i / 4 % 3] = 1.0;
    if (i % 8 == 7) rgb_rec709[(i / 8 + 1) % 3] = 0.0;
    result.push_back(rgb_rec709);
  }
  for (int corner = 0; corner < 8; ++corner) {
    result.emplace_back(corner & 1, corner >> 1 & 1, corner >> 2 & 1);
  }
  return result;
}

TEST(Uplift, single_colours_come_back_as_they_were) {
  for (const Vec3d& rgb_rec709 : colors(400)) {
    const Vec3d back = color_of(uplift_rec709(rgb_rec709));
    // Promised; sums at 1 nm here and there differ by less.
    ASSERT_LT(difference(back, rgb_rec709), 1e-3)
        << rgb_rec709.r << ' ' << rgb_rec709.g << ' ' << rgb_rec709.b;
  }
}

TEST(Uplift, table_brings_colours_back_within_the_promised_differences) {
  std::vector<double> differences;
  for (const Vec3d& rgb_rec709 : colors(4000)) {
    differences.push_back(difference(color_of(from_table(rgb_rec709)), rgb_rec709));
  }
  std::sort(differences.begin(), differences.end());
  // Half of these colours lie on faces and edges, where the table is at its worst.
  EXPECT_LT(differences[differences.size() / 2], 0.001);  // measured: 0.0002
  EXPECT_LT(differences[differences.size() * 995 / 1000], 0.05);
  EXPECT_LT(differences.back(), 0.3);
}

TEST(Uplift, table_promises_a_twentieth_of_a_difference_for_999_of_1000_codes_of_srgb) {
  std::mt19937 random(7);
  std::vector<double> differences;
  for (int i = 0; i < 3000; ++i) {
    Vec3d rgb_rec709;
    for (int channel = 0; channel < 3; ++channel) {
      rgb_rec709[channel] = srgb_decode(static_cast<double>(random() % 256) / 255.0);
    }
    differences.push_back(difference(color_of(from_table(rgb_rec709)), rgb_rec709));
  }
  std::sort(differences.begin(), differences.end());
  EXPECT_LT(differences[differences.size() * 999 / 1000], 0.05);
}

TEST(Uplift, reflectances_stay_between_zero_and_one) {
  for (const Vec3d& rgb_rec709 : colors(200)) {
    for (const SigmoidPolynomial& polynomial :
         {uplift_rec709(rgb_rec709), from_table(rgb_rec709)}) {
      const Spectrum spectrum = Spectrum::sigmoid(polynomial);
      for (double nm = 360.0; nm <= 830.0; nm += 5.0) {
        const double value = spectrum.value(nm);
        ASSERT_TRUE(value >= 0.0 && value <= 1.0) << value;
      }
    }
  }
}

TEST(Uplift, greys_are_constant_and_white_is_one) {
  for (const double grey : {0.0, 0.001, 0.18, 0.5, 0.8, 1.0}) {
    for (const SigmoidPolynomial& polynomial :
         {uplift_rec709(Vec3d(grey)), from_table(Vec3d(grey))}) {
      EXPECT_EQ(polynomial.c0, 0.0);
      EXPECT_EQ(polynomial.c1, 0.0);
      // 4096 stands for infinity: 1.5e-8 from 0 and 1.
      EXPECT_NEAR(Spectrum::sigmoid(polynomial).value(555.0), grey, 4e-8);
    }
    if (grey == 1.0) {
      EXPECT_EQ(static_cast<float>(Spectrum::sigmoid(uplift_rec709(Vec3d(grey))).value(500.0)),
                1.0f);
    }
  }
}

TEST(Uplift, near_greys_are_nearly_constant) {
  const Spectrum spectrum = Spectrum::sigmoid(uplift_rec709({0.5, 0.5, 0.502}));
  for (double nm = 380.0; nm <= 780.0; nm += 10.0) EXPECT_NEAR(spectrum.value(nm), 0.5, 0.01);
}

TEST(Uplift, colours_outside_zero_to_one_are_clamped) {
  EXPECT_EQ(uplift_rec709({2.0, -1.0, 0.5}).c0, uplift_rec709({1.0, 0.0, 0.5}).c0);
  EXPECT_EQ(uplift_rec709_from_table({2.0f, -1.0f, 0.5f}),
            uplift_rec709_from_table({1.0f, 0.0f, 0.5f}));
}

TEST(Uplift, table_is_continuous_where_the_largest_channel_changes) {
  for (const double z : {0.05, 0.3, 0.9}) {
    const Vec3d before(z, z * 0.999999, 0.3 * z), after(z * 0.999999, z, 0.3 * z);
    EXPECT_LT(difference(color_of(from_table(before)), color_of(from_table(after))), 0.02);
  }
}

TEST(Uplift, polynomials_in_s_and_nm_are_the_same) {
  const Vec3d c(-3.5, 1.25, 0.75);
  const SigmoidPolynomial polynomial = polynomial_in_nm(c);
  for (const double nm : {360.0, 512.5, 830.0}) {
    const double s = (nm - 595.0) / 235.0;
    EXPECT_NEAR((polynomial.c0 * nm + polynomial.c1) * nm + polynomial.c2,
                (c[0] * s + c[1]) * s + c[2], 1e-11);  // rounding of large terms
  }
  EXPECT_NEAR(glm::length(coefficients_in_s(polynomial) - c), 0.0, 1e-11);
}

TEST(Uplift, emission_has_the_colour_and_luminance_of_its_rgb) {
  for (const Vec3d& rgb_rec709 :
       {Vec3d(1.0), Vec3d(40.0, 3.0, 0.5), Vec3d(0.0, 0.0, 7.0), Vec3d(1e-4, 2e-4, 1e-4)}) {
    const Spectrum emission = uplift_emission_rec709(rgb_rec709, data().d65);
    const Vec3d back = rec709_of_emission(emission, data().observer, data().development);
    const double largest = std::max<double>({rgb_rec709.r, rgb_rec709.g, rgb_rec709.b});
    for (int i = 0; i < 3; ++i) {
      EXPECT_NEAR(back[i], rgb_rec709[i], 1e-5 * largest);  // the fit's own 1e-5 in L*a*b*
    }
  }
}

TEST(Uplift, emission_of_grey_is_d65_itself) {
  const Spectrum emission = uplift_emission_rec709(Vec3d(3.0), data().d65);
  for (double nm = 360.0; nm <= 780.0; nm += 30.0) {
    EXPECT_NEAR(emission.value(nm), 3.0 * data().d65.value(nm), 1e-12 * data().d65.value(nm));
  }
}

TEST(Uplift, emission_without_light_is_zero_and_negative_channels_count_as_zero) {
  EXPECT_TRUE(uplift_emission_rec709(Vec3d(0.0), data().d65).is_lines_only());
  EXPECT_TRUE(uplift_emission_rec709(Vec3d(-1.0), data().d65).is_lines_only());
}

}  // namespace
}  // namespace abbe
