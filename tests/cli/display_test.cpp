/// `abbe display`: OCIO alone.
#include <gmock/gmock.h>

#include <algorithm>

#include "abbe/image/exr/exr.h"
#include "abbe/image/raster/raster.h"
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

TEST_F(DisplayTest, spectrum_under_the_observer_of_the_render_is_its_picture) {
  render({"-o", "a.exr", "-o", "a.png", "--bands", "360:830:5"});
  succeed({"display", "a.exr", "-o", "b.png", "--observer", "cie1931"});
  EXPECT_EQ(abbe({"diff", "b.png", "a.png", "--fail", "max=0.02"}).exit_code, 0);
}

TEST_F(DisplayTest, spectrum_under_another_white_is_a_render_under_it) {
  const Arguments content{"render", "scene.gltf", "--size",  "24x16",
                          "--spp",  "16",         "--bands", "360:830:5"};
  const auto with = [&content](Arguments arguments) {
    arguments.insert(arguments.begin(), content.begin(), content.end());
    return arguments;
  };
  succeed(with({"-o", "a.exr"}));
  for (const Arguments& way : {Arguments{"--observer", "cie1964"}, Arguments{"--white", "A"},
                               Arguments{"--white", "0.3457,0.3585", "--adaptation", "bradford"}}) {
    Arguments render_it = with({"-o", "rendered.exr"});
    render_it.insert(render_it.end(), way.begin(), way.end());
    succeed(render_it);
    Arguments display_it{"display", "a.exr", "-o", "developed.exr"};
    display_it.insert(display_it.end(), way.begin(), way.end());
    succeed(display_it);
    // Bands of 5 nm instead of the wavelengths themselves.
    const Outcome run = abbe({"diff", "developed.exr", "rendered.exr", "--fail", "de2000=0.1"});
    EXPECT_EQ(run.exit_code, 0) << run.out;
    EXPECT_EQ(abbe({"inspect", "developed.exr", "--json"}).exit_code, 0);
  }
}

TEST_F(DisplayTest, any_exr_is_shown_by_what_it_has) {
  render({"-o", "a.exr", "--aov", "Z,N,albedo,direct", "--bands", "400:700:50"});
  const Image image = read_exr(file("a.exr"));
  const auto write_part = [&](const char* name, const std::vector<std::string>& from,
                              const std::vector<std::string>& to) {
    Image part;
    part.width = image.width;
    part.height = image.height;
    part.channels = to;
    for (int y = 0; y < image.height; ++y) {
      for (int x = 0; x < image.width; ++x) {
        for (const std::string& channel : from) {
          part.pixels.push_back(image.at(x, y, image.channel_index(channel).value()));
        }
      }
    }
    write_exr(file(name), part, {});
  };
  write_part("xyz.exr", {"R", "G", "B"}, {"X", "Y", "Z"});
  write_part("grey.exr", {"G"}, {"Y"});
  write_part("spectrum.exr", {"S0.425,000000nm", "S0.525,000000nm", "S0.625,000000nm"},
             {"S0.425,000000nm", "S0.525,000000nm", "S0.625,000000nm"});
  write_part("other.exr", {"Z"}, {"depth"});
  for (const char* name : {"xyz", "grey", "spectrum"}) {
    succeed({"display", std::string(name) + ".exr", "-o", std::string(name) + ".png"});
  }
  for (const char* layer : {"albedo", "N", "Z", "direct"}) {
    succeed({"display", "a.exr", "-o", "layer.png", "--layer", layer});
  }
  EXPECT_EQ(abbe({"display", "other.exr", "-o", "x.png"}).exit_code, 3);
  succeed({"display", "other.exr", "-o", "x.png", "--layer", "depth"});
}

TEST_F(DisplayTest, false_colour_counts_the_pixels_of_every_stop) {
  render({"-o", "a.exr"});
  const Outcome run = abbe({"display", "a.exr", "-o", "f.png", "--false-color"});
  EXPECT_EQ(run.exit_code, 0) << run.err;
  EXPECT_EQ(std::count(run.out.begin(), run.out.end(), '\n'), 17);
}

TEST_F(DisplayTest, gamut_warning_marks_what_the_display_cannot_show) {
  Image image;
  image.width = 4;
  image.height = 1;
  image.channels = {"R", "G", "B"};
  // White however bright, Rec.709 red, one of Rec.2020's primaries, black.
  image.pixels = {9.0f, 9.0f, 9.0f, 1.0f, 0.0f, 0.0f, -0.59f, 1.13f, -0.10f, 0.0f, 0.0f, 0.0f};
  write_exr(file("a.exr"), image, {});
  for (const auto& [display, says] :
       {std::pair{"sRGB - Display", "25.00 %"}, std::pair{"Rec.1886 Rec.709 - Display", "25.00 %"},
        std::pair{"Display P3 - Display", "25.00 %"},
        std::pair{"Rec.2100-PQ - Display", "0.00 %"}}) {
    for (const char* view : {"Un-tone-mapped", "Raw"}) {
      const Outcome run = abbe({"display", "a.exr", "-o", "g.png", "--gamut-warning", "--display",
                                display, "--view", view});
      EXPECT_EQ(run.exit_code, 0) << run.err;
      EXPECT_THAT(run.out, testing::HasSubstr(says)) << display << ", " << view;
    }
  }
  const Image shown = read_raster(file("g.png"));
  EXPECT_EQ(shown.width, 4);
}

TEST_F(DisplayTest, wrong_wishes_are_usage_or_input_errors) {
  render({"-o", "a.exr"});
  render({"-o", "s.exr", "--bands", "400:700:50"});
  EXPECT_EQ(abbe({"display", "a.exr", "-o", "x.png", "--white", "A"}).exit_code, 3);
  EXPECT_EQ(abbe({"display", "s.exr", "-o", "x.png", "--white", "scene"}).exit_code, 2);
  EXPECT_EQ(abbe({"display", "s.exr", "-o", "x.exr"}).exit_code, 2);
  EXPECT_EQ(abbe({"display", "s.exr", "-o", "x.png", "--layer", "Q"}).exit_code, 2);
  EXPECT_EQ(abbe({"display", "s.exr", "-o", "x.png", "--observer", "me"}).exit_code, 2);
  EXPECT_EQ(abbe({"display", "s.exr", "-o", "x.png", "--false-color", "--gamut-warning"}).exit_code,
            2);
}

}  // namespace
}  // namespace abbe::test
