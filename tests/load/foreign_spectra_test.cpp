#include "abbe/load/spectra/foreign.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "abbe/base/constants.h"
#include "abbe/base/error.h"

namespace abbe {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

std::string message_of(const std::function<void()>& action) {
  try {
    action();
  } catch (const Error& error) {
    EXPECT_EQ(error.detail().kind, ErrorKind::Input);
    return error.what();
  }
  return "no error";
}

CatalogueEntry yaml(const std::string& data) {
  return read_refractiveindex_yaml("REFERENCES: \"A book (1900)\"\nDATA:\n" + data, "a.yml",
                                   "my/a");
}

CatalogueEntry formula(int number, const std::string& coefficients) {
  return yaml("  - type: formula " + std::to_string(number) +
              "\n    wavelength_range: 0.3 2.5\n    coefficients: " + coefficients + "\n");
}

double n_at(const CatalogueEntry& entry, double um) {
  return refractive_index(*entry.dispersion, um * 1e3);
}

constexpr double kRounding = 1e-12;  // The same formula in another order of operations.

TEST(RefractiveIndexYaml, formulas_give_the_index_of_their_definition) {
  const double um = 0.5, um2 = um * um;
  const double sellmeier = std::sqrt(1.0 + 0.1 + 1.2 * um2 / (um2 - 0.01));
  EXPECT_NEAR(n_at(formula(1, "0.1 1.2 0.1"), um), sellmeier, kRounding);
  EXPECT_NEAR(n_at(formula(2, "0.1 1.2 0.01"), um), sellmeier, kRounding);
  EXPECT_NEAR(n_at(formula(3, "2.25 -0.01 2 0.01 -2"), um),
              std::sqrt(2.25 - 0.01 * um2 + 0.01 / um2), kRounding);
  EXPECT_NEAR(n_at(formula(4, "2.7405 0.0184 0 0.0179 1 0 0 0 1 -0.0155 2"), um),
              std::sqrt(2.7405 + 0.0184 / (um2 - 0.0179) - 0.0155 * um2), kRounding);
  EXPECT_NEAR(n_at(formula(5, "1.5 0.004 -2"), um), 1.5 + 0.004 / um2, kRounding);
  // Tabulated at 0.25 nm: exact at whole nanometres.
  EXPECT_NEAR(n_at(formula(6, "0 0.05792105 238.0185"), um), 1.0 + 0.05792105 / (238.0185 - 4.0),
              kRounding);
  const double L = 1.0 / (um2 - 0.028);
  EXPECT_NEAR(
      n_at(formula(7, "1.5 0.01 0.001 -0.002 0.0003 0.00004"), um),
      1.5 + 0.01 * L + 0.001 * L * L - 0.002 * um2 + 0.0003 * um2 * um2 + 0.00004 * um2 * um2 * um2,
      kRounding);
  const double q = 0.3 + 0.05 * um2 / (um2 - 0.03) - 0.002 * um2;
  EXPECT_NEAR(n_at(formula(8, "0.3 0.05 0.03 -0.002"), um), std::sqrt((1 + 2 * q) / (1 - q)),
              kRounding);
  EXPECT_NEAR(
      n_at(formula(9, "2.2 0.01 0.02 0.03 1.5 0.8"), um),
      std::sqrt(2.2 + 0.01 / (um2 - 0.02) + 0.03 * (um - 1.5) / ((um - 1.5) * (um - 1.5) + 0.8)),
      kRounding);
}

TEST(RefractiveIndexYaml, tabulated_formula_between_its_points_errs_below_1e_6) {
  const CatalogueEntry entry = formula(7, "1.5 0.01 0.001 0 0 0");
  const double um = 0.400125, L = 1.0 / (um * um - 0.028);
  EXPECT_NEAR(n_at(entry, um), 1.5 + 0.01 * L + 0.001 * L * L, 1e-6);  // n″ (0.25 nm)²/8.
}

TEST(RefractiveIndexYaml, formula_with_a_pole_is_read_and_limited) {
  const CatalogueEntry entry = formula(6, "0 1 4");  // Pole at 0.5 µm.
  const auto pole_nm = breakdown_nm(*entry.dispersion);
  ASSERT_TRUE(pole_nm);
  for (double nm = 360.0; nm <= 830.0; nm += 1.0) {
    const double n = refractive_index(*entry.dispersion, nm);
    EXPECT_TRUE(n >= 1.0 && n <= 1000.0) << nm;
  }
}

TEST(RefractiveIndexYaml, table_of_a_metal_is_a_complex_index) {
  const CatalogueEntry gold =
      yaml("  - type: tabulated nk\n    data: |\n        0.4 1.5 2.0\n        0.7 0.1 4.0\n");
  EXPECT_EQ(gold.quantity, "complex index");
  EXPECT_EQ(gold.range_min_nm, 400.0);
  EXPECT_NEAR(gold.k->value(550.0), 3.0, kRounding);  // Half way.
  EXPECT_FALSE(gold.dispersion);
  EXPECT_EQ(gold.source, "A book (1900)");
}

TEST(RefractiveIndexYaml, table_with_a_small_k_is_a_dielectric_that_absorbs) {
  const CatalogueEntry water =
      yaml("  - type: tabulated nk\n    data: |\n        0.4 1.34 1e-8\n        0.7 1.33 1e-8\n");
  EXPECT_EQ(water.quantity, "index");
  EXPECT_NEAR(n_at(water, 0.55), 1.335, kRounding);
  // 4πk/λ, exact at a point of the table.
  EXPECT_NEAR(water.absorption->value(400.0), 4.0 * kPi * 1e-8 / 400e-9, 1e-9);
}

TEST(RefractiveIndexYaml, mistakes_are_named_with_their_line) {
  const auto table = [](const std::string& rows) {
    return message_of([&] { yaml("  - type: tabulated n\n    data: |\n" + rows); });
  };
  EXPECT_THAT(table("        0.7 1.5\n        0.4 1.5\n"), HasSubstr("rising wavelengths"));
  EXPECT_THAT(table("        0.7 1.5 2\n"), HasSubstr("found 3 numbers, expected 2"));
  EXPECT_THAT(table("        \n"), HasSubstr("empty table"));
  EXPECT_THAT(table("        0.7 x\n"), HasSubstr("\"x\""));
  EXPECT_THAT(table("        0.7 nan\n"), HasSubstr("\"nan\""));
  EXPECT_THAT(message_of([] { formula(12, "1 2 3"); }), HasSubstr("formula 1 to 9"));
  EXPECT_THAT(message_of([] { formula(2, "1 2"); }), HasSubstr("a.yml:3"));
  EXPECT_THAT(message_of([] { read_refractiveindex_yaml("a: [", "a.yml", "a"); }),
              HasSubstr("a.yml"));
  EXPECT_THAT(message_of([] { read_refractiveindex_yaml("- 1", "a.yml", "a"); }),
              HasSubstr("DATA"));
  EXPECT_THAT(message_of([] { yaml("  - type: tabulated k\n    data: |\n        0.5 1\n"); }),
              HasSubstr("no n"));
}

const char* const kAgf =
    "CC a catalogue\n"
    "NM N-BK7 2 517642.251 1.5168 64.17 0 1\nGC a crown\n"
    "CD 1.03961212E+00 6.00069867E-03 2.31792344E-01 2.00179144E-02 1.01046945E+00 1.03560653E+02\n"
    "LD 0.3 2.5\nIT 0.4 0.997 10\nIT 0.5 0.998 25\nIT 0.6 1 25\n"
    "NM BK7 1 517642 1.5168 64.17\n"
    "CD 2.2718929 -1.0108077E-2 1.0592509E-2 2.0816965E-4 -7.6472538E-6 4.9240991E-7\n"
    "LD 0.3 2.5\n";

TEST(Agf, formulas_reach_the_index_that_the_maker_states) {
  EXPECT_THAT(names_in_agf(kAgf), ElementsAre("N-BK7", "BK7"));
  for (const char* name : {"N-BK7", "BK7"}) {
    const CatalogueEntry glass = read_agf_glass(kAgf, "S.AGF", name, std::string("S/") + name);
    EXPECT_NEAR(refractive_index(*glass.dispersion, kLine_d_nm), 1.5168, 5e-6);  // Five decimals.
    EXPECT_NEAR(abbe_number(*glass.dispersion), 64.17, 0.01);                    // Two.
    EXPECT_EQ(glass.range_max_nm, 2500.0);
  }
}

TEST(Agf, internal_transmittance_becomes_absorption_per_metre) {
  const CatalogueEntry glass = read_agf_glass(kAgf, "S.AGF", "N-BK7", "S/N-BK7");
  // Beer and Lambert: 0.997 after 10 mm, 0.998 after 25 mm.
  EXPECT_NEAR(glass.absorption->value(400.0), -std::log(0.997) / 0.010, 1e-12);
  EXPECT_NEAR(glass.absorption->value(500.0), -std::log(0.998) / 0.025, 1e-12);
  EXPECT_EQ(glass.absorption->value(600.0), 0.0);
  EXPECT_FALSE(read_agf_glass(kAgf, "S.AGF", "BK7", "S/BK7").absorption);
}

TEST(Agf, every_formula_gives_the_index_of_its_definition) {
  const auto n = [](int number, const std::string& coefficients) {
    const std::string text =
        "NM X " + std::to_string(number) + " 0 1.5 60\nCD " + coefficients + "\nLD 0.3 2\n";
    return n_at(read_agf_glass(text, "a.agf", "X", "a/X"), 0.5);
  };
  const double um = 0.5, w = um * um, L = 1.0 / (w - 0.028);
  EXPECT_NEAR(n(3, "1.5 0.01 0.001 0.002 0.003 0.004"),
              1.5 + 0.01 * L + 0.001 * L * L + 0.002 * w + 0.003 * w * w + 0.004 * w * w * w,
              kRounding);
  EXPECT_NEAR(n(4, "0.2 1.1 0.1 0.01 0.2"),
              std::sqrt(1.2 + 1.1 * w / (w - 0.01) + 0.01 / (w - 0.04)), kRounding);
  EXPECT_NEAR(n(5, "1.5 0.01 0.001"), 1.5 + 0.01 / um + 0.001 / std::pow(um, 3.5), kRounding);
  EXPECT_NEAR(n(6, "0.5 0.01 0.4 0.02 0.1 0.03 0.2 0.04"),
              std::sqrt(1 + 0.5 * w / (w - 0.01) + 0.4 * w / (w - 0.02) + 0.1 * w / (w - 0.03) +
                        0.2 * w / (w - 0.04)),
              kRounding);
  EXPECT_NEAR(n(7, "2.5 0.02 0.01 0.03"), std::sqrt(2.5 + 0.02 / (w - 0.01) - 0.03 * w), kRounding);
  EXPECT_NEAR(n(8, "1.5 0.8 0.01 0.03"), std::sqrt(1.5 + 0.8 * w / (w - 0.01) - 0.03 * w),
              kRounding);
  EXPECT_NEAR(n(9, "1.5 0.8 0.01 0.1 0.02"),
              std::sqrt(1.5 + 0.8 * w / (w - 0.01) + 0.1 * w / (w - 0.02)), kRounding);
  const double base = 2.2 + 0.01 * w + 0.01 / w + 1e-3 / (w * w);
  EXPECT_NEAR(n(10, "2.2 0.01 0.01 1e-3 1e-4 1e-5 1e-6 1e-7"),
              std::sqrt(base + 1e-4 / std::pow(w, 3) + 1e-5 / std::pow(w, 4) +
                        1e-6 / std::pow(w, 5) + 1e-7 / std::pow(w, 6)),
              kRounding);
  EXPECT_NEAR(n(11, "0.5 0.01 0.4 0.02 0.1 0.03 0.1 0.04 0.1 0.05"),
              std::sqrt(1 + 0.5 * w / (w - 0.01) + 0.4 * w / (w - 0.02) + 0.1 * w / (w - 0.03) +
                        0.1 * w / (w - 0.04) + 0.1 * w / (w - 0.05)),
              kRounding);
  EXPECT_NEAR(n(12, "2.2 0.01 0.01 1e-3 1e-4 1e-5 1e-3 1e-4"),
              std::sqrt(base + 1e-4 / std::pow(w, 3) + 1e-5 / std::pow(w, 4) + 1e-3 * w * w +
                        1e-4 * w * w * w),
              kRounding);
  EXPECT_NEAR(n(13, "2.2 0.01 1e-3 0.01 1e-3 1e-4 1e-5 1e-6 1e-7"),
              std::sqrt(base + 1e-3 * w * w + 1e-4 / std::pow(w, 3) + 1e-5 / std::pow(w, 4) +
                        1e-6 / std::pow(w, 5) + 1e-7 / std::pow(w, 6)),
              kRounding);
}

TEST(Agf, utf16_catalogue_is_read_like_ascii) {
  std::string wide = "\xff\xfe";
  for (const char* c = kAgf; *c; ++c) wide += {*c, '\0'};
  EXPECT_THAT(names_in_agf(wide), ElementsAre("N-BK7", "BK7"));
}

TEST(Agf, mistakes_are_named_with_their_line) {
  const auto message = [](const std::string& text, const std::string& glass = "X") {
    return message_of([&] { read_agf_glass(text, "a.agf", glass, "a/X"); });
  };
  EXPECT_THAT(message(kAgf, "N-BK8"), HasSubstr("N-BK7"));
  EXPECT_THAT(message("NM X 2\n"), HasSubstr("a.agf:1"));
  EXPECT_THAT(message("NM X 14 0 1.5 60\nCD 1\nLD 0.3 2\n"), HasSubstr("formula 1 to 13"));
  EXPECT_THAT(message("NM X 2 0 1.5 60\nLD 0.3 2\n"), HasSubstr("no coefficients"));
  EXPECT_THAT(message("NM X 2 0 1.5 60\nCD 1 a\n"), HasSubstr("a.agf:2"));
  EXPECT_THAT(message("NM X 2 0 1.5 60\nLD 2 0.3\n"), HasSubstr("rising range"));
  EXPECT_THAT(message("NM X 2 0 1.5 60\nIT 0.4 1.2 10\n"), HasSubstr("0 to 1"));
  EXPECT_THAT(message("NM X 2 0 1.5 60\nIT 0.4 0.9 10\nIT 0.3 0.9 10\n"),
              HasSubstr("rising wavelengths"));
}

}  // namespace
}  // namespace abbe
