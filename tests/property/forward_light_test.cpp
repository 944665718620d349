// Exact light of point lamps against brute force: rays followed forwards from the lamp, which know
// nothing of chains (support/forward_light.h). The figures of 10⁸ rays per wavelength were made
// once, by abbe_forward_reference of tests/bench; a run of 10⁶ rays here checks that they still
// belong to the scenes.

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

#include "abbe/base/constants.h"
#include "abbe/image/exr/exr.h"
#include "support/caustic_scenes.h"
#include "support/newton.h"
#include "support/scene_builder.h"

namespace abbe {
namespace {

using test::CausticScene;

// What 1 lx of a lamp's light at right angles makes of a matte white surface's radiance.
double radiance_per_lux(double wavelength_nm) {
  Scene scene;
  test::add_square(scene, test::add(scene, test::matte(Vec3f(1.0f))), 1.0,
                   test::rotation({1, 0, 0}, -90.0));
  scene.lights.push_back(test::point_light({0, 1, 0}, 1.0));
  scene.cameras.push_back(test::orthographic_camera({0, 0.5, 0}, {0, 0, 0}, 1e-5, 1e-5));
  RenderSettings settings = test::small_settings();
  settings.inner_reflections = 1;  // As the reference follows it.
  settings.wavelengths.exact_nm = {wavelength_nm};
  return static_cast<double>(
      test::pixel(test::render(scene, settings).image, 4, 4, spectral_channel_name(wavelength_nm)));
}

// Irradiances of all pixels, row by row, for a lamp of 1 cd.
std::vector<double> irradiances(const Image& image, double wavelength_nm) {
  const double scale = radiance_per_lux(wavelength_nm);
  std::vector<double> result;
  for (int y = 0; y < image.height; ++y) {
    for (int x = 0; x < image.width; ++x) {
      const float value = test::pixel(image, x, y, spectral_channel_name(wavelength_nm));
      result.push_back(static_cast<double>(value) / scale);
    }
  }
  return result;
}

struct FloorCase {
  CausticScene (*make)();
  double on_glass_sr, on_floor_sr;
  std::array<double, 64> irradiance;
};

const FloorCase kCube = {
    test::cube_over_floor,
    0.220244,
    0.368513,
    {0.067140, 0.044363, 0.017456, 0.036419, 0.054990, 0.031945, 0.084851, 0.081990,
     0.007391, 0.047651, 0.149418, 0.147445, 0.198705, 0.038672, 0.090683, 0.088822,
     0.003132, 0.134897, 0.220695, 0.171061, 0.175306, 0.075083, 0.073324, 0.094884,
     0.018399, 0.057596, 0.162567, 0.233245, 0.239268, 0.165617, 0.044824, 0.099681,
     0.059689, 0.021644, 0.175958, 0.232141, 0.113272, 0.101064, 0.016227, 0.102698,
     0.090022, 0.013048, 0.050175, 0.054924, 0.007070, 0.040898, 0.079457, 0.103761,
     0.090433, 0.056862, 0.028683, 0.068905, 0.105025, 0.109715, 0.107480, 0.103267,
     0.088203, 0.094883, 0.100469, 0.104499, 0.106621, 0.106626, 0.104501, 0.100469}};

const FloorCase kWedge = {
    test::wedge_over_floor,
    0.344598,
    0.402734,
    {0.088259, 0.049154, 0.019264, 0.027520, 0.034659, 0.040163, 0.043829, 0.045681,
     0.137798, 0.150503, 0.093725, 0.092522, 0.088990, 0.083808, 0.077525, 0.070632,
     0.148101, 0.168396, 0.100359, 0.098700, 0.094648, 0.088855, 0.081944, 0.074414,
     0.175823, 0.225334, 0.150641, 0.140189, 0.126696, 0.111666, 0.096311, 0.081510,
     0.146853, 0.178201, 0.107088, 0.104981, 0.100362, 0.093963, 0.086390, 0.078212,
     0.159645, 0.205110, 0.130815, 0.124281, 0.114940, 0.103954, 0.092246, 0.080552,
     0.118448, 0.109740, 0.068515, 0.071901, 0.073347, 0.072928, 0.070832, 0.067404,
     0.097868, 0.101328, 0.102944, 0.102533, 0.100155, 0.096027, 0.090517, 0.084039}};

const FloorCase kGem = {
    test::gem_over_floor,
    0.199864,
    0.325719,
    {0.019611, 0.015106, 0.008792, 0.010732, 0.022526, 0.027981, 0.028248, 0.027850,
     0.012060, 0.000012, 0.000000, 0.000000, 0.000915, 0.025193, 0.031638, 0.031159,
     0.001778, 0.000000, 0.000000, 0.000000, 0.001069, 0.011816, 0.034790, 0.034229,
     0.000366, 0.000000, 0.000000, 0.026292, 0.017493, 0.010836, 0.037407, 0.036775,
     0.006565, 0.000000, 0.000660, 0.015802, 0.010443, 0.020689, 0.039187, 0.038502,
     0.022371, 0.006060, 0.000295, 0.001052, 0.014252, 0.038592, 0.039881, 0.039188,
     0.025309, 0.028637, 0.028327, 0.032680, 0.037407, 0.038953, 0.039420, 0.038726,
     0.024549, 0.027720, 0.030846, 0.033684, 0.035958, 0.037407, 0.037840, 0.037197}};

class ForwardFloor : public testing::TestWithParam<const FloorCase*> {};

TEST_P(ForwardFloor, irradiance_of_every_patch_is_that_of_rays_sent_forwards) {
  const FloorCase& expected = *GetParam();
  const CausticScene scene = expected.make();
  RenderSettings settings = test::small_settings();
  settings.inner_reflections = 1;  // As the reference follows it.
  settings.samples_per_pixel = 1024;
  settings.wavelengths.exact_nm = {kLine_d_nm};
  const std::vector<double> measured =
      irradiances(test::render(scene.scene, settings).image, kLine_d_nm);
  const double most = *std::max_element(expected.irradiance.begin(), expected.irradiance.end());
  double flux_sr = 0.0;
  const double pixel_m = scene.screen().pixel_m;
  for (std::size_t i = 0; i < measured.size(); ++i) {
    flux_sr += measured[i] * pixel_m * pixel_m;
    // Edges of light cross the patches, and 1024 samples see them to about a percent.
    EXPECT_NEAR(measured[i], expected.irradiance[i], 0.01 * most) << i % 8 << ", " << i / 8;
  }
  // All patches together: the errors of edges cancel.
  EXPECT_NEAR(flux_sr, expected.on_floor_sr, 0.003 * expected.on_floor_sr);
}

TEST_P(ForwardFloor, reference_belongs_to_the_scene_and_loses_light_but_makes_none) {
  const FloorCase& expected = *GetParam();
  const CausticScene scene = expected.make();
  const auto light = test::follow_forward(scene.scene, scene.lamp, {0, -1, 0}, scene.half_angle_rad,
                                          kLine_d_nm, 1, 1000000, scene.screen());
  // A million rays of a low-discrepancy sequence.
  EXPECT_NEAR(light.on_glass_sr, expected.on_glass_sr, 1e-3 * expected.on_glass_sr);
  EXPECT_NEAR(light.on_screen_sr, expected.on_floor_sr, 2e-3 * expected.on_floor_sr);
  EXPECT_LT(expected.on_floor_sr, light.aimed_sr);
}

TEST_P(ForwardFloor, light_that_glass_throws_is_never_more_than_fell_on_it) {
  // On a wide floor, without the straight light around the glass: all that leaves downwards.
  CausticScene scene = GetParam()->make();
  RenderSettings settings = test::small_settings();
  settings.inner_reflections = 1;  // As the reference follows it.
  settings.size = {32, 32};
  settings.samples_per_pixel = 4;
  settings.wavelengths.exact_nm = {kLine_d_nm};
  scene.scene.cameras = {test::orthographic_camera({0, 0.02, 0}, {0, 0, 0}, 8.0, 8.0)};
  const auto flux = [&](const Scene& of) {
    const std::vector<double> e = irradiances(test::render(of, settings).image, kLine_d_nm);
    return std::accumulate(e.begin(), e.end(), 0.0) * 0.5 * 0.5;
  };
  const double with_glass = flux(scene.scene);
  for (Material& material : scene.scene.materials) {
    if (material.transmission > 0.0f) material = test::matte(Vec3f(0.0f));
  }
  const double thrown = with_glass - flux(scene.scene);
  EXPECT_GT(thrown, 0.05 * GetParam()->on_glass_sr);
  EXPECT_LT(thrown, 1.01 * GetParam()->on_glass_sr);  // Edges of light in 4 samples.
}

INSTANTIATE_TEST_SUITE_P(glass, ForwardFloor, testing::Values(&kCube, &kWedge, &kGem),
                         [](const auto& test) { return test.param->make().name; });

struct SlitLine {
  const char* glass;
  double line_nm;
  double middle_px;  ///< From the middle of the screen.
  double flux_sr;    ///< On the strip that the screen is.
  int first_column;  ///< Of three in the line's middle.
  double irradiance;
};

const SlitLine kSlitLines[] = {
    {"glass/schott/N-BK7", kLineF_nm, -8.7311, 6.877048e-05, 246, 0.848031},
    {"glass/schott/N-BK7", kLine_d_nm, -0.0150, 6.894741e-05, 254, 0.850515},
    {"glass/schott/N-BK7", kLineC_nm, 3.8322, 6.902422e-05, 258, 0.851268},
    {"glass/schott/N-SF11", kLineF_nm, -51.1011, 5.450575e-05, 203, 0.674349},
    {"glass/schott/N-SF11", kLine_d_nm, -0.0303, 5.635308e-05, 254, 0.701551},
    {"glass/schott/N-SF11", kLineC_nm, 19.1766, 5.695625e-05, 274, 0.707273},
};

TEST(ForwardSlit, lines_of_a_lamp_behind_a_slit_lie_where_rays_sent_forwards_land) {
  for (const char* glass : {"glass/schott/N-BK7", "glass/schott/N-SF11"}) {
    const test::Newton n = test::newton_with_slit(glass);
    RenderSettings settings = test::small_settings();
    settings.inner_reflections = 1;  // As the reference follows it.
    settings.size = n.size;
    settings.samples_per_pixel = 16;
    settings.wavelengths.exact_nm = {kLineF_nm, kLine_d_nm, kLineC_nm};
    const Image image = test::render(n.scene, settings).image;
    for (const SlitLine& expected : kSlitLines) {
      if (std::string(expected.glass) != glass) continue;
      const std::vector<double> e = irradiances(image, expected.line_nm);
      double sum = 0.0, moment = 0.0, middle = 0.0;
      for (int y = 0; y < n.size.y; ++y) {
        for (int x = 0; x < n.size.x; ++x) {
          const double value = e[static_cast<std::size_t>(y * n.size.x + x)];
          sum += value;
          moment += value * (x + 0.5 - 0.5 * n.size.x);
          if (x >= expected.first_column && x < expected.first_column + 3) middle += value;
        }
      }
      // Half a pixel and 1 % are asked for; the line's edges are sampled four times a pixel.
      EXPECT_NEAR(moment / sum, expected.middle_px, 0.05) << glass << " " << expected.line_nm;
      EXPECT_NEAR(sum * n.pixel_m * n.pixel_m, expected.flux_sr, 0.005 * expected.flux_sr);
      // No edge is here: what is left are the bins of the reference.
      EXPECT_NEAR(middle / (3 * n.size.y), expected.irradiance, 0.003 * expected.irradiance);
    }
  }
}

}  // namespace
}  // namespace abbe
