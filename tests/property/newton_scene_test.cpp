// Newton's spectrum against the closed form: where the lines lie on the screen, and how much light.

#include <gtest/gtest.h>

#include <cmath>
#include <optional>
#include <utility>
#include <vector>

#include "abbe/base/constants.h"
#include "abbe/image/exr/exr.h"
#include "abbe/load/gltf.h"
#include "abbe/optics/dispersion.h"
#include "abbe/optics/fresnel.h"
#include "abbe/optics/snell.h"
#include "support/image_difference.h"
#include "support/newton.h"
#include "support/scene_builder.h"

namespace abbe {
namespace {

using test::kBeamHeight_m;
using test::kBeamWidth_m;
using test::Newton;
using test::newton;

/// Where a wavelength meets the screen, metres along screen_x, and the power it keeps.
struct Landing {
  double x_m = 0.0;
  double share = 0.0;
};

Landing land(const Newton& n, double wavelength_nm) {
  const double index = refractive_index(n.index, wavelength_nm);
  const auto fresnel_at = [](const Vec3d& direction, const Vec3d& normal, double eta) {
    return fresnel_dielectric(std::abs(glm::dot(direction, normal)), eta).transmittance();
  };
  const Vec3d inside = *refracted_direction(n.beam_direction, n.normal_in, index);
  const double to_face =
      (n.inradius_m - glm::dot(n.normal_out, n.entry)) / glm::dot(n.normal_out, inside);
  const Vec3d exit = n.entry + to_face * inside;
  const Vec3d out = *refracted_direction(inside, n.normal_out, 1.0 / index);
  const double to_screen =
      glm::dot(n.screen_center - exit, n.screen_normal) / glm::dot(out, n.screen_normal);
  return {glm::dot(exit + to_screen * out - n.screen_center, n.screen_x),
          fresnel_at(n.beam_direction, n.normal_in, index) *
              fresnel_at(inside, n.normal_out, 1.0 / index)};
}

/// A picture of single lines, averaged over pixels.
RenderSettings settings_of_lines(const Newton& n, int samples, std::vector<double> lines_nm) {
  RenderSettings settings;
  settings.inner_reflections = 1;  // More throw faint light between the lines.
  settings.size = n.size;
  settings.samples_per_pixel = samples;
  settings.filter = "box";
  settings.wavelengths.exact_nm = std::move(lines_nm);
  return settings;
}

class NewtonSpectrum : public testing::TestWithParam<const char*> {};

TEST_P(NewtonSpectrum, lines_lie_where_snell_puts_them_with_the_light_that_fresnel_leaves) {
  const Newton n = newton(GetParam());
  const RenderSettings settings = settings_of_lines(n, 16, {kLineF_nm, kLine_d_nm, kLineC_nm});
  const Image image = test::render(n.scene, settings).image;

  // The lamp straight on a screen gives the radiance that stands for its full irradiance.
  Newton bare = n;
  bare.scene.instances.erase(bare.scene.instances.begin());
  bare.scene.lights.front().beam.reset();
  bare.scene.lights.front().to_world = test::directional_light(-n.screen_normal, 1000.0).to_world;
  const Image full = test::render(bare.scene, settings).image;

  for (const double line_nm : settings.wavelengths.exact_nm) {
    const std::string channel = spectral_channel_name(line_nm);
    const double lamp = static_cast<double>(test::pixel(full, 256, 16, channel));
    double sum = 0.0, moment = 0.0;
    for (int y = 0; y < image.height; ++y) {
      for (int x = 0; x < image.width; ++x) {
        const auto value = static_cast<double>(test::pixel(image, x, y, channel));
        sum += value;
        moment += value * (x + 0.5 - 0.5 * image.width) * n.pixel_m;
      }
    }
    const Landing landing = land(n, line_nm);
    // Half a pixel is asked for; edges of the beam are sampled 4 × 4 times a pixel.
    EXPECT_NEAR(moment / sum, landing.x_m, 0.1 * n.pixel_m) << line_nm;
    // Flux over the beam's own: the sum over pixels of E·area. The picture holds 16 mm of height,
    // as much as the beam has. Sampling of the edges: below 1 %.
    const double share = sum * n.pixel_m * n.pixel_m / lamp / (kBeamWidth_m * kBeamHeight_m);
    EXPECT_NEAR(share, landing.share, 0.01 * landing.share) << line_nm;
  }
}

INSTANTIATE_TEST_SUITE_P(glasses, NewtonSpectrum,
                         testing::Values("glass/schott/N-BK7", "glass/schott/N-SF11"),
                         [](const auto& test) {
                           std::string name = test.param;
                           name = name.substr(name.rfind('/') + 1);
                           std::erase(name, '-');
                           return name;
                         });

TEST(NewtonScene, no_pixel_exceeds_the_exact_maximum_and_two_seeds_agree) {
  const Newton n = newton("glass/schott/N-SF11");
  RenderSettings settings = settings_of_lines(n, 16, {kLine_d_nm});
  const LitWorld world = test::make_world(n.scene, settings);
  const Image first = test::render(world, n.scene.cameras.front(), settings).image;
  settings.seed = 5;
  const Image second = test::render(world, n.scene.cameras.front(), settings).image;
  const std::string channel = spectral_channel_name(kLine_d_nm);
  Newton bare = n;
  bare.scene.instances.erase(bare.scene.instances.begin());
  bare.scene.lights.front().beam.reset();
  bare.scene.lights.front().to_world = test::directional_light(-n.screen_normal, 1000.0).to_world;
  const float lamp = test::pixel(test::render(bare.scene, settings).image, 256, 16, channel);
  // At minimum deviation both faces change the cross section by factors that cancel.
  const double most = static_cast<double>(lamp) * land(n, kLine_d_nm).share;
  float highest = 0.0f;
  int inside = 0;
  for (int y = 0; y < n.size.y; ++y) {
    for (int x = 0; x < n.size.x; ++x) {
      const float a = test::pixel(first, x, y, channel);
      const float b = test::pixel(second, x, y, channel);
      highest = std::max(highest, a);
      // Pixels whose neighbours are lit too are wholly inside the line: no chance enters them.
      const auto is_lit = [&](int dx, int dy) {
        return x + dx >= 0 && x + dx < n.size.x && y + dy >= 0 && y + dy < n.size.y &&
               test::pixel(first, x + dx, y + dy, channel) > 0.999f * static_cast<float>(most);
      };
      if (is_lit(0, 0) && is_lit(-1, 0) && is_lit(1, 0) && is_lit(0, -1) && is_lit(0, 1)) {
        EXPECT_NEAR(a, b, 1e-5f * a);  // Roundings of other places on the screen.
        ++inside;
      }
    }
  }
  EXPECT_GT(inside, 20);
  EXPECT_LE(static_cast<double>(highest), 1.02 * most);
  EXPECT_GE(static_cast<double>(highest), 0.98 * most);
}

TEST(NewtonScene, one_sample_a_pixel_finds_the_share_of_it_that_is_lit) {
  const Newton n = newton("glass/schott/N-SF11");
  const RenderSettings settings = settings_of_lines(n, 1, {kLine_d_nm});
  const Image image = test::render(n.scene, settings).image;
  const std::string channel = spectral_channel_name(kLine_d_nm);
  const double middle_px = 0.5 * n.size.x + land(n, kLine_d_nm).x_m / n.pixel_m;
  // At minimum deviation the beam leaves as wide as it came, and the screen stands square to it.
  const double half_px = 0.5 * kBeamWidth_m / n.pixel_m;
  const int row = n.size.y / 2;
  const float full = test::pixel(image, static_cast<int>(middle_px), row, channel);
  for (int x = 0; x < n.size.x; ++x) {
    const double lit = std::max(
        0.0, std::min(x + 1.0, middle_px + half_px) - std::max<double>(x, middle_px - half_px));
    // Heights of single precision at half a metre: 1e-7 m of a pixel's 5e-4.
    EXPECT_NEAR(test::pixel(image, x, row, channel) / full, lit, 1e-3) << x;
  }
}

// Only antialiasing of what stands there and the wavelengths are left to chance. Each seed has its
// own, evenly 0.46 nm apart: 0.82. Uneven ones differ by 1.2.
TEST(NewtonScene, spectra_of_two_seeds_look_the_same_at_64_samples) {
  const Newton n = newton("glass/schott/N-SF11");
  RenderSettings settings;
  settings.size = n.size;
  settings.samples_per_pixel = 64;
  const Image first = test::render(n.scene, settings).image;
  settings.seed = 5;
  EXPECT_LT(test::mean_delta_e2000(first, test::render(n.scene, settings).image), 1.0);
}

TEST(NewtonScene, screen_of_the_picture_has_no_noise_that_is_seen_even_through_fog) {
  Notes notes;
  const Scene scene =
      load_gltf(std::filesystem::path(ABBE_SOURCE_DIR) / "scenes/newton/newton.gltf",
                test::catalogue(), {}, notes);
  RenderSettings settings;
  settings.size = {240, 135};
  settings.samples_per_pixel = 64;
  settings.crop = PixelRect{94, 6, 166, 50};  // The screen without its edges.
  const Image first = test::render(scene, settings).image;
  settings.seed = 5;
  EXPECT_LT(test::mean_delta_e2000(first, test::render(scene, settings).image), 0.05);
}

}  // namespace
}  // namespace abbe
