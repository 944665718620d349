#include "abbe/display/display.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <limits>

#include "abbe/base/error.h"
#include "image/temporary_folder.h"

namespace abbe {
namespace {

using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

const std::filesystem::path kConfig = std::filesystem::path(ABBE_SOURCE_DIR) / "config/config.ocio";

Image pixel(float r, float g, float b) {
  Image image;
  image.width = 1;
  image.height = 1;
  image.channels = {"R", "G", "B"};
  image.pixels = {r, g, b};
  return image;
}

DisplayOptions options_for(const std::string& space, const std::string& display,
                           const std::string& view) {
  DisplayOptions options;
  options.config = kConfig;
  options.source_space = space;
  options.display = display;
  options.view = view;
  return options;
}

std::vector<float> shown(const Vec3f& value, const std::string& space, const std::string& display,
                         const std::string& view) {
  return to_display(pixel(value.x, value.y, value.z), options_for(space, display, view)).pixels;
}

constexpr const char* kAces = "ACES 1.0 - SDR Video";
constexpr const char* kSrgb = "sRGB - Display";
constexpr const char* kRec709 = "Linear Rec.709 (sRGB)";

// The variable of whoever runs the tests must not decide them.
class Display : public ::testing::Test {
 protected:
  Display() { ::unsetenv("OCIO"); }
  ~Display() override { ::unsetenv("OCIO"); }
};

TEST_F(Display, aces_sdr_of_middle_grey_is_the_known_code) {
  const auto value = shown(Vec3f(0.18f), "ACEScg", kSrgb, kAces);
  for (const float v : value) {
    EXPECT_NEAR(v, 0.35595f, 2e-5f);  // stated to five places
    EXPECT_EQ(std::lround(v * 255.0f), 91);
  }
}

TEST_F(Display, un_tone_mapped_grey_is_the_curve_of_the_display) {
  const auto srgb = shown(Vec3f(0.18f), "ACEScg", kSrgb, "Un-tone-mapped");
  const auto rec1886 = shown(Vec3f(0.18f), kRec709, "Rec.1886 Rec.709 - Display", "Un-tone-mapped");
  const auto p3 = shown(Vec3f(0.18f), kRec709, "Display P3 - Display", "Un-tone-mapped");
  EXPECT_NEAR(srgb[1], 0.46136f, 2e-5f);  // stated to five places
  for (std::size_t c = 0; c < 3; ++c) {
    EXPECT_NEAR(rec1886[c], std::pow(0.18, 1.0 / 2.4), 1e-4);             // OCIO's fast power
    EXPECT_NEAR(p3[c], 1.055 * std::pow(0.18, 1.0 / 2.4) - 0.055, 1e-4);  // OCIO's fast power
  }
}

TEST_F(Display, pq_of_100_cd_per_m2_is_the_code_of_st_2084) {
  // ST 2084: 100 cd/m² is 0.508078 of the signal.
  const auto value = shown(Vec3f(1.0f), kRec709, "Rec.2100-PQ - Display", "Un-tone-mapped");
  for (const float v : value) EXPECT_NEAR(v, 0.508078f, 2e-4f);  // OCIO's fast power, twice
}

TEST_F(Display, p3_red_on_a_p3_display_is_pure_red) {
  const auto value =
      shown({1.0f, 0.0f, 0.0f}, "Linear P3-D65", "Display P3 - Display", "Un-tone-mapped");
  EXPECT_NEAR(value[0], 1.0f, 1e-4f);  // matrices of float precision, OCIO's fast power
  EXPECT_NEAR(value[1], 0.0f, 1e-4f);  // the same
  EXPECT_NEAR(value[2], 0.0f, 1e-4f);  // the same
}

TEST_F(Display, raw_view_changes_nothing) {
  EXPECT_THAT(shown({0.25f, -3.0f, 7.0f}, kRec709, kSrgb, "Raw"), ElementsAre(0.25f, -3.0f, 7.0f));
}

TEST_F(Display, exposure_doubles_light_per_ev) {
  DisplayOptions options = options_for(kRec709, kSrgb, "Raw");
  options.exposure_ev = 2.0;
  EXPECT_THAT(to_display(pixel(0.25f, 0.5f, 1.0f), options).pixels, ElementsAre(1.0f, 2.0f, 4.0f));
}

TEST_F(Display, auto_exposure_puts_bright_things_near_white_about_middle_grey) {
  Image image = pixel(0.0f, 0.0f, 0.0f);
  image.width = 4;
  const float nan = std::numeric_limits<float>::quiet_NaN();
  // 0.045 and 0.18 have the geometric mean 0.09; black and broken pixels do not count. The mean
  // comes to 0.75 EV above 0.18, before the brighter of two reaches white.
  image.pixels = {0.045f, 0.045f, 0.045f, 0.18f, 0.18f, 0.18f, 0, 0, 0, nan, 1, 1};
  EXPECT_NEAR(auto_exposure_ev(image), 1.75, 1e-6);  // float rounding of the values
  DisplayOptions options = options_for(kRec709, kSrgb, "Raw");
  options.auto_exposure = true;
  options.exposure_ev = 99.0;
  EXPECT_NEAR(to_display(image, options).pixels[3], 0.18f * std::exp2(1.75f), 1e-6f);  // the same
  // Grey with a little white: white stays where it is, below display white.
  image.width = 100;
  image.pixels.assign(300, 0.2f);
  std::fill(image.pixels.begin(), image.pixels.begin() + 30, 0.95f);
  EXPECT_NEAR(auto_exposure_ev(image), 0.0, 1e-6);
  // A lamp in the dark is not worth a black image: 2 EV below middle grey is the least.
  std::fill(image.pixels.begin(), image.pixels.begin() + 30, 1000.0f);
  const double mean = 0.9 * std::log2(0.2) + 0.1 * std::log2(1000.0);
  EXPECT_NEAR(auto_exposure_ev(image), std::log2(0.18) - mean - 2.0, 1e-6);
  EXPECT_EQ(auto_exposure_ev(pixel(0.0f, 0.0f, 0.0f)), 0.0);
}

TEST_F(Display, spectral_colours_stay_finite_and_keep_their_order) {
  // Monochromatic light of Y 1 lies far outside Rec.709: CIE 1931 at 480, 520, 580 and 650 nm.
  struct Line {
    Vec3f xyz;
    int strongest;
  };
  const std::vector<Line> lines{{{0.0956f, 0.1390f, 0.8130f}, 2},
                                {{0.0633f, 0.7100f, 0.0782f}, 1},
                                {{0.9163f, 0.8700f, 0.0017f}, 0},
                                {{0.2835f, 0.1070f, 0.0000f}, 0}};
  for (const std::string view : {kAces, "ACES 1.0 - SDR Video (gamut compressed)"}) {
    for (const float scale : {0.1f, 1.0f, 10.0f}) {
      for (const Line& line : lines) {
        const auto value = shown(scale * line.xyz, "CIE-XYZ-D65", kSrgb, view);
        for (const float v : value) {
          EXPECT_TRUE(std::isfinite(v));
          EXPECT_LT(v, 1.3f);  // ACES SDR may exceed 1 a little
        }
        EXPECT_EQ(std::max_element(value.begin(), value.end()) - value.begin(), line.strongest)
            << view;
      }
    }
  }
}

TEST_F(Display, values_beyond_reason_do_not_become_nan) {
  const float infinity = std::numeric_limits<float>::infinity();
  const float nan = std::numeric_limits<float>::quiet_NaN();
  for (const Vec3f& value : {Vec3f(infinity, 1, 1), Vec3f(-infinity, 0, 0), Vec3f(nan, nan, nan),
                             Vec3f(1e30f, 0, 0), Vec3f(-1e30f, -1e30f, 1e30f)}) {
    for (const char* view : {kAces, "Un-tone-mapped"}) {
      for (const float v : shown(value, kRec709, kSrgb, view)) EXPECT_TRUE(std::isfinite(v));
    }
  }
  EXPECT_GT(shown(Vec3f(infinity), kRec709, kSrgb, kAces)[0], 1.0f);
}

TEST_F(Display, spaces_agree_on_white_and_convert_back) {
  for (const char* space : {"ACEScg", "ACES2065-1", "Linear P3-D65", "Linear Rec.2020"}) {
    Image image = pixel(1.0f, 1.0f, 1.0f);
    DisplayOptions options = options_for(kRec709, kSrgb, kAces);
    convert_space(image, kRec709, space, options);
    for (const float v : image.pixels) EXPECT_NEAR(v, 1.0f, 2e-5f) << space;  // matrices of floats
    image.pixels = {0.2f, 0.5f, 3.0f};
    convert_space(image, kRec709, space, options);
    convert_space(image, space, kRec709, options);
    EXPECT_NEAR(image.pixels[2], 3.0f, 1e-5f) << space;  // matrices of floats, there and back
  }
}

TEST_F(Display, xyz_of_rec709_white_is_d65) {
  Image image = pixel(1.0f, 1.0f, 1.0f);
  convert_space(image, kRec709, "CIE-XYZ-D65", options_for(kRec709, kSrgb, kAces));
  // xy 0.3127, 0.3290 at Y 1.
  EXPECT_NEAR(image.pixels[0], 0.3127f / 0.3290f, 2e-5f);                  // matrices of floats
  EXPECT_NEAR(image.pixels[1], 1.0f, 2e-5f);                               // the same
  EXPECT_NEAR(image.pixels[2], (1 - 0.3127f - 0.3290f) / 0.3290f, 2e-5f);  // the same
}

TEST_F(Display, xyz_of_equal_energy_has_its_white_at_1) {
  Image image = pixel(1.0f, 1.0f, 1.0f);
  convert_space(image, kRec709, "CIE-XYZ-E", options_for(kRec709, kSrgb, kAces));
  for (const float v : image.pixels) EXPECT_NEAR(v, 1.0f, 2e-5f);  // matrices of floats
}

TEST_F(Display, scene_linear_spaces_are_found_by_what_they_do) {
  DisplayOptions options;
  options.config = kConfig;
  EXPECT_THAT(scene_linear_spaces(options),
              testing::UnorderedElementsAre("ACES2065-1", "ACEScg", kRec709, "Linear P3-D65",
                                            "Linear Rec.2020", "CIE-XYZ-D65", "CIE-XYZ-E"));
}

TEST_F(Display, conversion_leaves_other_channels_alone) {
  Image image;
  image.width = 1;
  image.height = 2;
  image.channels = {"Z", "B", "G", "R"};
  image.pixels = {5.0f, 1.0f, 1.0f, 1.0f, 6.0f, 2.0f, 2.0f, 2.0f};
  convert_space(image, kRec709, "ACEScg", options_for(kRec709, kSrgb, kAces));
  EXPECT_EQ(image.pixels[0], 5.0f);
  EXPECT_EQ(image.pixels[4], 6.0f);
  EXPECT_NEAR(image.pixels[7], 2.0f, 4e-5f);  // matrices of floats
}

TEST_F(Display, rows_of_a_large_image_are_those_of_its_pixels) {
  Image image;
  image.width = 33;
  image.height = 57;
  image.channels = {"R", "G", "B"};
  for (int i = 0; i < 33 * 57 * 3; ++i) image.pixels.push_back(static_cast<float>(i % 101) / 50.0f);
  const DisplayOptions options = options_for(kRec709, kSrgb, kAces);
  const Image result = to_display(image, options);
  for (const int y : {0, 20, 56}) {
    const auto single =
        shown({image.at(7, y, 0), image.at(7, y, 1), image.at(7, y, 2)}, kRec709, kSrgb, kAces);
    for (std::size_t c = 0; c < 3; ++c) EXPECT_EQ(result.at(7, y, c), single[c]);
  }
}

template <typename Body>
std::string usage_error_of(const Body& body) {
  try {
    body();
  } catch (const Error& error) {
    EXPECT_EQ(error.detail().kind, ErrorKind::Usage);
    return error.what();
  }
  return "no error";
}

TEST_F(Display, unknown_display_view_or_space_is_a_usage_error_that_lists_the_valid_ones) {
  EXPECT_THAT(usage_error_of([] { shown(Vec3f(1), kRec709, "CRT", kAces); }),
              HasSubstr("sRGB - Display, Rec.1886 Rec.709 - Display, Display P3 - Display, "
                        "Rec.2100-PQ - Display"));
  EXPECT_THAT(usage_error_of([] { shown(Vec3f(1), kRec709, kSrgb, "Filmic"); }),
              HasSubstr("ACES 1.0 - SDR Video"));
  EXPECT_THAT(usage_error_of([] { shown(Vec3f(1), "sRGB2", kSrgb, kAces); }),
              HasSubstr("Linear Rec.709 (sRGB)"));
  EXPECT_THAT(usage_error_of([] {
                Image image = pixel(1, 1, 1);
                convert_space(image, kRec709, "AdobeRGB", options_for(kRec709, kSrgb, kAces));
              }),
              HasSubstr("ACEScg"));
}

TEST_F(Display, image_without_rgb_is_an_input_error) {
  Image image = pixel(1, 1, 1);
  image.channels = {"X", "Y", "Z"};
  EXPECT_THROW(to_display(image, options_for(kRec709, kSrgb, kAces)), Error);
}

TEST_F(Display, embedded_configuration_serves_without_any_file) {
  DisplayOptions options;  // The test program has no config folder near it.
  options.source_space = "ACEScg";
  EXPECT_NEAR(to_display(pixel(0.18f, 0.18f, 0.18f), options).pixels[0], 0.35595f,
              2e-5f);  // as above
}

TEST_F(Display, ocio_variable_chooses_the_configuration_and_an_option_overrules_it) {
  const TemporaryFolder folder;
  const std::string text =
      "ocio_profile_version: 2\nsearch_path: \"\"\nroles: {default: raw}\n"
      "file_rules:\n  - !<Rule> {name: Default, colorspace: default}\n"
      "displays:\n  Screen:\n    - !<View> {name: Plain, colorspace: raw}\n"
      "colorspaces:\n  - !<ColorSpace> {name: raw, isdata: true}\n";
  write_bytes(folder / "own.ocio", std::vector<std::uint8_t>(text.begin(), text.end()));
  ::setenv("OCIO", (folder / "own.ocio").c_str(), 1);
  DisplayOptions options;
  options.display = "Screen";
  options.view = "Plain";
  options.source_space = "raw";
  EXPECT_EQ(to_display(pixel(0.5f, 0.5f, 0.5f), options).pixels[0], 0.5f);
  options.config = kConfig;
  EXPECT_THAT(usage_error_of([&] { to_display(pixel(1, 1, 1), options); }),
              HasSubstr("\"Screen\""));
}

TEST_F(Display, missing_or_broken_configuration_is_an_input_error) {
  const TemporaryFolder folder;
  const std::string text = "ocio_profile_version: 2\ncolorspaces: [";
  write_bytes(folder / "broken.ocio", std::vector<std::uint8_t>(text.begin(), text.end()));
  for (const char* name : {"missing.ocio", "broken.ocio"}) {
    DisplayOptions options;
    options.config = folder / name;
    try {
      to_display(pixel(1, 1, 1), options);
      ADD_FAILURE() << "no error for " << name;
    } catch (const Error& error) {
      EXPECT_EQ(error.detail().kind, ErrorKind::Input);
      EXPECT_THAT(error.what(), HasSubstr(name));
    }
  }
  ::setenv("OCIO", (folder / "missing.ocio").c_str(), 1);
  try {
    to_display(pixel(1, 1, 1), {});
    ADD_FAILURE() << "no error";
  } catch (const Error& error) {
    EXPECT_THAT(error.what(), HasSubstr("$OCIO"));
  }
}

}  // namespace
}  // namespace abbe
