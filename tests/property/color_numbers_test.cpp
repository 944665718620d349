// What the numbers of an image mean: white is white, and bands add up to the colour beside them.
#include <gtest/gtest.h>

#include <cmath>

#include "abbe/base/constants.h"
#include "abbe/color/color.h"
#include "abbe/color/uplift/uplift.h"
#include "abbe/display/display.h"
#include "abbe/image/exr/exr.h"
#include "abbe/load/gltf.h"
#include "support/scene_builder.h"

namespace abbe {
namespace {

// A floor of some reflectance, evenly lit from above so that white has a luminance of 1 cd/m².
Scene lit_floor(const Vec3f& base_color_rec709, const char* lamp) {
  Scene scene;
  test::add_square(scene, test::add(scene, test::matte(base_color_rec709)), 20.0,
                   test::rotation({1, 0, 0}, -90.0));
  scene.cameras.push_back(test::orthographic_camera({0, 30, 0}, {0, 0, 0}, 1.0, 1.0));
  scene.lights.push_back(test::directional_light({0, -1, 0}, kPi));
  if (lamp != nullptr) {
    scene.lights.back().spectrum = NamedSpectrum{lamp, test::catalogue().illuminant(lamp)};
  }
  return scene;
}

// 16 samples of 16 wavelengths, as the renderer does by default.
RenderSettings default_settings() {
  RenderSettings settings = test::small_settings();
  settings.size = {4, 4};
  settings.samples_per_pixel = 16;
  return settings;
}

Image rendered(const Scene& scene, const RenderSettings& settings,
               const DevelopmentOptions& development = {}) {
  Notes notes;
  const LitWorld world = make_lit_world(
      scene,
      {.mode = settings.mode, .wavelengths = settings.wavelengths, .development = development}, {},
      test::catalogue().observer(), test::catalogue().illuminant("illuminant/D65"), notes);
  return test::render(world, scene.cameras.front(), settings).image;
}

void expect_color(const Image& image, const Vec3f& expected, float tolerance) {
  for (int y = 0; y < image.height; ++y) {
    for (int x = 0; x < image.width; ++x) {
      for (std::size_t c = 0; c < 3; ++c) {
        EXPECT_NEAR(image.at(x, y, c), expected[static_cast<int>(c)], tolerance);
      }
    }
  }
}

TEST(ColorNumbers, d65_lit_white_is_1_1_1_in_rec709_and_acescg) {
  Image image = rendered(lit_floor(Vec3f(1.0f), nullptr), default_settings());
  expect_color(image, Vec3f(1.0f), 1e-4f);  // The promise.
  DisplayOptions options;
  options.config = std::filesystem::path(ABBE_SOURCE_DIR) / "config/config.ocio";
  convert_space(image, "Linear Rec.709 (sRGB)", "ACEScg", options);
  expect_color(image, Vec3f(1.0f), 1e-4f);  // The promise.
}

TEST(ColorNumbers, a_lit_white_adapts_to_neutral) {
  const DevelopmentOptions to_a{
      {},
      White{"illuminant/A", {{test::catalogue().illuminant("illuminant/A"), 1.0}}, {}},
      Adaptation::Cat16};
  const Scene scene = lit_floor(Vec3f(1.0f), "illuminant/A");
  expect_color(rendered(scene, default_settings(), to_a), Vec3f(1.0f), 0.002f);  // The promise.
  // Without it the same floor is orange.
  const Image plain = rendered(scene, default_settings());
  EXPECT_GT(plain.at(0, 0, 0), 2.0f * plain.at(0, 0, 2));
}

TEST(ColorNumbers, white_of_the_1964_observer_is_white) {
  const DevelopmentOptions options{
      test::catalogue().observer("observer/cie1964-10deg"), {}, Adaptation::Cat16};
  expect_color(rendered(lit_floor(Vec3f(1.0f), nullptr), default_settings(), options), Vec3f(1.0f),
               1e-4f);  // As for the 1931 observer.
}

// XYZ of a pixel from its colour, and from its bands: 683.002 · step · Σ band × observer(centre).
struct TwoWays {
  Vec3d from_rgb{0.0}, from_bands{0.0};
};

TwoWays xyz_two_ways(const Image& image, int x, int y, const BandOptions& bands) {
  const Observer observer = test::catalogue().observer();
  static const Development development =
      development_for(observer, test::catalogue().illuminant("illuminant/D65"));
  TwoWays result;
  result.from_rgb =
      development.rec709_to_xyz * Vec3d(image.at(x, y, 0), image.at(x, y, 1), image.at(x, y, 2));
  for (int band = 0; band < bands.count(); ++band) {
    const double nm = bands.center_nm(band);
    const double radiance = image.at(x, y, 3 + static_cast<std::size_t>(band));
    result.from_bands +=
        kLuminousEfficacy_lm_per_W * bands.step_nm * radiance *
        Vec3d(observer.x_bar.value(nm), observer.y_bar.value(nm), observer.z_bar.value(nm));
  }
  return result;
}

TEST(ColorNumbers, bands_add_up_to_the_colour_of_every_pixel_without_dispersion) {
  RenderSettings settings = default_settings();
  settings.bands = parse_bands("360:830:5");
  // The sum itself, of exact means, errs by 1e-3 for blue of 0.1, 0.2, 0.9: z̄ bends within 5 nm.
  for (const char* lamp : {"illuminant/D65", "illuminant/A", "illuminant/D50", "illuminant/E"}) {
    for (const Vec3f& color : {Vec3f(1.0f), Vec3f(0.8f, 0.2f, 0.1f), Vec3f(0.1f, 0.7f, 0.2f),
                               Vec3f(0.2f, 0.3f, 0.8f), Vec3f(0.9f, 0.8f, 0.05f)}) {
      const Image image = rendered(lit_floor(color, lamp), settings);
      const TwoWays xyz = xyz_two_ways(image, 1, 2, *settings.bands);
      for (int c = 0; c < 3; ++c) {
        EXPECT_NEAR(xyz.from_bands[c], xyz.from_rgb[c], 1e-3 * xyz.from_rgb.y)  // The promise.
            << lamp << " on " << color.x << ", " << color.y << ", " << color.z << ": " << c;
      }
    }
  }
}

TEST(ColorNumbers, bands_are_the_means_of_the_light_over_them) {
  RenderSettings settings = default_settings();
  settings.bands = parse_bands("380:780:10");
  const Vec3f color(0.1f, 0.6f, 0.3f);
  const Spectrum reflectance = Spectrum::sigmoid(uplift_rec709(Vec3d(color)));
  const Observer observer = test::catalogue().observer();
  for (const char* id : {"illuminant/D65", "illuminant/A"}) {
    const Image image = rendered(lit_floor(color, id), settings);
    Spectrum lamp = test::catalogue().illuminant(id);
    lamp = lamp.scaled(1.0 / xyz_of(lamp, observer).y);
    double largest = 0.0;
    std::vector<double> means;
    for (int band = 0; band < settings.bands->count(); ++band) {
      const double low_nm = settings.bands->low_nm(band);
      const Spectrum box = Spectrum::tabulated({low_nm, low_nm + settings.bands->step_nm},
                                               {1.0, 1.0}, OutsideTable::Zero);
      means.push_back(integral(product(reflectance, lamp), box) / settings.bands->step_nm);
      largest = std::max(largest, means.back());
    }
    for (int band = 0; band < settings.bands->count(); ++band) {
      // 256 wavelengths stand for the light, up to 8 nm apart at the dark ends of the spectrum.
      EXPECT_NEAR(image.at(2, 1, 3 + static_cast<std::size_t>(band)),
                  means[static_cast<std::size_t>(band)], 3e-3 * largest)
          << id << " " << band;
    }
  }
}

TEST(ColorNumbers, bands_without_a_wavelength_of_their_own_follow_their_neighbours) {
  RenderSettings settings = default_settings();
  settings.samples_per_pixel = 1;
  settings.bands = parse_bands("440:700:2");
  const Image image = rendered(lit_floor(Vec3f(1.0f), "illuminant/A"), settings);
  const Observer observer = test::catalogue().observer();
  Spectrum lamp = test::catalogue().illuminant("illuminant/A");
  lamp = lamp.scaled(1.0 / xyz_of(lamp, observer).y);
  for (int band = 0; band < settings.bands->count(); ++band) {
    const double nm = settings.bands->center_nm(band);
    // 16 wavelengths for 130 bands: a chord over 20 nm of a curve that grows by 2.5 % a nm in the
    // violet errs by up to 20²/8 · 0.025² = 3 %.
    EXPECT_NEAR(image.at(1, 1, 3 + static_cast<std::size_t>(band)) / lamp.value(nm), 1.0, 0.03)
        << nm;
  }
}

TEST(ColorNumbers, bands_add_up_to_the_mean_colour_of_the_prism) {
  Notes notes;
  const Scene scene = load_gltf(std::filesystem::path(ABBE_SOURCE_DIR) / "scenes/prism/prism.gltf",
                                test::catalogue(), {}, notes);
  RenderSettings settings = default_settings();
  settings.size = {96, 54};
  settings.bands = parse_bands("360:830:5");
  const Image image = rendered(scene, settings);
  TwoWays sum;
  for (int y = 0; y < image.height; ++y) {
    for (int x = 0; x < image.width; ++x) {
      const TwoWays xyz = xyz_two_ways(image, x, y, *settings.bands);
      sum.from_rgb += xyz.from_rgb;
      sum.from_bands += xyz.from_bands;
    }
  }
  for (int c = 0; c < 3; ++c) {
    EXPECT_NEAR(sum.from_bands[c] / sum.from_rgb.y, sum.from_rgb[c] / sum.from_rgb.y,
                1e-2);  // The promise.
  }
}

}  // namespace
}  // namespace abbe
