// The same pictures and configuration in OpenColorIO's and OpenImageIO's own programs.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>

#include "abbe/display/display.h"
#include "abbe/image/exr/exr.h"
#include "abbe/image/raster/raster.h"
#include "image/temporary_folder.h"

namespace abbe {
namespace {

const std::string kConfig = std::string(ABBE_SOURCE_DIR) + "/config/config.ocio";

TEST(DisplayOracle, ociocheck_finds_nothing_wrong_with_the_configuration) {
  EXPECT_EQ(std::system(("ociocheck --iconfig '" + kConfig + "' > /dev/null 2>&1").c_str()), 0);
}

// Ramps of greys, primaries and colours outside the gamut, from deep shadow to far above white.
Image ramps() {
  Image image;
  image.width = 64;
  image.height = 8;
  image.channels = {"R", "G", "B"};
  const std::vector<Vec3f> hues{{1, 1, 1},        {1, 0, 0},       {0, 1, 0},
                                {0, 0, 1},        {1, 0.5f, 0.1f}, {-0.3f, 1, -0.1f},
                                {0.2f, -0.1f, 1}, {2, -0.1f, 0}};
  for (const Vec3f& hue : hues) {
    for (int x = 0; x < image.width; ++x) {
      const float scale = std::exp2(static_cast<float>(x) / 4.0f - 10.0f);
      for (int c = 0; c < 3; ++c) image.pixels.push_back(scale * hue[c]);
    }
  }
  return image;
}

TEST(DisplayOracle, png_equals_that_of_oiiotool_to_one_code) {
  const TemporaryFolder folder;
  const Image image = ramps();
  write_exr(folder / "in.exr", image, {});
  for (const std::string display : {"sRGB - Display", "Rec.1886 Rec.709 - Display",
                                    "Display P3 - Display", "Rec.2100-PQ - Display"}) {
    std::vector<std::string> views{"ACES 1.0 - SDR Video", "Un-tone-mapped"};
    views.emplace_back(display.find("PQ") == std::string::npos
                           ? "Spectral Hue - SDR Video"
                           : "Spectral Hue - HDR Video (1000 nits)");
    for (const std::string& view : views) {
      DisplayOptions options;
      options.config = kConfig;
      options.display = display;
      options.view = view;
      write_raster(folder / "ours.png", to_display(image, options));
      const std::string command =
          "oiiotool --colorconfig '" + kConfig + "' '" + (folder / "in.exr").string() +
          "' --ociodisplay:from='Linear Rec.709 (sRGB)' '" + display + "' '" + view +
          "' -d uint8 -o '" + (folder / "theirs.png").string() + "'";
      ASSERT_EQ(std::system(command.c_str()), 0) << command;
      const Image ours = read_raster(folder / "ours.png");
      const Image theirs = read_raster(folder / "theirs.png");
      ASSERT_EQ(ours.pixels.size(), theirs.pixels.size());
      int different = 0;
      for (std::size_t i = 0; i < ours.pixels.size(); ++i) {
        const int apart = std::abs(static_cast<int>(std::lround(ours.pixels[i] * 255.0f)) -
                                   static_cast<int>(std::lround(theirs.pixels[i] * 255.0f)));
        EXPECT_LE(apart, 1) << display << ", " << view << ", value " << i;
        different += apart != 0;
      }
      // Values that fall between two codes may round differently, not whole regions.
      EXPECT_LE(different, static_cast<int>(ours.pixels.size() / 100)) << display << ", " << view;
    }
  }
}

}  // namespace
}  // namespace abbe
