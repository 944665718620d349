#include "abbe/color/uplift/uplift.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include "abbe/color/color.h"
#include "abbe/color/rgb_space.h"
#include "abbe/color/uplift/object_colors.h"
#include "abbe/load/spectra/catalogue.h"

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
  for (const Vec3d& rgb_rec709 : colors(2000)) {
    differences.push_back(difference(color_of(from_table(rgb_rec709)), rgb_rec709));
  }
  std::sort(differences.begin(), differences.end());
  // Half of these colours lie on faces and edges, where the table is at its worst.
  EXPECT_LT(differences[differences.size() / 2], 0.001);  // measured: 0.0002
  EXPECT_LT(differences.back(), 0.05);
}

// The colours of a lattice of a space, decoded with sRGB's curve, as linear Rec.709.
std::vector<Vec3d> lattice(RgbSpace space, int steps) {
  const Mat3d to_rec709 = rgb_to_rec709(space);
  std::vector<Vec3d> result;
  for (int i = 0; i < steps * steps * steps; ++i) {
    const auto channel = [steps](int step) {
      return srgb_decode(static_cast<double>(step) / (steps - 1));
    };
    result.push_back(to_rec709 * Vec3d(channel(i / steps / steps), channel(i / steps % steps),
                                       channel(i % steps)));
  }
  return result;
}

TEST(Uplift, all_of_4096_colours_of_rec709_come_back_within_a_twentieth_of_a_difference) {
  double of_fit = 0.0, of_table = 0.0;
  int number = 0;
  for (const Vec3d& rgb_rec709 : lattice(RgbSpace::Rec709, 16)) {
    of_table = std::max(of_table, difference(color_of(from_table(rgb_rec709)), rgb_rec709));
    // Every one takes the fit long.
    if (number++ % 4 != 0) continue;
    of_fit = std::max(of_fit, difference(color_of(uplift_rec709(rgb_rec709)), rgb_rec709));
  }
  EXPECT_LT(of_table, 0.05);  // measured: 0.015
  EXPECT_LT(of_fit, 0.002);   // measured: 0.0009
}

TEST(Uplift, colours_of_wider_gamuts_a_tenth_inside_the_solid_come_back_as_well) {
  for (const RgbSpace space : {RgbSpace::DisplayP3, RgbSpace::Rec2020, RgbSpace::AcesCg}) {
    double of_fit = 0.0, of_table = 0.0;
    int inside = 0;
    for (const Vec3d& rgb_rec709 : lattice(space, 12)) {
      // Drawn away from the middle of the solid by a tenth it must still be in it.
      if (!is_object_color(Vec3d(0.5) + (rgb_rec709 - Vec3d(0.5)) / 0.9)) continue;
      of_table = std::max(of_table, difference(color_of(from_table(rgb_rec709)), rgb_rec709));
      if (inside++ % 4 != 0) continue;
      of_fit = std::max(of_fit, difference(color_of(uplift_rec709(rgb_rec709)), rgb_rec709));
    }
    EXPECT_GT(inside, 500) << rgb_space_name(space);
    EXPECT_LT(of_table, 0.05) << rgb_space_name(space);  // measured: 0.02
    EXPECT_LT(of_fit, 0.002) << rgb_space_name(space);   // measured: 0.0012
  }
}

TEST(Uplift, colours_that_no_reflectance_has_become_the_nearest) {
  const Vec3d white = xyz_of_xy(kD65_xy);
  const auto lab_of = [&white](const Vec3d& rgb_rec709) {
    return lab_of_xyz(rec709_to_xyz() * rgb_rec709, white);
  };
  for (const Vec3d& rgb : {Vec3d(1.0, 0.0, 0.0), Vec3d(0.0, 1.0, 0.0), Vec3d(0.1, 1.0, 0.9)}) {
    const Vec3d wanted_rec709 = rgb_to_rec709(RgbSpace::AcesCg) * rgb;
    ASSERT_FALSE(is_object_color(wanted_rec709));
    const Vec3d wanted = lab_of(wanted_rec709);
    const double reached = glm::distance(lab_of(color_of(uplift_rec709(wanted_rec709))), wanted);
    // Optimal colours are bands with sharp edges; the best of them on a grid of 5 nm.
    double best = 1e9;
    for (double from = 380.0; from < 700.0; from += 5.0) {
      for (double to = from + 5.0; to <= 720.0; to += 5.0) {
        for (const bool inverted : {false, true}) {
          const double in = inverted ? 0.0 : 1.0, out = 1.0 - in;
          const Spectrum band = Spectrum::tabulated({from - 1e-3, from, to, to + 1e-3},
                                                    {out, in, in, out}, OutsideTable::Clamp);
          const Vec3d color =
              rec709_of_reflectance(band, data().observer, data().d65, data().development);
          best = std::min(best, glm::distance(lab_of(color), wanted));
        }
      }
    }
    EXPECT_LT(reached, best + 0.5) << rgb.r << ' ' << rgb.g << ' ' << rgb.b;  // the grid's 5 nm
    const double by_table = glm::distance(lab_of(color_of(from_table(wanted_rec709))), wanted);
    EXPECT_LT(by_table, reached + 2.0);  // the table bends where the solid ends
  }
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

TEST(Uplift, greys_outside_zero_to_one_are_white_and_black) {
  EXPECT_EQ(uplift_rec709(Vec3d(2.0)).c2, uplift_rec709(Vec3d(1.0)).c2);
  EXPECT_EQ(uplift_rec709(Vec3d(-0.1)).c2, uplift_rec709(Vec3d(0.0)).c2);
  EXPECT_EQ(uplift_rec709_from_table(Vec3f(2.0f)), uplift_rec709_from_table(Vec3f(1.0f)));
}

TEST(Uplift, tables_of_rec709_and_beyond_meet_at_its_faces) {
  for (const Vec3d& inside : {Vec3d(0.0, 0.4, 0.3), Vec3d(0.9, 0.2, 0.0), Vec3d(1.0, 0.7, 0.5)}) {
    const Vec3d outside = Vec3d(0.5) + (inside - Vec3d(0.5)) * 1.00001;
    // Both within what is promised of each.
    EXPECT_LT(difference(color_of(from_table(inside)), color_of(from_table(outside))), 0.02);
  }
}

TEST(Uplift, mallett_and_yuksels_reflectances_have_the_colours_they_stand_for) {
  double worst = 0.0;
  for (const Vec3d& rgb_rec709 : lattice(RgbSpace::Rec709, 6)) {
    const Spectrum reflectance = uplift_reflectance(Uplift::MallettYuksel, rgb_rec709);
    const Vec3d back =
        rec709_of_reflectance(reflectance, data().observer, data().d65, data().development);
    worst = std::max(worst, difference(back, rgb_rec709));
    for (double nm = 360.0; nm <= 830.0; nm += 5.0) {
      const Vec3d basis = mallett_yuksel_basis(nm);
      // The table's nine digits.
      ASSERT_NEAR(reflectance.value(nm), glm::dot(basis, rgb_rec709), 2e-5);
      ASSERT_NEAR(basis.r + basis.g + basis.b, 1.0, 2e-5);
    }
  }
  // Their basis was optimised for sums at 5 nm over 380 to 780 nm and sRGB's rounded matrix.
  EXPECT_LT(worst, 0.5);
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
    const Spectrum emission = uplift_emission(Uplift::JakobHanika, rgb_rec709, data().d65);
    const Vec3d back = rec709_of_emission(emission, data().observer, data().development);
    const double largest = std::max<double>({rgb_rec709.r, rgb_rec709.g, rgb_rec709.b});
    for (int i = 0; i < 3; ++i) {
      EXPECT_NEAR(back[i], rgb_rec709[i], 1e-5 * largest);  // the fit's own 1e-5 in L*a*b*
    }
  }
}

TEST(Uplift, emission_of_grey_is_d65_itself) {
  const Spectrum emission = uplift_emission(Uplift::JakobHanika, Vec3d(3.0), data().d65);
  for (double nm = 360.0; nm <= 780.0; nm += 30.0) {
    EXPECT_NEAR(emission.value(nm), 3.0 * data().d65.value(nm), 1e-12 * data().d65.value(nm));
  }
}

TEST(Uplift, emission_without_light_is_zero) {
  EXPECT_TRUE(uplift_emission(Uplift::JakobHanika, Vec3d(0.0), data().d65).is_lines_only());
  EXPECT_TRUE(uplift_emission(Uplift::JakobHanika, Vec3d(-1.0), data().d65).is_lines_only());
}

}  // namespace
}  // namespace abbe
