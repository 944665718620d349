/// `abbe display`: OCIO alone.
#include <gmock/gmock.h>

#include "image/raster.h"
#include "program.h"

namespace abbe::test {
namespace {

class DisplayTest : public ProgramTest {
 protected:
  void succeed(const Arguments& arguments) const {
    const Outcome run = abbe(arguments);
    EXPECT_EQ(run.exit_code, 0) << run.err;
  }
  void render(const Arguments& more) const {
    Arguments arguments{"render", "scene.gltf", "--size", "24x16", "--spp", "1"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    succeed(arguments);
  }
};

TEST_F(DisplayTest, picture_is_the_one_that_render_makes) {
  render({"-o", "a.exr", "-o", "a.png", "--exposure", "1"});
  succeed({"display", "a.exr", "-o", "b.png", "--exposure", "1"});
  EXPECT_EQ(bytes("a.png"), bytes("b.png"));
}

TEST_F(DisplayTest, view_and_exposure_change_the_picture) {
  render({"-o", "a.exr", "-o", "a.png"});
  succeed({"display", "a.exr", "-o", "view.png", "--view", "Un-tone-mapped"});
  succeed({"display", "a.exr", "-o", "auto.png", "--exposure", "auto"});
  succeed({"display", "a.exr", "-o", "other.png", "--display", "Display P3 - Display"});
  for (const char* other : {"view.png", "auto.png", "other.png"}) {
    EXPECT_NE(bytes("a.png"), bytes(other)) << other;
  }
}

TEST_F(DisplayTest, space_of_the_file_is_known_from_the_file) {
  render({"-o", "a.exr", "-o", "a.png"});
  render({"-o", "b.exr", "--colorspace", "ACEScg"});
  succeed({"display", "b.exr", "-o", "b.png"});
  const Image a = read_raster(file("a.png"));
  const Image b = read_raster(file("b.png"));
  ASSERT_EQ(a.pixels.size(), b.pixels.size());
  for (std::size_t i = 0; i < a.pixels.size(); ++i) {
    // One 8-bit code: the way through ACEScg rounds differently.
    EXPECT_NEAR(a.pixels[i], b.pixels[i], 1.01f / 255.0f);
  }
}

}  // namespace
}  // namespace abbe::test
