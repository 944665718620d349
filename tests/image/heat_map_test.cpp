#include "abbe/image/metrics/heat_map.h"

#include <gtest/gtest.h>

#include <limits>

#include "abbe/image/metrics/false_color.h"

namespace abbe {
namespace {

double luma(const Vec3f& color) {
  return 0.2126 * color.x + 0.7152 * color.y + 0.0722 * color.z;
}

TEST(HeatMap, gets_lighter_with_every_step) {
  for (int i = 1; i <= 100; ++i) {
    EXPECT_GT(luma(heat_color(0.01 * i)), luma(heat_color(0.01 * (i - 1)))) << i;
  }
  EXPECT_EQ(heat_color(-3.0), heat_color(0.0));
  EXPECT_EQ(heat_color(7.0), heat_color(1.0));
  EXPECT_EQ(heat_color(std::numeric_limits<double>::quiet_NaN()), heat_color(1.0));
}

TEST(HeatMap, shows_shares_of_the_full_scale) {
  const Image map = heat_map({0.0f, 5.0f, 10.0f}, 3, 1, 10.0);
  for (int x = 0; x < 3; ++x) {
    EXPECT_EQ(map.at(x, 0, 1), heat_color(0.5 * x).y);
  }
}

TEST(FalseColor, sorts_luminances_into_stops_around_middle_grey) {
  Image image;
  image.width = 5;
  image.height = 1;
  image.channels = {"R", "G", "B"};
  for (const float level : {0.18f, 0.36f, 0.09f, 0.0f, 1e9f}) {
    image.pixels.insert(image.pixels.end(), {level, level, level});
  }
  const FalseColorImage result = false_color_image(image);
  const auto zone = [](int ev) { return static_cast<std::size_t>(ev - kFalseColorLowest_ev); };
  EXPECT_EQ(result.pixels[zone(0)], 1u);
  EXPECT_EQ(result.pixels[zone(1)], 1u);
  EXPECT_EQ(result.pixels[zone(-1)], 1u);
  EXPECT_EQ(result.pixels[zone(kFalseColorLowest_ev)], 1u);
  EXPECT_EQ(result.pixels[zone(kFalseColorHighest_ev)], 1u);
  EXPECT_EQ(result.picture.at(0, 0, 1), false_color(0).y);
  // Green belongs to middle grey alone.
  for (int ev = kFalseColorLowest_ev; ev <= kFalseColorHighest_ev; ++ev) {
    const Vec3f color = false_color(ev);
    EXPECT_EQ(color.y > color.x && color.y > color.z, ev == 0) << ev;
  }
}

}  // namespace
}  // namespace abbe
