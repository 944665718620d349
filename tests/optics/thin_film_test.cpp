#include "abbe/optics/thin_film.h"

#include <gtest/gtest.h>

#include <cmath>

#include "abbe/base/constants.h"
#include "abbe/optics/fresnel.h"
#include "support/airy.h"

namespace abbe {
namespace {

TEST(ThinFilm, reflectance_equals_the_sum_written_out_over_dielectrics_and_metals) {
  const std::complex<double> substrates[] = {{1.0, 0.0},    {1.5168, 0.0}, {2.4175, 0.0},
                                             {0.43, 2.455}, {0.06, 3.586}, {0.958, 6.69}};
  for (const auto& substrate : substrates) {
    for (const double n_film : {1.33, 1.38, 2.3}) {
      for (const double thickness_nm : {5.0, 120.0, 550.0, 3000.0}) {
        for (const double angle_deg : {0.0, 30.0, 60.0, 80.0, 89.0}) {
          const double cosine = std::cos(angle_deg * kPi / 180.0);
          const double exact = static_cast<double>(
              test::airy_reflectance(cosine, 1.0, n_film, substrate, thickness_nm, 550.0));
          EXPECT_NEAR(thin_film_reflectance(cosine, 1.0, n_film, substrate, thickness_nm, 550.0),
                      exact, 1e-11)  // double precision, a phase of up to 80 rad
              << substrate << " under " << thickness_nm << " nm of " << n_film << " at "
              << angle_deg;
        }
      }
    }
  }
}

TEST(ThinFilm, zero_thickness_equals_no_film) {
  for (const double cosine : {1.0, 0.7, 0.2, 0.01}) {
    EXPECT_NEAR(thin_film_reflectance(cosine, 1.0, 1.33, 1.5168, 0.0, 550.0),
                fresnel_dielectric(cosine, 1.5168).reflectance(), 1e-14);  // the same formula
    EXPECT_NEAR(thin_film_reflectance(cosine, 1.0, 1.33, {0.43, 2.455}, 0.0, 550.0),
                fresnel_conductor(cosine, 0.43, 2.455), 1e-14);  // the same formula
    EXPECT_NEAR(thin_film_reflectance(cosine, 1.5168, 1.33, 1.0, 0.0, 550.0),
                fresnel_dielectric(cosine, 1.0 / 1.5168).reflectance(), 1e-14);
  }
}

TEST(ThinFilm, quarter_wave_layer_of_the_root_index_reflects_nothing) {
  const double n = 1.9;
  const double n_film = std::sqrt(n);
  const double wavelength_nm = 550.0;
  const double quarter_nm = wavelength_nm / (4.0 * n_film);
  EXPECT_NEAR(thin_film_reflectance(1.0, 1.0, n_film, n, quarter_nm, wavelength_nm), 0.0, 1e-15);
  // Half a wave is absent: the bare glass shows.
  EXPECT_NEAR(thin_film_reflectance(1.0, 1.0, n_film, n, 2.0 * quarter_nm, wavelength_nm),
              normal_reflectance(n), 1e-14);
}

TEST(ThinFilm, quarter_wave_of_magnesium_fluoride_has_the_textbook_value) {
  // ((n1 n3 − n2²)/(n1 n3 + n2²))²: 1.26 % for 1.38 on 1.52 (Hecht, Optics, 9.7.2).
  const double expected = std::pow((1.52 - 1.38 * 1.38) / (1.52 + 1.38 * 1.38), 2);
  EXPECT_NEAR(expected, 0.0126, 5e-5);  // as printed
  EXPECT_NEAR(thin_film_reflectance(1.0, 1.0, 1.38, 1.52, 550.0 / (4.0 * 1.38), 550.0), expected,
              1e-14);
}

TEST(ThinFilm, film_of_a_soap_bubble_is_black_where_it_is_thin) {
  // R → 4 R1 β² for β = 2π n d/λ → 0: both faces reflect alike, with opposite signs.
  const double thickness_nm = 1.0;
  const double beta = 2.0 * kPi * 1.33 * thickness_nm / 550.0;
  const double r1 = normal_reflectance(1.33);
  const double sine2 = std::pow(std::sin(beta), 2);
  const double expected = 4.0 * r1 * sine2 / (std::pow(1.0 - r1, 2) + 4.0 * r1 * sine2);
  EXPECT_NEAR(thin_film_reflectance(1.0, 1.0, 1.33, 1.0, thickness_nm, 550.0), expected, 1e-15);
  EXPECT_LT(expected, 2e-5);
}

TEST(ThinFilm, reflection_is_total_past_the_critical_angle_of_the_substrate_whatever_the_film) {
  const double cosine = std::cos(60.0 * kPi / 180.0);  // Critical for glass to air: 41.2°.
  for (const double n_film : {1.2, 1.38, 2.3}) {       // The first is evanescent itself.
    EXPECT_NEAR(thin_film_reflectance(cosine, 1.5168, n_film, 1.0, 300.0, 550.0), 1.0, 1e-13);
  }
}

TEST(ThinFilm, light_tunnels_through_a_gap_of_air_between_glasses) {
  const double cosine = std::cos(50.0 * kPi / 180.0);
  double last = 0.0;
  for (const double gap_nm : {1.0, 30.0, 100.0, 300.0, 1000.0}) {
    const double r = thin_film_reflectance(cosine, 1.5168, 1.0, 1.5168, gap_nm, 550.0);
    EXPECT_NEAR(
        r,
        static_cast<double>(test::airy_reflectance(cosine, 1.5168L, 1.0L, 1.5168L, gap_nm, 550.0L)),
        1e-11);  // double precision
    EXPECT_GT(r, last);
    last = r;
  }
  EXPECT_GT(last, 0.999);
}

TEST(ThinFilm, same_light_passes_in_both_directions) {
  const double sine = 0.6;
  const double outside = std::sqrt(1.0 - sine * sine);
  const double inside = std::sqrt(1.0 - std::pow(sine / 1.5168, 2));
  EXPECT_NEAR(thin_film_reflectance(outside, 1.0, 1.38, 1.5168, 310.0, 550.0),
              thin_film_reflectance(inside, 1.5168, 1.38, 1.0, 310.0, 550.0), 1e-13);  // Stokes
}

}  // namespace
}  // namespace abbe
