/// `abbe render` from a scene to its files.
#include <gmock/gmock.h>

#include <nlohmann/json.hpp>

#include "abbe/image/exr/exr.h"
#include "abbe/image/raster/raster.h"
#include "program.h"
#include "scenes.h"

namespace abbe::test {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;

class RenderTest : public ProgramTest {
 protected:
  /// Renders the small scene at 24×16, 2 samples; the run has to succeed.
  Outcome render(const Arguments& more) const {
    Arguments arguments{"render", "scene.gltf", "--size", "24x16", "--spp", "2"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    Outcome run = abbe(arguments);
    EXPECT_EQ(run.exit_code, 0) << run.err;
    return run;
  }

  template <typename T>
  static T attribute(const ExrHeader& header, const std::string& name) {
    const auto found = header.attributes.find(name);
    if (found == header.attributes.end()) {
      ADD_FAILURE() << "no attribute " << name;
      return {};
    }
    return std::get<T>(found->second);
  }
};

TEST_F(RenderTest, files_are_those_asked_for_and_hold_an_image) {
  render({"-o", "a.exr", "-o", "a.png", "-o", "a.jpg", "-o", "a.tif"});
  EXPECT_THAT(new_files(), ElementsAre("a.exr", "a.jpg", "a.png", "a.tif"));
  const Image image = read_exr(file("a.exr"));
  EXPECT_EQ(image.width, 24);
  EXPECT_EQ(image.height, 16);
  float brightest = 0.0f;
  for (const float value : image.pixels) brightest = std::max(brightest, value);
  EXPECT_GT(brightest, 0.1f);
  EXPECT_EQ(read_raster(file("a.png")).width, 24);
}

TEST_F(RenderTest, same_bytes_for_any_number_of_threads_and_any_run) {
  render({"-o", "one.exr", "-o", "one.png", "--bands", "400:700:50", "--threads", "1"});
  for (const char* threads : {"1", "2", "3"}) {
    render({"-o", "more.exr", "-o", "more.png", "--bands", "400:700:50", "--threads", threads});
    EXPECT_EQ(bytes("one.exr"), bytes("more.exr")) << threads << " threads";
    EXPECT_EQ(bytes("one.png"), bytes("more.png")) << threads << " threads";
  }
}

TEST_F(RenderTest, another_seed_is_another_image) {
  render({"-o", "a.exr"});
  render({"-o", "b.exr", "--seed", "1"});
  EXPECT_NE(read_exr(file("a.exr")).pixels, read_exr(file("b.exr")).pixels);
}

TEST_F(RenderTest, crop_is_the_same_pixels_as_the_whole) {
  render({"-o", "whole.exr"});
  render({"-o", "crop.exr", "--crop", "5,3,17,11"});
  const Image whole = read_exr(file("whole.exr"));
  const Image crop = read_exr(file("crop.exr"));
  ASSERT_EQ(crop.width, 12);
  ASSERT_EQ(crop.height, 8);
  EXPECT_EQ(crop.data_origin, Vec2i(5, 3));
  EXPECT_EQ(crop.full_size, Vec2i(24, 16));
  for (int y = 0; y < crop.height; ++y) {
    for (int x = 0; x < crop.width; ++x) {
      for (std::size_t c = 0; c < 3; ++c) {
        EXPECT_EQ(crop.at(x, y, c), whole.at(x + 5, y + 3, c)) << x << "," << y;
      }
    }
  }
}

TEST_F(RenderTest, modes_agree_on_the_brightness_of_a_neutral_scene) {
  double sums[3] = {0.0, 0.0, 0.0};
  const char* modes[] = {"spectral", "rgb", "rgb3"};
  for (int m = 0; m < 3; ++m) {
    render({"-o", "a.exr", "--mode", modes[m]});
    EXPECT_EQ(attribute<std::string>(read_exr_header(file("a.exr")), "abbe:mode"), modes[m]);
    for (const float value : read_exr(file("a.exr")).pixels) {
      sums[m] += static_cast<double>(value);
    }
  }
  EXPECT_NEAR(sums[1] / sums[0], 1.0, 0.1);   // Reds differ by a few percent between the modes,
  EXPECT_NEAR(sums[2] / sums[1], 1.0, 0.05);  // indices per channel by less.
}

TEST_F(RenderTest, provenance_says_what_shaped_the_image) {
  render({"-o", "a.exr", "--seed", "7", "--depth", "5", "--filter", "box"});
  const ExrHeader header = read_exr_header(file("a.exr"));
  EXPECT_EQ(attribute<std::string>(header, "abbe:version"), ABBE_VERSION);
  EXPECT_EQ(attribute<std::string>(header, "abbe:mode"), "spectral");
  EXPECT_THAT(attribute<std::string>(header, "abbe:observer"),
              testing::StartsWith("observer/cie1931-2deg, integral of y-bar 106.8569"));
  EXPECT_EQ(attribute<std::string>(header, "abbe:illuminant"), "illuminant/D65");
  EXPECT_EQ(attribute<std::string>(header, "abbe:uplift"), "Jakob-Hanika 2019, Rec.709");
  EXPECT_EQ(attribute<int>(header, "abbe:wavelengths"), 16);
  EXPECT_EQ(attribute<int>(header, "abbe:samples"), 2);
  EXPECT_EQ(attribute<std::string>(header, "abbe:seed"), "7");
  EXPECT_EQ(attribute<int>(header, "abbe:depth"), 5);
  EXPECT_EQ(attribute<std::string>(header, "abbe:filter"), "box");
  EXPECT_EQ(attribute<std::string>(header, "abbe:camera"), "eye");
  EXPECT_EQ(attribute<int>(header, "abbe:complete"), 1);
  EXPECT_EQ(attribute<std::string>(header, "abbe:sceneHash").size(), 16u);
  ASSERT_TRUE(header.chromaticities);
  EXPECT_FLOAT_EQ((*header.chromaticities)[0], 0.64f);
  EXPECT_FLOAT_EQ((*header.chromaticities)[6], 0.3127f);
}

TEST_F(RenderTest, provenance_knows_no_paths_threads_or_dates) {
  render({"-o", "a.exr", "--threads", "2"});
  const std::string exr = bytes("a.exr");
  EXPECT_THAT(exr, Not(HasSubstr(folder().string())));
  EXPECT_THAT(exr, Not(HasSubstr("scene.gltf")));
  EXPECT_THAT(exr, Not(HasSubstr("thread")));
  EXPECT_THAT(exr, Not(HasSubstr("capDate")));
}

TEST_F(RenderTest, bands_are_spectral_channels_in_the_layout) {
  render({"-o", "a.exr", "--bands", "400:700:100"});
  const ExrHeader header = read_exr_header(file("a.exr"));
  ASSERT_EQ(header.channels.size(), 6u);
  EXPECT_EQ(header.channels[3].name, "S0.450,000000nm");
  EXPECT_EQ(header.channels[5].name, "S0.650,000000nm");
  EXPECT_EQ(attribute<std::string>(header, "spectralLayoutVersion"), "1.0");
  EXPECT_EQ(attribute<std::string>(header, "emissiveUnits"), "W.m^-2.sr^-1");
  EXPECT_EQ(attribute<float>(header, "EV"), 0.0f);
}

TEST_F(RenderTest, lines_are_one_channel_each) {
  render({"-o", "a.exr", "--lines", "486.13,587.56,656.27"});
  const ExrHeader header = read_exr_header(file("a.exr"));
  ASSERT_EQ(header.channels.size(), 6u);
  EXPECT_EQ(header.channels[3].name, "S0.486,130000nm");
  EXPECT_EQ(attribute<std::string>(header, "abbe:lines"), "486.13,587.56,656.27 nm");
}

TEST_F(RenderTest, half_is_for_colours_only) {
  render({"-o", "a.exr", "--half", "--aov", "Z"});
  for (const ExrHeader::Channel& channel : read_exr_header(file("a.exr")).channels) {
    EXPECT_EQ(channel.type, channel.name == "Z" ? "float" : "half") << channel.name;
  }
}

TEST_F(RenderTest, aovs_are_extra_channels) {
  render({"-o", "a.exr", "--aov", "Z,N,objectId"});
  const Image image = read_exr(file("a.exr"));
  const auto depth = image.channel_index("Z");
  const auto object = image.channel_index("objectId");
  ASSERT_TRUE(depth && object && image.channel_index("N.X"));
  EXPECT_NEAR(image.at(12, 8, *depth), 5.0f, 0.05f);  // The ball's front, a pixel off its middle.
  EXPECT_EQ(image.at(12, 8, *object), 1.0f);
}

TEST_F(RenderTest, colorspace_changes_the_exr_and_not_the_picture) {
  render({"-o", "a.exr", "-o", "a.png"});
  render({"-o", "b.exr", "-o", "b.png", "--colorspace", "ACEScg"});
  EXPECT_EQ(bytes("a.png"), bytes("b.png"));
  EXPECT_NE(read_exr(file("a.exr")).pixels, read_exr(file("b.exr")).pixels);
  const ExrHeader header = read_exr_header(file("b.exr"));
  ASSERT_TRUE(header.chromaticities);
  EXPECT_FLOAT_EQ((*header.chromaticities)[0], 0.713f);
  EXPECT_EQ(attribute<std::string>(header, "abbe:primaries"), "ACEScg");
}

TEST_F(RenderTest, exposure_changes_the_picture_and_not_the_exr) {
  render({"-o", "a.exr", "-o", "a.png"});
  render({"-o", "b.exr", "-o", "b.png", "--exposure", "-1.5"});
  EXPECT_EQ(bytes("a.exr"), bytes("b.exr"));
  EXPECT_NE(bytes("a.png"), bytes("b.png"));
}

TEST_F(RenderTest, exposure_of_a_crop_is_that_of_the_whole_image_and_written) {
  const Outcome whole = render({"-o", "a.exr", "-o", "a.png"});
  EXPECT_THAT(whole.err, HasSubstr("abbe: note: shown at "));
  render({"-o", "b.exr", "--crop", "0,0,4,4"});
  const auto ev = attribute<float>(read_exr_header(file("a.exr")), "abbe:exposure");
  EXPECT_EQ(attribute<float>(read_exr_header(file("b.exr")), "abbe:exposure"), ev);
  // What the EXR says is how `display` shows it.
  EXPECT_EQ(abbe({"display", "a.exr", "-o", "c.png"}).exit_code, 0);
  EXPECT_EQ(bytes("a.png"), bytes("c.png"));
}

TEST_F(RenderTest, default_rig_and_camera_are_a_line_each) {
  write("dark.gltf", dark_scene());
  const Outcome run = abbe({"render", "dark.gltf", "-o", "a.exr", "--size", "16x9", "--spp", "1"});
  EXPECT_EQ(run.exit_code, 0);
  EXPECT_THAT(
      run.err,
      HasSubstr("abbe: note: the scene has no lamps and nothing around it: lit by a studio"));
  EXPECT_THAT(run.err, HasSubstr("abbe: note: the scene has no camera"));
  EXPECT_EQ(attribute<std::string>(read_exr_header(file("a.exr")), "abbe:camera"), "default");
}

// Between corners of that alpha, the weights round.
TEST_F(RenderTest, mask_at_its_cutoff_is_there_between_the_corners_too) {
  write("mask.gltf", mask_scene());
  const Outcome run = abbe(
      {"render", "mask.gltf", "-o", "a.exr", "--size", "16x16", "--spp", "16", "--rig", "none"});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  const Image image = read_exr(file("a.exr"));
  const std::size_t green = *image.channel_index("G");
  for (std::size_t i = green; i < image.pixels.size(); i += image.channel_count()) {
    EXPECT_NEAR(image.pixels[i], 1.0f, 0.01f);  // Of a dozen wavelengths' noise; a miss is 0.06.
  }
}

TEST_F(RenderTest, piped_render_says_only_the_summary) {
  const Outcome run = render({"-o", "a.exr"});
  EXPECT_THAT(run.out, IsEmpty());
  EXPECT_THAT(run.err, testing::MatchesRegex("abbe: rendered in [^\n]*rays/s: a.exr\n"));
  EXPECT_THAT(render({"-o", "a.exr", "--quiet"}).err, IsEmpty());
}

TEST_F(RenderTest, stats_hold_every_figure) {
  render({"-o", "a.exr", "--stats", "s.json", "--threads", "2"});
  const nlohmann::json stats = nlohmann::json::parse(bytes("s.json"));
  for (const char* name : {"load", "build", "render", "write", "total"}) {
    EXPECT_GE(stats.at("seconds").at(name).get<double>(), 0.0) << name;
  }
  EXPECT_EQ(stats.at("threads"), 2);
  EXPECT_EQ(stats.at("rays").at("camera"), 24 * 16 * 2);
  for (const char* name : {"reflected", "refracted", "shadow"}) {
    EXPECT_GT(stats.at("rays").at(name).get<std::uint64_t>(), 0u) << name;
  }
  EXPECT_GT(stats.at("fans").at("united").get<std::uint64_t>(), 0u);
  EXPECT_GT(stats.at("fans").at("spread").get<std::uint64_t>(), 0u);
  EXPECT_GT(stats.at("bytes").at("geometry").get<std::uint64_t>(), 0u);
  EXPECT_GT(stats.at("bytes").at("accelerator").get<std::uint64_t>(), 0u);
  EXPECT_GT(stats.at("bytes").at("peak_memory").get<std::uint64_t>(), 1u << 20);
  EXPECT_GT(stats.at("rays_per_second").get<double>(), 0.0);
  EXPECT_LE(stats.at("queue").at("peak_fans"), stats.at("queue").at("capacity"));
  EXPECT_LT(stats.at("energy_lost").at("depth").get<double>(), 0.01);
  EXPECT_EQ(stats.at("energy_lost").at("cutoff").get<double>(), 0.0);
}

TEST_F(RenderTest, samples_go_where_they_are_needed_unless_their_number_is_said) {
  const auto sampled = [this](Arguments more) {
    Arguments arguments{"render", "scene.gltf", "--size", "24x16",      "-o",
                        "a.exr",  "--stats",    "s.json", "--exposure", "1"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    const Outcome run = abbe(arguments);
    EXPECT_EQ(run.exit_code, 0) << run.err;
    return nlohmann::json::parse(bytes("s.json")).at("sampling");
  };
  const nlohmann::json plain = sampled({});
  EXPECT_EQ(plain.at("noise").at("target"), 1.5);
  EXPECT_GT(plain.at("noise").at("reached").get<double>(), 0.0);
  EXPECT_GE(plain.at("samples_per_pixel").get<double>(), 8.0);
  ExrHeader header = read_exr_header(file("a.exr"));
  EXPECT_EQ(attribute<double>(header, "abbe:noise"), 1.5);
  EXPECT_EQ(attribute<double>(header, "abbe:noiseExposure"), 1.0);
  EXPECT_EQ(attribute<int>(header, "abbe:samples"), 256);
  const nlohmann::json coarse = sampled({"--noise", "8", "--spp", "32", "--aov", "samples"});
  EXPECT_LT(coarse.at("samples").get<double>(), plain.at("samples").get<double>());
  EXPECT_TRUE(read_exr(file("a.exr")).channel_index("samples").has_value());
  EXPECT_EQ(sampled({"--spp", "3"}).at("samples"), 24 * 16 * 3);
  header = read_exr_header(file("a.exr"));
  EXPECT_FALSE(header.attributes.contains("abbe:noise"));
}

TEST_F(RenderTest, drop_loses_energy_and_reports_it) {
  render({"-o", "a.exr", "--stats", "s.json", "--drop", "--cutoff", "0.1"});
  const nlohmann::json stats = nlohmann::json::parse(bytes("s.json"));
  EXPECT_GT(stats.at("energy_lost").at("cutoff").get<double>(), 0.001);
}

}  // namespace
}  // namespace abbe::test
