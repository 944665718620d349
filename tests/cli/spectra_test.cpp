/// `abbe spectra`: list, show and plot.
#include <gmock/gmock.h>

#include <nlohmann/json.hpp>

#include "program.h"

namespace abbe::test {
namespace {

using nlohmann::json;
using testing::HasSubstr;
using testing::Not;

class SpectraTest : public ProgramTest {
 protected:
  std::string refused(const Arguments& arguments, int exit_code) const {
    const Outcome run = abbe(arguments);
    EXPECT_EQ(run.exit_code, exit_code);
    EXPECT_TRUE(is_one_error_line(run.err));
    return run.err;
  }
};

TEST_F(SpectraTest, list_keeps_only_what_all_filters_let_through) {
  const json glasses =
      parsed({"spectra", "list", "--kind", "glass", "--nd", "1.7:1.75", "--vd", ":35", "--json"});
  ASSERT_FALSE(glasses.empty());
  bool has_SF10 = false;
  for (const json& glass : glasses) {
    EXPECT_EQ(glass.at("kind"), "glass");
    EXPECT_GE(glass.at("n_d").get<double>(), 1.7);
    EXPECT_LE(glass.at("n_d").get<double>(), 1.75);
    EXPECT_LE(glass.at("V_d").get<double>(), 35.0);
    has_SF10 |= glass.at("id") == "glass/schott/SF10";
  }
  EXPECT_TRUE(has_SF10);  // 1.728250 and 28.41.
  for (const json& lamp : parsed({"spectra", "list", "--kind", "emission", "--json"})) {
    EXPECT_EQ(lamp.at("quantity"), "emission");
  }
  EXPECT_EQ(parsed({"spectra", "list", "johnson", "--kind", "metal", "--json"}).at(0).at("kind"),
            "metal");
}

TEST_F(SpectraTest, list_with_a_wrong_filter_says_what_would_be_right) {
  EXPECT_THAT(refused({"spectra", "list", "--kind", "glas"}, 2), HasSubstr("crystal"));
  EXPECT_THAT(refused({"spectra", "list", "--nd", "1.8:1.7"}, 2), HasSubstr("A:B"));
  EXPECT_THAT(refused({"spectra", "list", "--vd", "high"}, 2), HasSubstr("--vd"));
}

TEST_F(SpectraTest, show_of_a_glass_gives_n_at_the_wavelengths_asked_for) {
  const json glass =
      parsed({"spectra", "show", "N-BK7", "--at", "486.1327,587.5618,656.2725", "--json"});
  EXPECT_EQ(glass.at("kind"), "glass");
  EXPECT_TRUE(glass.contains("licence"));
  EXPECT_EQ(glass.at("range_nm"), json::array({300.0, 2500.0}));
  EXPECT_FALSE(glass.at("n").empty());
  const auto n = [&](int i) { return glass.at("at").at(i).at("n").get<double>(); };
  // The definition of V_d, of the three values; 0.01 is to what the catalogue is rounded.
  EXPECT_NEAR((n(1) - 1.0) / (n(0) - n(2)), 64.17, 0.01);
  EXPECT_NEAR(glass.at("V_d").get<double>(), 64.17, 0.01);
  EXPECT_THAT(refused({"spectra", "show", "N-BK7", "--at", "1e3"}, 2), HasSubstr("360 to 830"));
}

TEST_F(SpectraTest, show_of_a_lamp_gives_its_white_and_temperature) {
  const json A = parsed({"spectra", "show", "illuminant/A", "--json"});
  EXPECT_NEAR(A.at("white_xy").at(0).get<double>(), 0.44757, 2e-5);  // CIE 15, five digits.
  EXPECT_NEAR(A.at("white_xy").at(1).get<double>(), 0.40745, 2e-5);
  // A is a black body of 2848 K with the c2 of 1931, 0.01435: 2855.5 K with today's 0.014388.
  EXPECT_NEAR(A.at("CCT_K").get<double>(), 2848.0 * 0.01438777 / 0.01435,
              0.1);  // The table's digits.
  EXPECT_NEAR(A.at("Duv").get<double>(), 0.0, 1e-5);
  const json D65 = parsed({"spectra", "show", "D65", "--json"});
  EXPECT_NEAR(D65.at("CCT_K").get<double>(), 6504.0, 2.0);  // CIE 15 says "approximately 6504 K".
  EXPECT_NEAR(D65.at("Duv").get<double>(), 0.0032, 1e-4);   // To its usual four places.
}

TEST_F(SpectraTest, show_of_a_lamp_that_is_none_is_refused) {
  EXPECT_THAT(refused({"spectra", "show", "N-BK7", "--lamp", "metal/Au-Johnson"}, 2),
              HasSubstr("a lamp"));
}

TEST_F(SpectraTest, plot_writes_one_curve_for_each_name) {
  const Outcome run = abbe({"spectra", "plot", "N-BK7", "N-SF11", "-o", "a.svg"});
  EXPECT_EQ(run.exit_code, 0) << run.err;
  const std::string svg = bytes("a.svg");
  std::size_t curves = 0;
  for (std::size_t at = 0; (at = svg.find("<polyline", at)) != std::string::npos; ++at) ++curves;
  EXPECT_EQ(curves, 2u);
  EXPECT_THAT(svg, HasSubstr("</svg>"));
  EXPECT_THAT(svg, HasSubstr(">N-SF11</text>"));
  EXPECT_THAT(svg, Not(HasSubstr("nan")));
  // The same on stdout.
  EXPECT_EQ(abbe({"spectra", "plot", "N-BK7", "N-SF11"}).out, svg);
}

TEST_F(SpectraTest, plot_draws_the_glass_map_and_the_chromaticity_diagram) {
  const std::string map = abbe({"spectra", "plot", "--diagram", "glass-map"}).out;
  EXPECT_THAT(map, HasSubstr("Abbe number V_d"));
  EXPECT_THAT(map, Not(HasSubstr("nan")));
  const std::string xy = abbe({"spectra", "plot", "--diagram", "chromaticity", "A", "FL11"}).out;
  EXPECT_THAT(xy, HasSubstr(">FL11</text>"));
  EXPECT_THAT(xy, HasSubstr("Rec.2020"));
}

TEST_F(SpectraTest, plot_of_what_shares_no_axis_is_refused) {
  EXPECT_THAT(refused({"spectra", "plot", "D65", "N-BK7"}, 2), HasSubstr("one quantity"));
  EXPECT_THAT(refused({"spectra", "plot"}, 2), HasSubstr("what to plot"));
  EXPECT_THAT(refused({"spectra", "plot", "D65", "--diagram", "glass-map"}, 2),
              HasSubstr("dispersion"));
  EXPECT_THAT(refused({"spectra", "plot", "D65", "--diagram", "pie"}, 2), HasSubstr("glass-map"));
  EXPECT_THAT(refused({"spectra", "plot", "D65", "-o", "a.png"}, 2), HasSubstr(".svg"));
}

}  // namespace
}  // namespace abbe::test
