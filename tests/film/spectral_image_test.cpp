#include "abbe/film/spectral_image.h"

#include <gtest/gtest.h>

#include "abbe/base/constants.h"
#include "abbe/base/error.h"
#include "abbe/image/exr/exr.h"
#include "abbe/load/spectra/catalogue.h"

namespace abbe {
namespace {

const Catalogue& catalogue() {
  static const Catalogue result = Catalogue::standard();
  return result;
}
const Observer& cie1931() {
  static const Observer result = catalogue().observer();
  return result;
}
const Spectrum& d65() {
  static const Spectrum result = catalogue().illuminant("illuminant/D65");
  return result;
}

// One pixel that holds the means of a lamp of 1 cd/m² over equal bands.
Image bands_of(const std::string& lamp, double begin_nm, double end_nm, double step_nm) {
  Spectrum light = catalogue().illuminant(lamp);
  light = light.scaled(1.0 / xyz_of(light, cie1931()).y);
  Image image;
  image.width = 1;
  image.height = 1;
  for (double low_nm = begin_nm; low_nm < end_nm - 1e-9; low_nm += step_nm) {
    image.channels.push_back(spectral_channel_name(low_nm + 0.5 * step_nm));
    const Spectrum box =
        Spectrum::tabulated({low_nm, low_nm + step_nm}, {1.0, 1.0}, OutsideTable::Zero);
    image.pixels.push_back(static_cast<float>(integral(light, box) / step_nm));
  }
  return image;
}

void expect_color(const Image& image, const Vec3d& expected, double tolerance) {
  ASSERT_EQ(image.channels, (std::vector<std::string>{"R", "G", "B"}));
  for (std::size_t c = 0; c < 3; ++c) {
    EXPECT_NEAR(image.pixels[c], expected[static_cast<int>(c)], tolerance);
  }
}

TEST(SpectralImage, of_d65_is_white_under_every_observer) {
  const Image spectral = bands_of("illuminant/D65", 360.0, 830.0, 5.0);
  for (const char* observer : {"observer/cie1931-2deg", "observer/cie1964-10deg"}) {
    const DevelopmentOptions options{catalogue().observer(observer), {}, Adaptation::Cat16};
    // D65 and the observer both bend within 5 nm.
    expect_color(developed(spectral, options, cie1931(), d65()), Vec3d(1.0), 1e-3);
  }
}

TEST(SpectralImage, of_a_lamp_that_is_the_white_is_white) {
  const Image spectral = bands_of("illuminant/A", 360.0, 830.0, 5.0);
  const DevelopmentOptions options{
      {}, White{"A", {{catalogue().illuminant("illuminant/A"), 1.0}}, {}}, Adaptation::Cat16};
  expect_color(developed(spectral, options, cie1931(), d65()), Vec3d(1.0),
               3e-4);  // The observer bends.
}

TEST(SpectralImage, order_of_channels_does_not_matter) {
  Image spectral = bands_of("illuminant/A", 380.0, 780.0, 20.0);
  const Image expected = developed(spectral, {}, cie1931(), d65());
  std::reverse(spectral.channels.begin(), spectral.channels.end());
  std::reverse(spectral.pixels.begin(), spectral.pixels.end());
  EXPECT_EQ(developed(spectral, {}, cie1931(), d65()).pixels, expected.pixels);
}

TEST(SpectralImage, lines_count_with_one_nanometre_each) {
  Image spectral;
  spectral.width = 1;
  spectral.height = 1;
  spectral.channels = {spectral_channel_name(486.0), spectral_channel_name(589.0)};
  spectral.pixels = {0.5f, 0.25f};
  spectral.attributes["abbe:lines"] = std::string("486, 589 nm");
  const Vec3d xyz = kLuminousEfficacy_lm_per_W *
                    (0.5 * Vec3d(cie1931().x_bar.value(486), cie1931().y_bar.value(486),
                                 cie1931().z_bar.value(486)) +
                     0.25 * Vec3d(cie1931().x_bar.value(589), cie1931().y_bar.value(589),
                                  cie1931().z_bar.value(589)));
  expect_color(developed(spectral, {}, cie1931(), d65()),
               development_for(cie1931(), d65()).xyz_to_rec709 * xyz, 1e-4);  // floats near 100
}

TEST(SpectralImage, without_a_spectrum_or_with_one_band_is_an_input_error) {
  Image image = bands_of("illuminant/A", 500.0, 510.0, 10.0);
  EXPECT_TRUE(has_spectrum(image));
  EXPECT_THROW(developed(image, {}, cie1931(), d65()), Error);
  image.channels = {"R"};
  EXPECT_FALSE(has_spectrum(image));
  EXPECT_THROW(developed(image, {}, cie1931(), d65()), Error);
}

}  // namespace
}  // namespace abbe
