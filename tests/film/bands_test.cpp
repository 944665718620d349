#include "abbe/film/bands.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>

#include "abbe/base/error.h"

namespace abbe {
namespace {

TEST(Bands, whole_range_by_5_nm_is_94_bands_from_362_5) {
  const BandOptions bands = parse_bands("360:830:5");
  EXPECT_EQ(bands.count(), 94);
  EXPECT_EQ(bands.center_nm(0), 362.5);
  EXPECT_EQ(bands.center_nm(93), 827.5);
  EXPECT_EQ(bands.low_nm(94), 830.0);
}

TEST(Bands, decimal_steps_count_as_written) {
  EXPECT_EQ(parse_bands("400:401:0.1").count(), 10);
  EXPECT_EQ(parse_bands("400.5:700.5:2.5").count(), 120);
  EXPECT_EQ(parse_bands("380:780:400").count(), 1);
}

TEST(Bands, wavelength_belongs_to_the_band_that_begins_at_or_below_it) {
  const BandOptions bands = parse_bands("400:700:10");
  EXPECT_EQ(bands.index_of(400.0), 0);
  EXPECT_EQ(bands.index_of(409.999), 0);
  EXPECT_EQ(bands.index_of(410.0), 1);
  EXPECT_EQ(bands.index_of(699.999), 29);
  EXPECT_FALSE(bands.index_of(700.0));
  EXPECT_FALSE(bands.index_of(399.999));
}

TEST(Bands, edges_of_inexact_steps_belong_to_the_upper_band) {
  const BandOptions bands = parse_bands("400:401:0.1");
  for (int i = 0; i < bands.count(); ++i) EXPECT_EQ(bands.index_of(bands.low_nm(i)), i);
}

TEST(Bands, wrong_text_is_a_usage_error) {
  for (const char* text :
       {"", "360", "360:830", "360:830:5:1", "a:b:c", "360:830:", "360:830:5 ", "830:360:5",
        "360:360:5", "300:830:5", "360:900:5", "360:830:0", "360:830:-5", "360:830:7",
        "360:830:nan", "360:inf:5", "360:830:0.01", "360:830:1e-9", "360,830,5"}) {
    try {
      parse_bands(text);
      ADD_FAILURE() << "no error for '" << text << "'";
    } catch (const Error& error) {
      EXPECT_EQ(error.detail().kind, ErrorKind::Usage) << text;
      EXPECT_THAT(error.what(), ::testing::HasSubstr("bands")) << text;
    }
  }
}

TEST(Bands, numbers_of_a_program_have_the_rules_of_the_text) {
  EXPECT_EQ((BandOptions{400.0, 700.0, 10.0}.count()), 30);
  EXPECT_NO_THROW(check_bands({400.0, 700.0, 10.0}));
  const double nan = std::numeric_limits<double>::quiet_NaN();
  for (const BandOptions& bands :
       {BandOptions{400.0, 700.0, -10.0}, BandOptions{700.0, 400.0, 10.0},
        BandOptions{100.0, 2000.0, 10.0}, BandOptions{400.0, 700.0, 0.0},
        BandOptions{400.0, 700.0, nan}, BandOptions{nan, 700.0, 10.0},
        BandOptions{360.0, 830.0, 0.01}, BandOptions{400.0, 700.0, 7.0}}) {
    EXPECT_THROW(check_bands(bands), Error) << bands_text(bands);
  }
}

}  // namespace
}  // namespace abbe
