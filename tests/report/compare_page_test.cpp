// The size of the comparison page at its worst: noise, which nothing compresses.

#include <gtest/gtest.h>

#include <random>

#include "abbe/image/exr/exr.h"
#include "abbe/report/comparison/files.h"
#include "abbe/report/comparison/page.h"

namespace abbe {
namespace {

Image noise_image(int width, int height, const std::vector<std::string>& channels,
                  std::mt19937& random) {
  Image image;
  image.width = width;
  image.height = height;
  image.channels = channels;
  std::exponential_distribution<float> values(3.0f);
  image.pixels.resize(static_cast<std::size_t>(width) * height * channels.size());
  for (float& value : image.pixels) value = values(random);
  return image;
}

std::vector<float> noise_map(int width, int height, std::mt19937& random) {
  return noise_image(width, height, {"Y"}, random).pixels;
}

TEST(ComparePage, noise_of_1280x720_with_36_bands_stays_below_8_megabytes) {
  constexpr int kWidth = 1280, kHeight = 720;
  std::mt19937 random(7);
  CompareResult result;
  result.scene = "noise";
  result.settings.size = {kWidth, kHeight};
  std::vector<std::string> spectral{"R", "G", "B"};
  for (int band = 0; band < 36; ++band) {
    spectral.push_back(spectral_channel_name(385.0 + 10.0 * band));
  }
  result.modes["rgb"].image = noise_image(kWidth, kHeight, {"R", "G", "B"}, random);
  result.modes["rgb3"].image = result.modes["rgb"].image;
  result.modes["spectral"].image = noise_image(kWidth, kHeight, spectral, random);
  for (const char* mode : {"rgb", "rgb3"}) {
    ColorMaps& maps = result.differences[mode].maps;
    maps.delta_e2000 = noise_map(kWidth, kHeight, random);
    maps.delta_e_itp = maps.delta_e2000;
    maps.flip = maps.delta_e2000;
  }
  result.causes.acting = {kCauses.begin(), kCauses.end()};
  result.causes.whole = result.differences["rgb"].maps.delta_e2000;
  result.causes.attribution.interaction = result.causes.whole;
  result.causes.attribution.shares.assign(kCauseCount, result.causes.whole);
  result.causes.dominant.assign(result.causes.whole.size(), 2);
  // As large as write_pictures lets them be.
  const std::map<std::string, std::string> pictures{
      {"rgb", std::string(kMaxPageBytes / 6, 'A')},
      {"rgb3", std::string(kMaxPageBytes / 6, 'A')},
      {"spectral", std::string(kMaxPageBytes / 6, 'A')}};
  Observer observer;
  const std::string page = compare_page(result, pictures, observer, kMaxPageBytes);
  EXPECT_LT(page.size(), 8'000'000u);
  // And still has what it is for.
  EXPECT_NE(page.find("\"id\": \"uplift\""), std::string::npos);
}

}  // namespace
}  // namespace abbe
