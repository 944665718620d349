// Renders whose samples go where they are needed.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "abbe/base/error.h"
#include "abbe/base/parallel.h"
#include "support/scene_builder.h"

namespace abbe {
namespace {

Scene glass_ball_on_floor() {
  Scene scene;
  test::add_square(scene, test::add(scene, test::matte(Vec3f(0.8f))), 20.0,
                   test::rotation({1, 0, 0}, -90.0));
  test::add_sphere(scene, test::add(scene, test::glass("glass/schott/SF10")), {0, 1, 0}, 0.8);
  scene.cameras.push_back(test::perspective_camera({0, 2, 5}, {0, 0.7, 0}, 40.0));
  scene.lights.push_back(test::point_light({2, 3, 1}, 20.0));
  return scene;
}

RenderSettings noise_settings() {
  RenderSettings settings = test::small_settings();
  settings.size = {40, 36};
  settings.filter = "gaussian";
  settings.samples_per_pixel = 64;
  settings.noise = 2.0;
  settings.cutoff = RenderSettings{}.cutoff;
  return settings;
}

TEST(NoiseTest, image_for_any_number_of_threads_is_the_same_bit_for_bit) {
  const Scene scene = glass_ball_on_floor();
  std::vector<float> reference;
  for (const int threads : {1, 3}) {
    const ThreadLimit limit(threads);
    const std::vector<float> pixels = test::render(scene, noise_settings()).image.pixels;
    if (reference.empty()) reference = pixels;
    EXPECT_EQ(pixels, reference) << threads;
  }
}

TEST(NoiseTest, crop_has_the_pixels_of_the_whole_image) {
  const Scene scene = glass_ball_on_floor();
  RenderSettings settings = noise_settings();
  settings.aovs = {"samples"};
  const Image whole = test::render(scene, settings).image;
  for (const PixelRect& crop : {PixelRect{13, 9, 27, 21}, PixelRect{39, 35, 40, 36}}) {
    settings.crop = crop;
    const Image part = test::render(scene, settings).image;
    for (int y = 0; y < part.height; ++y) {
      for (int x = 0; x < part.width; ++x) {
        for (std::size_t c = 0; c < 4; ++c) {
          ASSERT_EQ(part.at(x, y, c), whole.at(x + crop.x0, y + crop.y0, c));
        }
      }
    }
  }
}

TEST(NoiseTest, channel_of_samples_counts_them) {
  RenderSettings settings = noise_settings();
  settings.aovs = {"samples"};
  const test::Rendered rendered = test::render(glass_ball_on_floor(), settings);
  double sum = 0.0;
  float least = 1e9f, most = 0.0f;
  for (int y = 0; y < settings.size.y; ++y) {
    for (int x = 0; x < settings.size.x; ++x) {
      const float samples = test::pixel(rendered.image, x, y, "samples");
      sum += static_cast<double>(samples);
      least = std::min(least, samples);
      most = std::max(most, samples);
    }
  }
  EXPECT_EQ(sum, rendered.sampling.samples);
  EXPECT_EQ(least, 8.0f);  // Of the floor, without its edge.
  EXPECT_GT(most, 16.0f);  // Of the edges of the ball.
  EXPECT_LE(most, 64.0f);
  EXPECT_EQ(rendered.sampling.passes, 2);
  EXPECT_GT(rendered.sampling.error, 0.1);
}

// Any of it that depends on itself makes the picture darker or brighter.
TEST(NoiseTest, mean_of_64_seeds_is_that_of_a_uniform_render) {
  const Scene scene = glass_ball_on_floor();
  const auto mean_of = [&scene](const RenderSettings& settings) {
    const Image image = test::render(scene, settings).image;
    double sum = 0.0;
    for (const float value : image.pixels) sum += static_cast<double>(value);
    return sum / static_cast<double>(image.pixels.size());
  };
  struct Means {
    double mean = 0.0, squared_error = 0.0;
  };
  constexpr int kSeeds = 64;
  const auto of_seeds = [&](RenderSettings settings) {
    std::vector<double> values;
    Means means;
    for (std::uint32_t seed = 0; seed < kSeeds; ++seed) {
      settings.seed = seed;
      values.push_back(mean_of(settings));
      means.mean += values.back() / kSeeds;
    }
    for (const double value : values) {
      means.squared_error +=
          (value - means.mean) * (value - means.mean) / (kSeeds * (kSeeds - 1.0));
    }
    return means;
  };
  RenderSettings settings = noise_settings();
  settings.size = {20, 18};
  settings.noise = 6.0;  // Coarse: hardly any pixel gets all that it may.
  const Means adaptive = of_seeds(settings);
  settings.noise = 0.0;
  settings.samples_per_pixel = 16;
  const Means uniform = of_seeds(settings);
  const double z =
      (adaptive.mean - uniform.mean) / std::sqrt(adaptive.squared_error + uniform.squared_error);
  EXPECT_LT(std::abs(z), 2.58) << adaptive.mean << " " << uniform.mean;
  // So that the test means something: half a per cent would be found.
  EXPECT_LT(std::sqrt(adaptive.squared_error + uniform.squared_error), 2e-3 * uniform.mean);
}

TEST(NoiseTest, bands_are_those_of_a_uniform_render) {
  Scene scene;
  Material lamp = test::emitter(Vec3f(1.0f));
  lamp.emission = SpectralEmission{{"A", test::catalogue().illuminant("illuminant/A")}, 1.0};
  // A small bright disc of light before nothing: its edge takes more samples.
  test::add_sphere(scene, test::add(scene, lamp), Vec3d(0.0), 1.0);
  scene.cameras.push_back(test::orthographic_camera({0, 0, 5}, {0, 0, 0}, 1.5, 1.5));
  RenderSettings settings = noise_settings();
  settings.size = {32, 32};
  settings.bands = parse_bands("400:700:50");
  settings.aovs = {"samples"};
  const Image image = test::render(scene, settings).image;
  settings.noise = 0.0;
  settings.aovs.clear();
  const Image uniform = test::render(scene, settings).image;
  bool has_more = false;
  for (std::size_t band = 3; band < 9; ++band) {
    double sum = 0.0, uniform_sum = 0.0;
    for (int y = 0; y < 32; ++y) {
      for (int x = 0; x < 32; ++x) {
        sum += static_cast<double>(image.at(x, y, band));
        uniform_sum += static_cast<double>(uniform.at(x, y, band));
        has_more = has_more || image.at(x, y, 9) > 8.0f;
      }
    }
    // 8 samples of 16 wavelengths know the mean over 50 nm of a smooth spectrum to 1e-3.
    EXPECT_NEAR(sum / uniform_sum, 1.0, 2e-3) << band;
  }
  EXPECT_TRUE(has_more);
}

// A tenth of a pixel wide, aslant, before black: few samples of a pixel meet it.
TEST(NoiseTest, thin_bright_wire_keeps_its_light_and_has_no_gaps) {
  constexpr int kSide = 48;
  constexpr double kWidth_px = 0.1;
  Scene scene;
  const double per_px = 2.0 / kSide;  // The camera sees 2 m.
  Mat4d thin(1.0);
  thin[0][0] = 0.7;
  thin[1][1] = 0.5 * kWidth_px * per_px;
  test::add_square(scene, test::add(scene, test::emitter(Vec3f(50.0f))), 1.0,
                   test::rotation({0, 0, 1}, 20.0) * thin);
  scene.cameras.push_back(test::orthographic_camera({0, 0, 5}, {0, 0, 0}, 1.0, 1.0));
  RenderSettings settings = noise_settings();
  settings.size = {kSide, kSide};
  settings.samples_per_pixel = kMostSamples;
  settings.noise = kFinishedNoise;
  const double length_px = 2.0 * 0.7 / per_px;
  const double slope = std::tan(20.0 * 3.14159265358979 / 180.0);
  constexpr int kSeeds = 16;
  double light = 0.0;
  int longest = 0;
  for (settings.seed = 0; settings.seed < kSeeds; ++settings.seed) {
    const Image image = test::render(scene, settings).image;
    for (int y = 0; y < kSide; ++y) {
      for (int x = 0; x < kSide; ++x) light += static_cast<double>(image.at(x, y, 1)) / kSeeds;
    }
    int gap = 0;
    for (int x = 10; x < kSide - 10; ++x) {
      const int y = static_cast<int>(std::floor(0.5 * kSide - (x + 0.5 - 0.5 * kSide) * slope));
      gap = image.at(x, y, 1) > 0.2f ? 0 : gap + 1;
      longest = std::max(longest, gap);
    }
  }
  // Its samples are few: one render is right to 4 %, 16 are to 1 %.
  EXPECT_NEAR(light / (50.0 * length_px * kWidth_px), 1.0, 0.02);
  EXPECT_LE(longest, 2);
}

TEST(NoiseTest, settings_that_cannot_be_are_usage_errors) {
  RenderSettings settings = noise_settings();
  settings.samples_per_pixel = 4;
  EXPECT_THROW(check_settings(settings), Error);
  settings.samples_per_pixel = 8;
  EXPECT_NO_THROW(check_settings(settings));
  for (const double noise : {-1.0, 1e-4, 1e3, std::nan("")}) {
    settings.noise = noise;
    EXPECT_THROW(check_settings(settings), Error) << noise;
  }
}

}  // namespace
}  // namespace abbe
