// Newton's spectrum against the closed form: where the lines lie on the screen, and how much light.

#include <gtest/gtest.h>

#include <cmath>
#include <optional>

#include "base/constants.h"
#include "image/exr.h"
#include "optics/dispersion.h"
#include "optics/fresnel.h"
#include "optics/snell.h"
#include "support/scene_builder.h"

namespace abbe {
namespace {

constexpr double kBeamWidth_m = 0.002;
constexpr double kBeamHeight_m = 0.016;
constexpr double kDistance_m = 0.5;

/// A beam, a 60° prism with the d line at minimum deviation, and a matte screen that the d line
/// meets at right angles; the camera sees the screen from its front, one pixel a known width.
struct Newton {
  Scene scene;
  Dispersion index;
  Vec3d beam_direction{1.0, 0.0, 0.0};
  Vec3d normal_in, normal_out;  ///< Of the faces, outwards.
  Vec3d entry{0.0};             ///< Where the middle of the beam enters.
  double inradius_m = 0.0;
  Vec3d screen_center{0.0}, screen_normal{0.0}, screen_x{0.0};
  Vec2i size{512, 32};
  double pixel_m = 0.0005;
};

Newton newton(const char* glass_id) {
  Newton n;
  const Material glass = test::glass(glass_id);
  n.index = glass.index;
  const double inside = std::asin(refractive_index(n.index, kLine_d_nm) * 0.5);
  // Half the deviation, 2·(incidence − 30°)/2, turns the beam to the way inside.
  const double half = inside - glm::radians(30.0);
  const Vec3d way(std::cos(half), 0.0, -std::sin(half));
  const Vec3d apex(std::sin(half), 0.0, std::cos(half));
  const double c30 = std::cos(glm::radians(30.0));
  n.normal_in = -c30 * way + 0.5 * apex;
  n.normal_out = c30 * way + 0.5 * apex;
  n.inradius_m = 0.06 / (2.0 * std::sqrt(3.0));
  ConvexShape prism;
  for (const Vec3d& normal : {n.normal_in, n.normal_out, -apex}) {
    prism.planes.push_back(Vec4d(normal, n.inradius_m));
  }
  prism.planes.push_back(Vec4d(0, 1, 0, 0.05));
  prism.planes.push_back(Vec4d(0, -1, 0, 0.05));
  test::add_shape(n.scene, {.name = "prism", .geometry = prism}, test::add(n.scene, glass),
                  Mat4d(1.0));
  n.entry = -way * (n.inradius_m / c30);
  const Vec3d out(std::cos(2.0 * half), 0.0, -std::sin(2.0 * half));
  n.screen_normal = -out;
  n.screen_x = glm::cross(Vec3d(0, 1, 0), n.screen_normal);
  n.screen_center = -n.entry + kDistance_m * out;
  const Mat4d place(Vec4d(n.screen_x, 0), Vec4d(0, 1, 0, 0), Vec4d(n.screen_normal, 0),
                    Vec4d(n.screen_center, 1));
  test::add_square(n.scene, test::add(n.scene, test::matte(Vec3f(1.0f))), 0.3, place);
  Light beam = test::directional_light(n.beam_direction, 1000.0);
  beam.beam = BeamSize{kBeamWidth_m, kBeamHeight_m};
  beam.to_world[3] = Vec4d(n.entry - 0.4 * n.beam_direction, 1.0);
  n.scene.lights.push_back(beam);
  // Just in front of the screen, so that the prism does not stand before it.
  n.scene.cameras.push_back(test::orthographic_camera(n.screen_center + 0.2 * n.screen_normal,
                                                      n.screen_center, 0.5 * n.size.x * n.pixel_m,
                                                      0.5 * n.size.y * n.pixel_m));
  return n;
}

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

class NewtonSpectrum : public testing::TestWithParam<const char*> {};

TEST_P(NewtonSpectrum, lines_lie_where_snell_puts_them_with_the_light_that_fresnel_leaves) {
  const Newton n = newton(GetParam());
  RenderSettings settings;
  settings.size = n.size;
  settings.samples_per_pixel = 16;
  settings.filter = "box";
  settings.wavelengths.exact_nm = {kLineF_nm, kLine_d_nm, kLineC_nm};
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
  RenderSettings settings;
  settings.size = n.size;
  settings.samples_per_pixel = 16;
  settings.filter = "box";
  settings.wavelengths.exact_nm = {kLine_d_nm};
  const World world = test::make_world(n.scene, settings);
  const Image first = render(world, n.scene.cameras.front(), settings).image;
  settings.seed = 5;
  const Image second = render(world, n.scene.cameras.front(), settings).image;
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

}  // namespace
}  // namespace abbe
