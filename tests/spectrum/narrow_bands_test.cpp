#include "abbe/spectrum/narrow_bands.h"

#include <gtest/gtest.h>

#include <cmath>

namespace abbe {
namespace {

Spectrum table(std::vector<double> nm, std::vector<double> values) {
  return Spectrum::tabulated(std::move(nm), std::move(values), OutsideTable::Clamp);
}

Spectrum band(double low_nm, double high_nm, double outside, double inside) {
  return table({low_nm - 0.05, low_nm + 0.05, high_nm - 0.05, high_nm + 0.05},
               {outside, inside, inside, outside});
}

std::vector<NarrowBand> bands_of(const Spectrum& spectrum) {
  return narrow_bands(std::vector<Spectrum>{spectrum});
}

TEST(NarrowBands, narrow_band_or_gap_is_found_with_its_slopes) {
  for (const Spectrum& spectrum : {band(549.0, 551.0, 0.0, 1.0), band(549.0, 551.0, 0.9, 0.1)}) {
    const std::vector<NarrowBand> bands = bands_of(spectrum);
    ASSERT_EQ(bands.size(), 1u);
    // To the next point of a grid of 0.1 nm.
    EXPECT_NEAR(bands[0].low_nm, 548.95, 0.1001);
    EXPECT_NEAR(bands[0].high_nm, 551.05, 0.1001);
  }
}

TEST(NarrowBands, steps_wide_bands_and_smooth_peaks_are_none) {
  EXPECT_TRUE(bands_of(Spectrum::constant(0.5)).empty());
  EXPECT_TRUE(bands_of(table({360, 549.95, 550.05, 830}, {0, 0, 1, 1})).empty());
  EXPECT_TRUE(bands_of(band(540.0, 549.0, 0.0, 1.0)).empty());
  EXPECT_TRUE(bands_of(band(540.0, 549.0, 1.0, 0.0)).empty());
  std::vector<double> nm, peak;
  for (double x = 400.0; x <= 700.0; x += 1.0) {
    nm.push_back(x);
    peak.push_back(std::exp(-0.5 * std::pow((x - 550.0) / 10.0, 2)));
  }
  EXPECT_TRUE(bands_of(table(nm, peak)).empty());
}

TEST(NarrowBands, low_bands_are_none) {
  EXPECT_TRUE(bands_of(band(549.0, 551.0, 0.04, 0.14)).empty());
}

TEST(NarrowBands, bands_of_several_spectra_are_united_and_cut_to_eight_nanometres) {
  const std::vector<Spectrum> spectra{band(500.0, 502.0, 0, 1), band(501.0, 506.0, 0, 1),
                                      band(505.0, 511.0, 0, 1), band(600.0, 602.0, 0, 1)};
  const std::vector<NarrowBand> bands = narrow_bands(spectra);
  ASSERT_EQ(bands.size(), 3u);
  EXPECT_NEAR(bands[0].low_nm, 499.95, 0.1001);
  EXPECT_EQ(bands[0].high_nm, bands[1].low_nm);
  EXPECT_NEAR(bands[1].high_nm, 511.05, 0.1001);
  EXPECT_GT(bands[2].low_nm, 599.0);
}

}  // namespace
}  // namespace abbe
