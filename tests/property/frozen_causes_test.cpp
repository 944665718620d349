// Between the mode rgb and the spectral one: both ends of --freeze, and what lies between.

#include <gtest/gtest.h>

#include <cmath>

#include "abbe/base/error.h"
#include "abbe/color/color.h"
#include "abbe/image/exr/exr.h"
#include "abbe/image/metrics/metrics.h"
#include "abbe/load/gltf.h"
#include "support/scene_builder.h"

namespace abbe {
namespace {

Scene scene_named(const std::string& name) {
  Notes notes;
  return load_gltf(std::filesystem::path(ABBE_SOURCE_DIR) / "scenes" / name / (name + ".gltf"),
                   test::catalogue(), {}, notes);
}

RenderSettings settings_of(Mode mode, const CauseSet& frozen = {}) {
  RenderSettings settings;
  settings.size = {64, 36};
  settings.samples_per_pixel = 4;
  settings.cutoff = 1e-4;  // What is followed by chance differs with the weights of the modes.
  settings.mode = mode;
  settings.frozen = frozen;
  return settings;
}

MapStatistics difference(const Scene& scene, const RenderSettings& a, const RenderSettings& b) {
  return map_statistics(
      delta_e2000_map(test::render(scene, a).image, test::render(scene, b).image));
}

class FrozenScenes : public testing::TestWithParam<const char*> {};

TEST_P(FrozenScenes, all_causes_frozen_are_the_mode_rgb) {
  const MapStatistics statistics =
      difference(scene_named(GetParam()), settings_of(Mode::Spectral, CauseSet::all()),
                 settings_of(Mode::Rgb));
  // Rounding of single precision, but for fans that fall below the cutoff: their one child is
  // chosen by weights that differ between three lanes and 48, which is noise.
  EXPECT_LT(statistics.mean, 0.001);
  EXPECT_LT(statistics.percentile_95, 0.001);
}

INSTANTIATE_TEST_SUITE_P(scenes, FrozenScenes,
                         testing::Values("prism", "metals", "metamers", "chart", "soap"),
                         [](const auto& test) { return std::string(test.param); });

TEST(FrozenCauses, frozen_dispersion_leaves_one_index) {
  Scene scene;
  test::add(scene, test::glass("glass/schott/N-SF11"));
  const LitWorld world =
      test::make_world(scene, settings_of(Mode::Spectral, parse_causes({"dispersion"})));
  EXPECT_EQ(world.lanes.lane_count(), 16);  // No channels are needed for it.
  for (int lane = 0; lane < 16; ++lane) {
    EXPECT_NEAR(world.row(world.materials.front().index, 3)[lane], 1.78472f, 1e-5f);  // n_d
  }
}

// A matte square of one colour under a lamp, seen straight on.
Vec3d seen(const Vec3f& color, const char* lamp, const CauseSet& frozen) {
  Scene scene;
  test::add_square(scene, test::add(scene, test::matte(color)), 5.0, Mat4d(1.0));
  Light light = test::directional_light({0, 0, -1}, 3.14159265358979);
  if (lamp != nullptr) light.spectrum = {lamp, test::catalogue().illuminant(lamp)};
  scene.lights.push_back(light);
  scene.cameras.push_back(test::orthographic_camera({0, 0, 3}, {0, 0, 0}, 1.0, 1.0));
  RenderSettings settings = test::small_settings();
  settings.samples_per_pixel = 16;
  settings.frozen = frozen;
  const Image image = test::render(scene, settings).image;
  return {test::pixel(image, 4, 4, "R"), test::pixel(image, 4, 4, "G"),
          test::pixel(image, 4, 4, "B")};
}

void expect_near(const Vec3d& value, const Vec3d& expected, double tolerance) {
  for (int i = 0; i < 3; ++i) EXPECT_NEAR(value[i], expected[i], tolerance) << "channel " << i;
}

TEST(FrozenCauses, frozen_lamp_and_colour_multiply_as_triples) {
  const Vec3f color(0.7f, 0.2f, 0.1f);
  const Vec3d lamp = seen(Vec3f(1.0f), "illuminant/A", {});
  const Vec3d both = seen(color, "illuminant/A", parse_causes({"lamps", "uplift"}));
  // Products of single precision numbers of at most 2.
  expect_near(both, lamp * Vec3d(color), 1e-5);
}

TEST(FrozenCauses, frozen_lamp_is_a_metamer_of_its_colour_over_live_reflectances) {
  // Under frozen light of 1, 1, 1 a live reflectance has the colour that it was uplifted from.
  const Vec3f color(0.7f, 0.2f, 0.1f);
  // The quadrature of 16 wavelengths times 16 samples, as without frozen causes.
  expect_near(seen(color, nullptr, parse_causes({"lamps"})), Vec3d(color), 5e-4);
}

TEST(FrozenCauses, live_lamp_over_frozen_colours_keeps_its_white) {
  const CauseSet uplift = parse_causes({"uplift"});
  // White reflects every wavelength, as a triple as well.
  expect_near(seen(Vec3f(1.0f), "illuminant/A", uplift), seen(Vec3f(1.0f), "illuminant/A", {}),
              1e-5);
  // In the light of D65 a triple has its own colour, whatever stands for it.
  const Vec3f color(0.7f, 0.2f, 0.1f);
  expect_near(seen(color, "illuminant/D65", uplift), Vec3d(color), 5e-4);  // Quadrature.
}

TEST(FrozenCauses, bands_of_a_frozen_render_make_its_colour) {
  const Scene scene = scene_named("metamers");
  RenderSettings settings = settings_of(Mode::Spectral, CauseSet::all());
  settings.bands = parse_bands("360:830:5");
  settings.samples_per_pixel = 16;
  const Image image = test::render(scene, settings).image;
  const Observer& observer = test::catalogue().observer();
  double luminance = 0.0;
  for (int band = 0; band < settings.bands->count(); ++band) {
    const double nm = settings.bands->center_nm(band);
    luminance += 683.002 * 5.0 * observer.y_bar.value(nm) *
                 static_cast<double>(test::pixel(image, 20, 18, spectral_channel_name(nm)));
  }
  const Vec3d rgb_rec709(test::pixel(image, 20, 18, "R"), test::pixel(image, 20, 18, "G"),
                         test::pixel(image, 20, 18, "B"));
  // A sum over 5 nm bands of a spectrum with flanks of 20 nm.
  EXPECT_NEAR(luminance / (rec709_to_xyz() * rgb_rec709).y, 1.0, 0.01);
}

TEST(FrozenCauses, rgb_mode_and_too_many_wavelengths_are_refused) {
  RenderSettings settings = settings_of(Mode::Rgb, CauseSet::all());
  EXPECT_THROW(check_settings(settings), Error);
  settings = settings_of(Mode::Spectral, CauseSet::all());
  settings.wavelengths.count = 43;  // Three lanes each are more than 128.
  EXPECT_THROW(test::make_world(scene_named("metamers"), settings), Error);
}

}  // namespace
}  // namespace abbe
