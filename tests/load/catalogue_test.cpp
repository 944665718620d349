#include "abbe/load/spectra/catalogue.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <functional>
#include <map>
#include <stdexcept>
#include <string>

#include "abbe/base/constants.h"
#include "abbe/base/error.h"

namespace abbe {
namespace {

namespace fs = std::filesystem;
using testing::Contains;
using testing::HasSubstr;

const Catalogue& catalogue() {
  static const Catalogue result = Catalogue::standard();
  return result;
}

std::string message_of(const std::function<void()>& action) {
  try {
    action();
  } catch (const Error& error) {
    EXPECT_EQ(error.detail().kind, ErrorKind::Input);
    return error.what();
  }
  return "no error";
}

// A folder of spectra that goes away with the test.
class Folder {
 public:
  Folder() {
    std::string name = (fs::temp_directory_path() / "abbe_spectra_XXXXXX").string();
    if (!mkdtemp(name.data())) throw std::runtime_error("no temporary folder");
    path_ = name;
  }
  ~Folder() {
    std::error_code ignored;
    fs::remove_all(path_, ignored);
  }
  fs::path write(const std::string& name, const std::string& text) const {
    const fs::path file = path_ / name;
    fs::create_directories(file.parent_path());
    std::ofstream(file, std::ios::binary) << text;
    return file;
  }
  const fs::path& path() const { return path_; }

 private:
  fs::path path_;
};

std::string header(const std::string& quantity, const std::string& range) {
  const std::string unit = quantity == "absorption" ? "1/m"
                           : quantity == "emission" ? "relative"
                                                    : "1";
  return "abbe-spectrum 1\nquantity: " + quantity + "\nunit: " + unit + "\nwavelength: " + range +
         "\nname: a test\nsource: a book (1900)\nlicence: CC0-1.0\n";
}

TEST(Catalogue, every_file_can_be_read_and_says_where_it_comes_from) {
  ASSERT_GT(catalogue().ids().size(), 200u);
  for (const std::string& id : catalogue().ids()) {
    SCOPED_TRACE(id);
    const CatalogueEntry entry = catalogue().entry(id, "test");
    EXPECT_EQ(entry.id, id);
    EXPECT_FALSE(entry.name.empty());
    EXPECT_THAT(entry.source, testing::ContainsRegex("(18|19|20)[0-9][0-9]")) << "a year";
    EXPECT_FALSE(entry.licence.empty());
    EXPECT_TRUE(entry.spectrum || entry.dispersion || entry.observer || (entry.n && entry.k));
  }
}

TEST(Catalogue, glasses_have_the_index_and_abbe_number_of_their_makers_catalogue) {
  int checked = 0;
  for (const std::string& id : catalogue().ids()) {
    const CatalogueEntry entry = catalogue().entry(id, "test");
    if (!entry.n_d) continue;
    SCOPED_TRACE(id);
    ASSERT_TRUE(entry.dispersion.has_value());
    // Catalogues print five decimals of n_d and two of V_d.
    EXPECT_NEAR(refractive_index(*entry.dispersion, kLine_d_nm), *entry.n_d, 5e-6);
    EXPECT_NEAR(abbe_number(*entry.dispersion), *entry.V_d, 0.01);
    ++checked;
  }
  EXPECT_GE(checked, 96);
}

struct Medium {
  const char* id;
  double n_d, V_d;
};

TEST(Catalogue, well_known_media_have_their_published_numbers) {
  // Last printed digits.
  for (const Medium& medium :
       {Medium{"N-BK7", 1.516800, 64.167}, Medium{"F2", 1.62004, 36.37},
        Medium{"SF10", 1.728250, 28.41}, Medium{"N-SF11", 1.78472, 25.68},
        Medium{"N-SF66", 1.922860, 20.88}, Medium{"N-LASF9", 1.85025, 32.17},
        Medium{"N-FK51A", 1.48656, 84.47}, Medium{"fused-silica-malitson", 1.45846, 67.82},
        Medium{"diamond-peter-1923", 2.41749, 55.30}, Medium{"sapphire-o-malitson", 1.76817, 72.31},
        Medium{"pmma-sultanova", 1.49062, 53.18}, Medium{"water-daimon-20c", 1.33340, 55.76}}) {
    SCOPED_TRACE(medium.id);
    const Dispersion dispersion = *catalogue().entry(medium.id, "test").dispersion;
    EXPECT_NEAR(refractive_index(dispersion, kLine_d_nm), medium.n_d, 6e-6);
    EXPECT_NEAR(abbe_number(dispersion), medium.V_d, 6e-3);
  }
}

TEST(Catalogue, water_makes_rainbows_at_the_computed_angles) {
  const Dispersion water = *catalogue().entry("water-daimon-20c", "test").dispersion;
  constexpr double kDegree = kPi / 180.0;
  // Descartes: k inner reflections turn light least where cos² i = (n² − 1)/(k² + 2k).
  const auto bow_degrees = [&](int reflections, double wavelength_nm) {
    const double n = refractive_index(water, wavelength_nm);
    const double k = reflections;
    const double incidence = std::acos(std::sqrt((n * n - 1.0) / (k * k + 2.0 * k)));
    const double inside = std::asin(std::sin(incidence) / n);
    const double turned = 2.0 * incidence - 2.0 * (k + 1.0) * inside;
    return reflections == 1 ? -turned / kDegree : 180.0 + turned / kDegree;
  };
  // Last printed digits.
  EXPECT_NEAR(bow_degrees(1, kLineF_nm), 41.429, 6e-4);
  EXPECT_NEAR(bow_degrees(1, kLine_d_nm), 42.019, 6e-4);
  EXPECT_NEAR(bow_degrees(1, kLineC_nm), 42.295, 6e-4);
  EXPECT_NEAR(bow_degrees(2, kLineF_nm), 52.061, 6e-4);
  EXPECT_NEAR(bow_degrees(2, kLine_d_nm), 50.996, 6e-4);
  EXPECT_NEAR(bow_degrees(2, kLineC_nm), 50.500, 6e-4);
}

TEST(Catalogue, metals_have_the_published_values_at_a_row_of_their_tables) {
  // Johnson & Christy 1972 at 2.26 eV, 548.6 nm.
  const CatalogueEntry gold = catalogue().entry("metal/Au-Johnson", "test");
  EXPECT_NEAR(gold.n->value(548.6), 0.43, 1e-12);
  EXPECT_NEAR(gold.k->value(548.6), 2.455, 1e-12);
  const CatalogueEntry silver = catalogue().entry("Ag-Johnson", "test");
  EXPECT_NEAR(silver.n->value(548.6), 0.06, 1e-12);
  EXPECT_NEAR(silver.k->value(548.6), 3.586, 1e-12);
  for (const char* id : {"Cu-Johnson", "Al-Rakic"}) {
    const CatalogueEntry metal = catalogue().entry(id, "test");
    EXPECT_LE(metal.range_min_nm, 360.0);
    EXPECT_GE(metal.range_max_nm, 830.0);
  }
}

TEST(Catalogue, d65_reaches_830_nanometres_and_lamps_are_dark_outside_their_tables) {
  EXPECT_NEAR(catalogue().illuminant("D65").value(830.0), 60.3125, 1e-9);
  const Spectrum fluorescent = catalogue().illuminant("FL11");
  EXPECT_GT(fluorescent.value(780.0), 0.0);
  EXPECT_EQ(fluorescent.value(781.0), 0.0);
  EXPECT_EQ(fluorescent.value(379.0), 0.0);
}

TEST(Catalogue, tail_of_an_id_begins_at_a_slash) {
  EXPECT_EQ(catalogue().resolve("SF10", "test"), "glass/schott/SF10");
  EXPECT_EQ(catalogue().resolve("N-SF10", "test"), "glass/schott/N-SF10");
  EXPECT_EQ(catalogue().resolve("schott/F2", "test"), "glass/schott/F2");
  EXPECT_EQ(catalogue().resolve("D65", "test"), "illuminant/D65");
  EXPECT_EQ(catalogue().resolve("illuminant/A", "test"), "illuminant/A");
}

TEST(Catalogue, unknown_id_is_an_error_with_the_nearest_names) {
  EXPECT_THAT(message_of([] { catalogue().resolve("N-SF111", "a.gltf: /materials/0"); }),
              testing::AllOf(HasSubstr("a.gltf: /materials/0"), HasSubstr("N-SF111"),
                             HasSubstr("glass/schott/N-SF11")));
  for (const char* id : {"", "/", "..", "../../etc/passwd", "glass", "N-BK7.txt"}) {
    EXPECT_THAT(message_of([id] { catalogue().resolve(id, "here"); }), HasSubstr("here"));
  }
}

TEST(Catalogue, ambiguous_tail_is_an_error_that_lists_the_candidates) {
  const Folder folder;
  const std::string flat =
      header("reflectance", "nm 400 700") + "columns: nm value\n400 1\n700 1\n";
  folder.write("paint/white.txt", flat);
  folder.write("paper/white.txt", flat);
  const Catalogue small({folder.path()});
  EXPECT_THAT(message_of([&] { small.resolve("white", "here"); }),
              testing::AllOf(HasSubstr("paint/white"), HasSubstr("paper/white")));
  EXPECT_EQ(small.resolve("paper/white", "here"), "paper/white");
}

TEST(Catalogue, first_folder_wins_and_missing_folders_are_no_mistake) {
  const Folder first, second;
  const std::string rows = "columns: nm value\n400 0.5\n700 0.5\n";
  first.write("x.txt", header("reflectance", "nm 400 700") + rows);
  second.write("x.txt", header("reflectance", "nm 1 2") + rows);
  second.write("y.txt", header("reflectance", "nm 400 700") + rows);
  second.write("README.md", "not a spectrum");
  const Catalogue both({"/no/such/folder", first.path(), second.path()});
  EXPECT_THAT(both.ids(), testing::ElementsAre("x", "y"));
  EXPECT_EQ(both.entry("x", "test").spectrum->value(500.0), 0.5);
}

TEST(Catalogue, environment_adds_folders_before_the_standard_ones) {
  const Folder folder;
  folder.write("glass/mine.txt",
               header("index", "um 0.4 0.7") + "formula: cauchy\nc0: 1.5\nc: 0.004\np: -2\n");
  ASSERT_EQ(setenv("ABBE_SPECTRA_PATH", (":/no/such:" + folder.path().string()).c_str(), 1), 0);
  const Catalogue extended = Catalogue::standard();
  unsetenv("ABBE_SPECTRA_PATH");
  EXPECT_THAT(extended.ids(), Contains("glass/mine"));
  EXPECT_THAT(extended.ids(), Contains("glass/schott/SF10"));
  EXPECT_NEAR(refractive_index(*extended.entry("mine", "test").dispersion, 500.0), 1.516, 1e-12);
}

TEST(Catalogue, wrong_quantity_is_an_error) {
  EXPECT_THAT(message_of([] { catalogue().illuminant("N-BK7"); }), HasSubstr("index"));
  EXPECT_THAT(message_of([] { catalogue().observer("D65"); }), HasSubstr("emission"));
}

TEST(SpectrumFile, reads_lines_absorption_and_micrometres) {
  const Folder folder;
  const fs::path lines =
      folder.write("lines.txt", header("emission", "nm 588.995 589.592") +
                                    "# sodium\ncolumns: nm strength\n588.995 2\n\n589.592 1\r\n");
  EXPECT_EQ(read_spectrum_file(lines, "lines").spectrum->lines().size(), 2u);
  const fs::path absorption = folder.write(
      "a.txt", header("absorption", "um 0.4 0.7") + "columns: um value\n0.4 1e-2\n0.7 3\n");
  EXPECT_NEAR(read_spectrum_file(absorption, "a").spectrum->value(550.0), 1.505, 1e-12);
  EXPECT_EQ(read_spectrum_file(absorption, "a").range_max_nm, 700.0);
}

TEST(SpectrumFile, broken_files_name_file_line_and_what_is_expected) {
  const std::string reflectance = header("reflectance", "nm 400 700");
  const std::string index = header("index", "um 0.4 0.7");
  struct Case {
    std::string text;
    std::string expected;
  };
  const Case cases[] = {
      {"", ":1: "},
      {"hello\n", "abbe-spectrum 1"},
      {"abbe-spectrum 1\nquantity: loudness\n", ":2: "},
      {"abbe-spectrum 1\nquantity: emission\n", "unit"},
      {"abbe-spectrum 1\nquantity: reflectance\nunit: %\n", ":3: found unit \"%\""},
      {"abbe-spectrum 1\nquantity: absorption\nunit: 1/cm\n", "1/m"},
      {header("reflectance", "nm 0.4 0.7") + "columns: nm value\n0.4 1\n0.7 1\n",
       "um for the unit"},
      {"abbe-spectrum 1\ncolour: red\n", "key \"colour\""},
      {"abbe-spectrum 1\nname: a\nname: b\n", ":3: "},
      {"abbe-spectrum 1\njust words\n", "key: value"},
      {reflectance, "either columns or a formula"},
      {reflectance + "columns: nm value\n", "no rows"},
      {reflectance + "columns: nm n k\n400 1 1\n", "nm value"},
      {reflectance + "columns: um value\n0.4 1\n", "nm value"},
      {reflectance + "columns:\n\n", "nm value"},
      {reflectance + "columns: nm value\n400 1 2\n", ":9: "},
      {reflectance + "columns: nm value\n400 x\n", "finite number"},
      {reflectance + "columns: nm value\n400 nan\n", "finite number"},
      {reflectance + "columns: nm value\n400 1e999\n", "finite number"},
      {reflectance + "columns: nm value\n400 1.5\n700 1\n", "at most 1"},
      {reflectance + "columns: nm value\n400 -0.1\n700 1\n", "at least 0"},
      {reflectance + "columns: nm value\n400 1\n400 1\n", "rising"},
      {reflectance + "columns: nm value\n400 1\n650 1\n", "400 to 650"},
      {reflectance + "formula: cauchy\nc0: 1\n", "only for an index"},
      {header("reflectance", "400 700") + "columns: nm value\n400 1\n", "nm or um"},
      {header("reflectance", "nm 700 400") + "columns: nm value\n400 1\n", "rising range"},
      {index + "columns: um n\n0.4 0.9\n0.7 1.5\n", "at least 1"},
      {index + "formula: magic\n", "sellmeier"},
      {index + "formula: sellmeier\nB: 1 2\nC_um2: 1\n", "as many"},
      {index + "formula: sellmeier\nB: 1\n", "either C_um or C_um2"},
      {index + "formula: sellmeier\nB: 1\nC_um: 1\nC_um2: 1\n", "either C_um or C_um2"},
      {index + "formula: polynomial\nc: 1\np: 2\n", "c0"},
      {index + "formula: cauchy\nc0: 1 2\nc: 1\np: 2\n", "one number"},
      {index + "formula: refractiveindex.info-4\n", "1 to 17"},
  };
  const Folder folder;
  for (const Case& broken : cases) {
    const fs::path file = folder.write("broken.txt", broken.text);
    EXPECT_THAT(message_of([&] { read_spectrum_file(file, "broken"); }),
                testing::AllOf(HasSubstr("broken.txt:"), HasSubstr(broken.expected)))
        << broken.text;
  }
  EXPECT_THAT(message_of([&] { read_spectrum_file(folder.path() / "none.txt", "none"); }),
              HasSubstr("none.txt"));
  EXPECT_THAT(message_of([&] { read_spectrum_file(folder.path(), "folder"); }),
              HasSubstr(folder.path().string()));
}

TEST(Catalogue, a_number_names_daylight_and_black_bodies) {
  const CatalogueEntry daylight = catalogue().entry("daylight/6504", "test");
  EXPECT_EQ(daylight.quantity, "emission");
  const Spectrum D65 = catalogue().illuminant("D65");
  for (double nm = 310.0; nm <= 830.0; nm += 10.0) {
    EXPECT_NEAR(daylight.spectrum->value(nm), D65.value(nm), 0.06);  // M1 is a thousandth further
  }
  EXPECT_EQ(catalogue().entry("blackbody/2856", "test").spectrum->value(560.0),
            Spectrum::blackbody(2856.0).value(560.0));
  EXPECT_EQ(catalogue().resolve("daylight/5000.5", "test"), "daylight/5000.5");
  EXPECT_THAT(message_of([] { catalogue().entry("daylight/3000", "test"); }),
              HasSubstr("4000 to 25000 K"));
  EXPECT_THAT(message_of([] { catalogue().entry("blackbody/-1", "test"); }),
              HasSubstr("300 to 1e+06 K"));
  EXPECT_THAT(message_of([] { catalogue().entry("daylight/warm", "test"); }),
              HasSubstr("daylight/S0"));
}

TEST(Catalogue, each_metal_has_one_paper_that_its_name_alone_stands_for) {
  EXPECT_EQ(catalogue().resolve("metal/Au", "test"), "metal/Au-Johnson");
  EXPECT_EQ(catalogue().resolve("Cu", "test"), "metal/Cu-Johnson");
  std::map<std::string, int> defaults;
  for (const std::string& id : catalogue().ids()) {
    if (!id.starts_with("metal/")) continue;
    const CatalogueEntry entry = catalogue().entry(id, "test");
    int& count = defaults[id.substr(0, id.find('-'))];
    count += entry.is_default;
  }
  EXPECT_GE(defaults.size(), 18u);
  for (const auto& [metal, count] : defaults) EXPECT_EQ(count, 1) << metal;
}

TEST(Catalogue, files_that_cannot_be_read_are_said_and_hide_no_others) {
  const Folder folder;
  folder.write("glasses.agf", "this is no catalogue of glasses\n");
  folder.write("good.csv", "nm,reflectance\n400,0.1\n700,0.9\n");
  const Catalogue mine({folder.path()});
  EXPECT_THAT(mine.ids(), testing::ElementsAre("good"));
  ASSERT_EQ(mine.notes().all().size(), 1u);
  EXPECT_EQ(mine.notes().all().front().kind, NoteKind::Warning);
  EXPECT_THAT(mine.notes().all().front().text, HasSubstr("glasses.agf"));
}

}  // namespace
}  // namespace abbe
