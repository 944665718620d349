// The scenes about measured light against their closed forms: chart, metamers, soap, metals,
// diamond.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "abbe/base/constants.h"
#include "abbe/color/color.h"
#include "abbe/image/exr/exr.h"
#include "abbe/load/gltf.h"
#include "abbe/optics/fresnel.h"
#include "abbe/scene/lamps.h"
#include "support/airy.h"
#include "support/gems.h"
#include "support/scene_builder.h"

namespace abbe {
namespace {

Scene load(const std::string& name) {
  Notes notes;
  return load_gltf(std::filesystem::path(ABBE_SOURCE_DIR) / "scenes" / name / (name + ".gltf"),
                   test::catalogue(), {}, notes);
}

RenderSettings settings_of(int width, int height, int samples) {
  RenderSettings settings = test::small_settings();
  settings.size = {width, height};
  settings.samples_per_pixel = samples;
  return settings;
}

NamedSpectrum lamp(const std::string& id) {
  return {id, test::catalogue().illuminant(id)};
}

Vec3d xyz_at(const Image& image, int x, int y) {
  // Linear Rec.709 to XYZ (IEC 61966-2-1 with unrounded primaries), column by column.
  const glm::dmat3 to_xyz{{0.4123907992659595, 0.21263900587151036, 0.01933081871559185},
                          {0.35758433938387796, 0.7151686787677559, 0.11919477979462599},
                          {0.1804807884018343, 0.07219231536073371, 0.9505321522496607}};
  return to_xyz * Vec3d(test::pixel(image, x, y, "R"), test::pixel(image, x, y, "G"),
                        test::pixel(image, x, y, "B"));
}

// "white 9.5 (.05 D)" as the chart's materials are named: "white-9-5".
std::string material_name(std::string patch) {
  patch = patch.substr(0, patch.find(" ("));
  for (char& c : patch) {
    if (c == ' ' || c == '.') c = '-';
  }
  return patch;
}

TEST(ChartScene, patches_under_d50_have_the_colours_their_maker_publishes) {
  const auto published = nlohmann::json::parse(
      std::ifstream(ABBE_SOURCE_DIR "/tests/reference/chart/colorchecker_lab_d50.json"))["lab"];
  ASSERT_EQ(published.size(), 24u);
  Scene scene = load("chart");
  replace_lamps(scene, lamp("illuminant/D50"));
  RenderSettings settings = settings_of(75, 55, 16);
  const Image image = test::render(scene, settings).image;
  const Vec3d white = xyz_at(image, 1, 1);
  double sum = 0.0;
  double worst = 0.0;
  for (const auto& [name, lab] : published.items()) {
    std::size_t i = 0;
    while (i < 24 && scene.materials.at(i).name != material_name(name)) ++i;
    ASSERT_LT(i, 24u) << name;
    const int x = 12 + 10 * static_cast<int>(i % 6);
    const int y = 12 + 10 * static_cast<int>(i / 6);
    const double difference =
        delta_e2000(lab_of_xyz(xyz_at(image, x, y), white),
                    {lab[0].get<double>(), lab[1].get<double>(), lab[2].get<double>()});
    sum += difference;
    worst = std::max(worst, difference);
  }
  RecordProperty("mean", std::to_string(sum / 24.0));
  RecordProperty("worst", std::to_string(worst));
  // What thirty real charts differ from the published colours (BabelColor), and a little noise.
  EXPECT_LT(sum / 24.0, 0.6);
  EXPECT_LT(worst, 1.3);
}

double metamer_difference(Mode mode, const std::string& id) {
  Scene scene = load("metamers");
  replace_lamps(scene, lamp(id));
  RenderSettings settings = settings_of(32, 24, 16);
  settings.mode = mode;
  const Image image = test::render(scene, settings).image;
  const Vec3d white = xyz_at(image, 1, 12);
  return delta_e2000(lab_of_xyz(xyz_at(image, 11, 12), white),
                     lab_of_xyz(xyz_at(image, 21, 12), white));
}

TEST(MetamersScene, patches_are_alike_under_d65_and_unlike_under_a_and_fl11) {
  // The bounds that the scene is made for.
  EXPECT_LT(metamer_difference(Mode::Spectral, "illuminant/D65"), 0.5);
  EXPECT_GT(metamer_difference(Mode::Spectral, "illuminant/A"), 5.0);
  EXPECT_GT(metamer_difference(Mode::Spectral, "illuminant/FL11"), 5.0);
}

TEST(MetamersScene, patches_stay_alike_in_rgb_under_every_lamp) {
  for (const char* id : {"illuminant/D65", "illuminant/A", "illuminant/FL11"}) {
    EXPECT_LT(metamer_difference(Mode::Rgb, id), 0.5) << id;
  }
}

TEST(SoapScene, film_shows_the_airy_sum_of_its_thickness) {
  const Scene scene = load("soap");
  const double n = refractive_index(scene.materials.at(0).film->index, 550.0);
  const double tilt = 20.0 * kPi / 180.0;
  RenderSettings settings = settings_of(960, 540, 16);
  settings.wavelengths.exact_nm = {550.0};
  const Spectrum d65 = test::catalogue().illuminant("illuminant/D65");
  const double panel = 12.0 / xyz_of(d65, test::catalogue().observer()).y * d65.value(550.0);
  for (const int row : {130, 180, 240, 330, 420}) {
    settings.crop = PixelRect{360, row, 361, row + 1};
    const Image image = test::render(scene, settings).image;
    // The ray through the pixel's middle meets the film, which is tilted back about its middle.
    const double scale = std::tan(13.0 * kPi / 180.0) / 270.0;
    const Vec3d d = glm::normalize(Vec3d((360.5 - 480.0) * scale, (270.0 - row - 0.5) * scale, -1));
    const Vec3d up(0.0, std::cos(tilt), -std::sin(tilt)), out(0.0, std::sin(tilt), std::cos(tilt));
    const Vec3d eye(0.0, 0.0, 6.0);
    const Vec3d at = eye + -glm::dot(eye, out) / glm::dot(d, out) * d;
    const double down = 0.5 - glm::dot(at, up) / 2.0;  // 0 at the upper edge, 1 at the lower
    const double thickness_nm = 1200.0 * (256.0 * down - 0.5) / 255.0;  // between 256 texels
    const double expected = static_cast<double>(
        test::airy_reflectance(-glm::dot(d, out), 1.0L, n, 1.0L, thickness_nm, 550.0L));
    EXPECT_NEAR(static_cast<double>(
                    image.pixels[image.channel_index(spectral_channel_name(550.0)).value()]) /
                    panel,
                expected, 1e-3)  // the film is 5 nm thicker a row: a curve's mean over a pixel
        << "row " << row << ", " << thickness_nm << " nm";
  }
}

TEST(MetalsScene, middle_of_each_sphere_has_the_reflectance_at_normal_incidence) {
  const Scene scene = load("metals");
  RenderSettings settings = settings_of(128, 72, 4);
  settings.wavelengths.exact_nm = {450.0, 550.0, 650.0};
  const Image image = test::render(scene, settings).image;
  const Spectrum d65 = test::catalogue().illuminant("illuminant/D65");
  const double luminance = xyz_of(d65, test::catalogue().observer()).y;
  for (std::size_t i = 0; i < 15; ++i) {
    const Material& metal = scene.materials.at(i);
    const int x = static_cast<int>(std::lround(64.0 + (static_cast<double>(i % 5) - 2.0) * 22.0));
    const int y = static_cast<int>(std::lround(36.0 + (static_cast<double>(i / 5) - 1.0) * 22.0));
    for (const double nm : settings.wavelengths.exact_nm) {
      const double n = metal.conductor->n.value(nm), k = metal.conductor->k.value(nm);
      const double expected = metal.film
                                  ? static_cast<double>(test::airy_reflectance(
                                        1.0L, 1.0L, 2.4L, {n, k}, metal.film->thickness_max_nm, nm))
                                  : fresnel_conductor(1.0, n, k);
      const double found =
          static_cast<double>(test::pixel(image, x, y, spectral_channel_name(nm))) /
          (d65.value(nm) / luminance);
      EXPECT_NEAR(found, expected, 2e-3) << metal.name << " at " << nm << " nm";  // As asked.
    }
  }
}

TEST(DiamondScene, stone_is_tolkowskys_brilliant) {
  const Scene scene = load("diamond");
  const ConvexShape expected = test::brilliant();
  const auto& shape = std::get<Shape>(scene.instances.at(0).what);
  const auto& planes = std::get<ConvexShape>(shape.geometry).planes;
  ASSERT_EQ(planes.size(), 57u);
  for (std::size_t i = 0; i < planes.size(); ++i) {
    for (int c = 0; c < 4; ++c) {
      EXPECT_NEAR(planes[i][c], expected.planes[i][c], 1e-10);  // twelve digits in the file
    }
  }
  // Diamond in air, Born & Wolf 1.5: 17.204 % at normal incidence, total reflection from 24.434°.
  const double n_d = refractive_index(scene.materials.at(0).index, kLine_d_nm);
  EXPECT_NEAR(normal_reflectance(n_d), 0.172040, 5e-6);
  EXPECT_NEAR(critical_angle_rad(1.0 / n_d) * 180.0 / kPi, 24.434, 1e-3);
}

TEST(DiamondScene, stone_has_fire_in_spectral_mode_and_none_in_rgb) {
  const Scene scene = load("diamond");
  const auto chroma = [&](Mode mode) {
    RenderSettings settings = settings_of(48, 27, 4);
    settings.mode = mode;
    const Image image = test::render(scene, settings).image;
    double sum = 0.0;
    for (int y = 0; y < 27; ++y) {
      for (int x = 0; x < 48; ++x) {
        const Vec3d lab = lab_of_xyz(xyz_at(image, x, y), Vec3d(0.9505, 1.0, 1.089));
        sum += std::hypot(lab.y, lab.z) / (48 * 27);
      }
    }
    return sum;
  };
  // The lamps of 4500 K give rgb some warmth, the same for the whole stone; fire is many times it.
  EXPECT_GT(chroma(Mode::Spectral), 2.0 * chroma(Mode::Rgb));
}

}  // namespace
}  // namespace abbe
