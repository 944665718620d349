#include "abbe/color/lamp/rendering.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "abbe/load/spectra/catalogue.h"
#include "abbe/load/spectra/computed.h"

namespace abbe {
namespace {

ColorRendering rendering_of(const std::string& lamp) {
  const Catalogue catalogue = Catalogue::standard();
  std::array<Spectrum, 14> samples;
  for (std::size_t i = 0; i < samples.size(); ++i) {
    samples[i] = *catalogue.entry(fmt::format("reflectance/cri/TCS{:02}", i + 1), "test").spectrum;
  }
  return color_rendering(catalogue.illuminant(lamp), catalogue.observer(), samples,
                         daylight_components(catalogue))
      .value();
}

TEST(ColorRendering, lamps_that_are_references_show_all_colours_as_they_should) {
  for (const char* lamp : {"blackbody/2856", "blackbody/4500", "D65", "daylight/9000", "A"}) {
    const ColorRendering rendering = rendering_of(lamp);
    // D65's name is rounded, and a daylight's nearest black body is not quite of its temperature.
    EXPECT_GT(rendering.general, 99.6) << lamp;
    for (const double index : rendering.special) EXPECT_GT(index, 99.0) << lamp;
  }
}

TEST(ColorRendering, fluorescent_lamps_have_the_published_indices) {
  // colour-science 0.4.6, by sums at 1 nm and Robertson's temperature: within two tenths.
  EXPECT_NEAR(rendering_of("FL2").general, 64.234, 0.2);
  EXPECT_NEAR(rendering_of("FL11").general, 82.859, 0.2);
}

TEST(ColorRendering, all_fourteen_agree_with_the_table_of_the_standard) {
  // CIE 15:2004, table T.8.2: whole numbers of sums at 5 nm. Lamps with peaks depend on that: R3 of
  // FL3.11 is 49.26 at 5 nm and 50.16 at 1 nm (computed apart). So 0.5 of rounding and 0.9.
  constexpr double kRoundingAndStep = 1.4;
  const std::array<double, 14> of_FL3_1{42, 69, 89, 39, 41, 52, 66, 13, -109, 29, 19, 21, 47, 93};
  const std::array<double, 14> of_FL3_11{90, 86, 49, 82, 81, 70, 85, 79, 24, 34, 64, 50, 90, 67};
  const ColorRendering warm = rendering_of("FL3.1"), cold = rendering_of("FL3.11");
  EXPECT_FALSE(warm.reference_is_daylight);
  EXPECT_TRUE(cold.reference_is_daylight);
  EXPECT_NEAR(cold.general, 78.0, 1.0);
  for (std::size_t i = 0; i < 14; ++i) {
    EXPECT_NEAR(warm.special[i], of_FL3_1[i], kRoundingAndStep) << "R" << i + 1;
    EXPECT_NEAR(cold.special[i], of_FL3_11[i], kRoundingAndStep) << "R" << i + 1;
  }
}

TEST(ColorRendering, sodium_light_shows_no_colours) {
  EXPECT_LT(rendering_of("HP1").general, 30.0);
}

TEST(ColorRendering, light_far_from_white_has_none) {
  const Catalogue catalogue = Catalogue::standard();
  std::array<Spectrum, 14> samples;
  EXPECT_FALSE(color_rendering(Spectrum::lines({{532.0, 1.0}}), catalogue.observer(), samples,
                               daylight_components(catalogue)));
}

}  // namespace
}  // namespace abbe
