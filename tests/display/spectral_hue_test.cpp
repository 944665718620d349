// The views that keep the hue of spectral colours, judged in the codes that a screen gets.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <optional>

#include "abbe/base/constants.h"
#include "abbe/color/color.h"
#include "abbe/display/display.h"
#include "abbe/load/spectra/catalogue.h"

namespace abbe {
namespace {

constexpr const char* kSdr = "Spectral Hue - SDR Video";
constexpr const char* kHdr = "Spectral Hue - HDR Video (1000 nits)";
constexpr const char* kXyz = "CIE-XYZ-D65";

Image shown(const std::vector<Vec3d>& colors, const std::string& space, const std::string& display,
            const std::string& view) {
  Image image;
  image.width = static_cast<int>(colors.size());
  image.height = 1;
  image.channels = {"R", "G", "B"};
  for (const Vec3d& color : colors) {
    for (int c = 0; c < 3; ++c) image.pixels.push_back(static_cast<float>(color[c]));
  }
  DisplayOptions options;
  options.config = std::filesystem::path(ABBE_SOURCE_DIR) / "config/config.ocio";
  options.source_space = space;
  options.display = display;
  options.view = view;
  return to_display(image, options);
}

using Code = std::array<int, 3>;

std::vector<Code> codes_of(const Image& image) {
  std::vector<Code> codes;
  for (int x = 0; x < image.width; ++x) {
    Code code{};
    for (std::size_t c = 0; c < 3; ++c) {
      code[c] = static_cast<int>(std::lround(std::clamp(image.at(x, 0, c), 0.0f, 1.0f) * 255.0f));
    }
    codes.push_back(code);
  }
  return codes;
}

/// 430 to 650 nm in steps of 10 nm.
enum class Light {
  EqualEnergy,   ///< As many watts in each; XYZ of 555 nm has Y 1.
  EqualMaximum,  ///< As bright a strongest channel of Rec.709 in each.
};

std::vector<Vec3d> monochromatic_xyz(Light light, double exposure_ev) {
  static const Observer observer = Catalogue::standard().observer();
  std::vector<Vec3d> colors;
  for (int nm = 430; nm <= 650; nm += 10) {
    Vec3d xyz(observer.x_bar.value(nm), observer.y_bar.value(nm), observer.z_bar.value(nm));
    if (light == Light::EqualMaximum) {
      const Vec3d rgb_rec709 = xyz_to_rec709() * xyz;
      xyz /= std::max({rgb_rec709.x, rgb_rec709.y, rgb_rec709.z});
    }
    colors.push_back(std::exp2(exposure_ev) * xyz);
  }
  return colors;
}

double hsv_hue(const Code& code) {
  const double r = code[0], g = code[1], b = code[2];
  const double largest = std::max({r, g, b});
  const double range = largest - std::min({r, g, b});
  if (largest == r) return 60.0 * (g - b) / range;
  return largest == g ? 60.0 * (2.0 + (b - r) / range) : 60.0 * (4.0 + (r - g) / range);
}

double lab_hue(const Code& code) {
  Vec3d rgb_rec709(0.0);
  for (int c = 0; c < 3; ++c)
    rgb_rec709[c] = srgb_decode(code[static_cast<std::size_t>(c)] / 255.0);
  const Vec3d lab = lab_of_xyz(rec709_to_xyz() * rgb_rec709, xyz_of_xy(kD65_xy));
  return std::atan2(lab.z, lab.y) * 180.0 / kPi;
}

/// How many of the steps from one code to the next turn back, stand still, or cannot be seen.
template <typename Hue>
int faults(const std::vector<Code>& codes, const Hue& hue) {
  int count = 0;
  double turned = 0.0;
  std::vector<double> steps;
  for (std::size_t i = 1; i < codes.size(); ++i) {
    count += codes[i] == codes[i - 1] ? 1 : 0;
    double step = hue(codes[i]) - hue(codes[i - 1]);
    step -= 360.0 * std::round(step / 360.0);
    steps.push_back(step);
    turned += step;
  }
  for (const double step : steps) count += step * turned <= 0.0 ? 1 : 0;
  return count;
}

class SpectralHue : public ::testing::Test {
 protected:
  SpectralHue() { ::unsetenv("OCIO"); }
};

TEST_F(SpectralHue, of_10_nm_steps_turns_one_way_on_every_display_at_every_exposure) {
  const std::vector<std::pair<const char*, const char*>> views{{"sRGB - Display", kSdr},
                                                               {"Rec.1886 Rec.709 - Display", kSdr},
                                                               {"Display P3 - Display", kSdr},
                                                               {"Rec.2100-PQ - Display", kHdr}};
  for (const auto& [display, view] : views) {
    for (const Light light : {Light::EqualEnergy, Light::EqualMaximum}) {
      // Darker than this, 8 bits have too few codes left for the deepest red.
      for (double ev = -2.0; ev <= 5.0; ev += 0.5) {
        const auto codes = codes_of(shown(monochromatic_xyz(light, ev), kXyz, display, view));
        EXPECT_EQ(faults(codes, hsv_hue), 0) << display << " at " << ev << " EV";
        // Of other displays' codes this is no CIELAB hue, but an angle in much the same circle.
        EXPECT_EQ(faults(codes, lab_hue), 0) << display << " at " << ev << " EV";
      }
    }
  }
}

TEST_F(SpectralHue, is_lost_in_the_other_views) {
  for (const char* view :
       {"ACES 1.0 - SDR Video", "ACES 1.0 - SDR Video (gamut compressed)", "Un-tone-mapped"}) {
    const auto codes =
        codes_of(shown(monochromatic_xyz(Light::EqualEnergy, 0.0), kXyz, "sRGB - Display", view));
    EXPECT_GE(faults(codes, hsv_hue), 3) << view;
  }
}

TEST_F(SpectralHue, does_not_change_with_exposure) {
  const auto dim = monochromatic_xyz(Light::EqualMaximum, -1.0);
  const auto bright = monochromatic_xyz(Light::EqualMaximum, 4.0);
  const Image a = shown(dim, kXyz, "sRGB - Display", kSdr);
  const Image b = shown(bright, kXyz, "sRGB - Display", kSdr);
  for (int x = 0; x < a.width; ++x) {
    // Shares of the largest channel, in linear light: of both brightnesses the same.
    const auto linear = [x](const Image& image) {
      Vec3d rgb_rec709(0.0);
      for (int c = 0; c < 3; ++c) {
        rgb_rec709[c] =
            srgb_decode(static_cast<double>(image.at(x, 0, static_cast<std::size_t>(c))));
      }
      return rgb_rec709 / std::max({rgb_rec709.x, rgb_rec709.y, rgb_rec709.z});
    };
    for (int c = 0; c < 3; ++c) {
      EXPECT_NEAR(linear(a)[c], linear(b)[c], 1e-3) << x;  // OCIO's fast logarithms and powers
    }
  }
}

TEST_F(SpectralHue, leaves_greys_where_aces_puts_them) {
  std::vector<Vec3d> greys;
  for (double ev = -3.0; ev <= 6.0; ev += 1.0) greys.emplace_back(0.18 * std::exp2(ev));
  const Image ours = shown(greys, "ACEScg", "sRGB - Display", kSdr);
  const Image aces = shown(greys, "ACEScg", "sRGB - Display", "ACES 1.0 - SDR Video");
  EXPECT_EQ(codes_of(ours)[3], (Code{91, 91, 91}));
  for (int x = 0; x < ours.width; ++x) {
    for (std::size_t c = 0; c < 3; ++c) {
      EXPECT_NEAR(ours.at(x, 0, c), ours.at(x, 0, 0), 2e-4f);  // OCIO's fast logarithms and powers
      // The stated fit of the curve.
      EXPECT_NEAR(ours.at(x, 0, c), aces.at(x, 0, c), 0.02f);
    }
  }
}

TEST_F(SpectralHue, hdr_middle_grey_is_15_cd_per_m2) {
  const Image hdr = shown({Vec3d(0.18)}, "ACEScg", "Rec.2100-PQ - Display", kHdr);
  // ST 2084 of 15 cd/m²: 0.332624.
  for (std::size_t c = 0; c < 3; ++c) EXPECT_NEAR(hdr.at(0, 0, c), 0.3326f, 5e-4f);  // fast powers
}

TEST_F(SpectralHue, keeps_moderate_colours_as_bright_and_nearly_as_saturated) {
  // Within the thresholds of the compression hexcone hue and saturation stay.
  const Vec3d rgb_rec709(0.5, 0.3, 0.2);
  const Image image = shown({rgb_rec709}, "Linear Rec.709 (sRGB)", "sRGB - Display", kSdr);
  Vec3d out(0.0);
  for (int c = 0; c < 3; ++c) {
    out[c] = srgb_decode(static_cast<double>(image.at(0, 0, static_cast<std::size_t>(c))));
  }
  EXPECT_NEAR(out.y / out.x, 0.6, 1e-3);  // OCIO's fast logarithms and powers
  EXPECT_NEAR(out.z / out.x, 0.4, 1e-3);
}

TEST_F(SpectralHue, black_and_blinding_light_stay_within_the_screen) {
  const std::vector<Vec3d> extremes{Vec3d(0.0),       Vec3d(-1.0),      Vec3d(1e8),
                                    {1e8, 0.0, 0.0},  {0.0, -1e6, 1e6}, {-5.0, 1e-9, 0.0},
                                    {1e-30, 0.0, 0.0}};
  for (const auto& [display, view] :
       {std::pair{"sRGB - Display", kSdr}, std::pair{"Rec.2100-PQ - Display", kHdr}}) {
    const Image image = shown(extremes, "Linear Rec.709 (sRGB)", display, view);
    for (const float value : image.pixels) {
      EXPECT_GE(value, -1e-3f);  // matrices of floats
      EXPECT_LE(value, 1.0f + 1e-3f);
    }
  }
}

}  // namespace
}  // namespace abbe
