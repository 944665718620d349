#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "abbe/base/error.h"
#include "abbe/load/spectra/foreign.h"

namespace abbe {
namespace {

using testing::HasSubstr;

std::string error_of(const std::string& text, const std::string& id = "mine") {
  try {
    read_csv_spectrum(text, "mine.csv", id);
  } catch (const Error& error) {
    EXPECT_EQ(error.detail().kind, ErrorKind::Input);
    return error.what();
  }
  return "no error";
}

std::string quantity_of(const std::string& text, const std::string& id = "mine") {
  return read_csv_spectrum(text, "mine.csv", id).quantity;
}

TEST(CsvSpectrum, header_or_folder_say_what_it_is) {
  EXPECT_EQ(quantity_of("nm,Reflectance\n400,0.1\n700,0.9\n"), "reflectance");
  EXPECT_EQ(quantity_of("wavelength;transmittance\n400;0.1\n700;0.9\n"), "transmittance");
  EXPECT_EQ(quantity_of("nm absorption(1/m)\n400 3\n700 9\n"), "absorption");
  EXPECT_EQ(quantity_of("nm,power\n400,3\n700,9\n"), "emission");
  EXPECT_EQ(quantity_of("400,3\n700,9\n", "lamp/desk"), "emission");
  EXPECT_EQ(quantity_of("400,0.3\n700,0.9\n", "reflectance/wall"), "reflectance");
  EXPECT_EQ(quantity_of("nm,value\n400,3\n700,9\n"), kPlainTable);
  EXPECT_EQ(quantity_of("400,3\n700,9\n", "lamp"), kPlainTable);  // A file, not a folder.
}

TEST(CsvSpectrum, is_linear_between_its_points) {
  const CatalogueEntry entry = read_csv_spectrum(
      "\xef\xbb\xbf# measured\nnm,reflectance\n400, 0.2\r\n500;0.4 # here\n\n"
      "+700\t0.6\n",
      "mine.csv", "mine");
  EXPECT_DOUBLE_EQ(entry.spectrum->value(450.0), 0.3);
  EXPECT_DOUBLE_EQ(entry.spectrum->value(600.0), 0.5);
  EXPECT_EQ(entry.range_min_nm, 400.0);
  EXPECT_EQ(entry.range_max_nm, 700.0);
}

TEST(CsvSpectrum, mistakes_are_named_with_their_line) {
  EXPECT_THAT(error_of(""), HasSubstr("no row"));
  EXPECT_THAT(error_of("nm,reflectance\n"), HasSubstr("no row"));
  EXPECT_THAT(error_of("500,0.1\n490,0.2\n"), HasSubstr("line 2: found 490 nm after 500 nm"));
  EXPECT_THAT(error_of("500,0.1\n500,0.2\n"), HasSubstr("rising"));
  EXPECT_THAT(error_of("nm,value\nsix,hundred\n"), HasSubstr("line 2"));
  EXPECT_THAT(error_of("500,0.1\n600,nan\n"), HasSubstr("line 2"));
  EXPECT_THAT(error_of("500,0.1,0.2\n"), HasSubstr("line 1"));
  EXPECT_THAT(error_of("-500,0.1\n"), HasSubstr("line 1"));
}

TEST(CsvSpectrum, another_unit_shows_in_where_the_table_lies) {
  EXPECT_THAT(error_of("0.4,0.1\n0.7,0.2\n"), HasSubstr("as if in um"));
  EXPECT_THAT(error_of("4000,0.1\n7000,0.2\n"), HasSubstr("within 360 to 830"));
}

TEST(CsvSpectrum, values_that_the_quantity_cannot_have_are_errors) {
  EXPECT_THAT(error_of("nm,reflectance\n400,10\n700,90\n"),
              HasSubstr("line 2: found reflectance 10"));
  EXPECT_THAT(error_of("nm,power\n400,1\n700,-1\n"), HasSubstr("line 3"));
  EXPECT_EQ(error_of("nm,value\n400,-1\n700,10\n"), "no error");  // Its use decides.
}

}  // namespace
}  // namespace abbe
