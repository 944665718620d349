/// Wrong usage: exit code 2, one line that names what is wrong, and nothing left behind.
#include <gmock/gmock.h>

#include <algorithm>

#include "program.h"

namespace abbe::test {
namespace {

using testing::HasSubstr;
using testing::IsEmpty;

constexpr int kUsage = 2;

struct WrongUsage {
  const char* name;
  Arguments arguments;  ///< Behind `abbe`.
  const char* says;
};

class WrongUsageTest : public ProgramTest, public testing::WithParamInterface<WrongUsage> {};

TEST_P(WrongUsageTest, is_exit_code_2_and_one_line) {
  const Outcome run = abbe(GetParam().arguments);
  EXPECT_EQ(run.exit_code, kUsage);
  EXPECT_TRUE(is_one_error_line(run.err));
  EXPECT_THAT(run.err, HasSubstr(GetParam().says));
  EXPECT_THAT(run.out, IsEmpty());
  EXPECT_THAT(new_files(), IsEmpty());
}

Arguments render_with(const Arguments& more) {
  Arguments arguments{"render", "scene.gltf", "-o", "a.exr"};
  arguments.insert(arguments.end(), more.begin(), more.end());
  return arguments;
}

const WrongUsage kWrong[] = {
    {"no_command", {}, "one of render, display"},
    {"unknown_command", {"rendre"}, "\"rendre\""},
    {"no_scene", {"render"}, "SCENE is required"},
    {"no_output", {"render", "scene.gltf"}, "--output is required"},
    {"two_scenes", render_with({"b.gltf"}), "\"b.gltf\""},
    {"unknown_option", render_with({"--sppp", "4"}), "--spp"},
    {"caustics", render_with({"--caustics", "soft"}),
     "--caustics: found \"soft\", expected a way to follow light (one of exact, off)"},
    {"empty_lines", render_with({"--lines", ""}), "--lines: found \"\", expected A,B,C"},
    {"empty_environment", render_with({"--environment", ""}), "--environment: found \"\""},
    {"negative_environment_scale",
     render_with({"--environment", "sky.exr", "--environment-scale", "-2"}),
     "--environment-scale: found -2, expected a number of at least 0"},
    {"environment_scale_alone", render_with({"--environment-scale", "2"}),
     "--environment-scale: found 2, expected an --environment with it"},
    {"environment_rotation_alone", render_with({"--environment-rotation", "90"}),
     "--environment-rotation: found 90, expected an --environment with it"},
    {"empty_output", {"render", "scene.gltf", "-o", ""}, "found \"\", expected FILE"},
    {"stats_over_the_image", render_with({"--stats", "./a.exr"}),
     "-o: found \"a.exr\", the file of --stats, expected another"},
    {"stats_over_the_scene", render_with({"--stats", "scene.gltf"}),
     "--stats: found \"scene.gltf\", the file of SCENE"},
    {"image_over_the_environment",
     {"render", "scene.gltf", "--environment", "sky.exr", "-o", "./sky.exr"},
     "the file of --environment"},
    {"scene_unknown", render_with({"--scene", "nosuch"}), "(one of stage)"},
    {"scene_of_no_such_number", render_with({"--scene", "7"}), "(one of stage)"},
    {"chain", render_with({"--chain", "21"}), "--chain: found 21, expected a number from 0 to 20"},
    {"accel_unknown", render_with({"--accel", "bvh"}),
     "--accel: found \"bvh\", expected an accelerator (one of kdtree, brute)"},
    {"lamp_unknown", render_with({"--lamp", "nosuch"}), "\"nosuch\""},
    {"lamp_that_is_a_glass", render_with({"--lamp", "N-BK7"}), "a lamp"},
    {"option_without_value", render_with({"--spp"}), "--spp"},
    {"option_twice", render_with({"--spp", "1", "--spp", "2"}), "--spp"},
    {"no_number", render_with({"--spp", "many"}), "\"many\""},
    {"number_with_tail", render_with({"--spp", "4x"}), "\"4x\""},
    {"noise_0", render_with({"--noise", "0"}), "a number above 0"},
    {"noise_of_too_few", render_with({"--noise", "1", "--spp", "4"}), "from 8 to"},
    {"spp_0", render_with({"--spp", "0"}), "from 1 to"},
    {"nan", render_with({"--cutoff", "nan"}), "--cutoff"},
    {"negative_seed", render_with({"--seed", "-1"}), "--seed"},
    {"size_without_height", render_with({"--size", "10"}), "WxH"},
    {"size_0", render_with({"--size", "0x10"}), "--size"},
    {"mode", render_with({"--mode", "cmyk"}), "rgb3"},
    {"filter", render_with({"--filter", "sinc"}), "mitchell"},
    {"range_reversed", render_with({"--range", "700:400"}), "--range"},
    {"range_outside", render_with({"--range", "100:400"}), "--range"},
    {"lines_in_rgb", render_with({"--mode", "rgb", "--lines", "500"}), "--lines"},
    {"bands_in_rgb", render_with({"--mode", "rgb3", "--bands", "400:700:10"}), "--bands"},
    {"lines_and_bands", render_with({"--lines", "500", "--bands", "400:700:10"}), "--lines"},
    {"bands", render_with({"--bands", "400:700"}), "--bands"},
    {"wavelengths", render_with({"--wavelengths", "65"}), "1 to 64"},
    {"aov_unknown", render_with({"--aov", "Z,depth"}), "objectId"},
    {"aov_twice", render_with({"--aov", "Z,P,Z"}), "--aov: found Z twice"},
    {"aov_empty", render_with({"--aov", "Z,,P"}), "--aov: found \"\""},
    {"crop_outside", render_with({"--size", "8x8", "--crop", "0,0,9,8"}), "--crop"},
    {"crop_empty", render_with({"--size", "8x8", "--crop", "4,4,4,8"}), "--crop"},
    {"camera", render_with({"--camera", "none"}), "eye"},
    {"camera_number", render_with({"--camera", "#1"}), "eye"},
    {"scene_name", render_with({"--scene", "none"}), "stage"},
    {"scene_option", render_with({"--scene", "none"}), "--scene: found \"none\""},
    {"colorspace", render_with({"--colorspace", "sRGB?"}), "ACEScg"},
    {"display", render_with({"-o", "b.png", "--display", "tv"}), "sRGB - Display"},
    {"view", render_with({"-o", "b.png", "--view", "tv"}), "Un-tone-mapped"},
    {"view_that_shows_nothing", render_with({"--view", "tv"}), "Un-tone-mapped"},
    {"exposure", render_with({"--exposure", "bright"}), "auto"},
    {"suffix", {"render", "scene.gltf", "-o", "a.bmp"}, ".exr, .png"},
    {"no_suffix", {"render", "scene.gltf", "-o", "a"}, ".exr, .png"},
    {"same_output_twice", render_with({"-o", "./a.exr"}), "twice"},
    {"display_to_exr", {"display", "a.exr", "-o", "b.exr"}, ".png"},
    {"pixel_missing", {"probe", "scene.gltf"}, "--pixel is required"},
    {"pixel_outside", {"probe", "scene.gltf", "--size", "8x8", "--pixel", "8,0"}, "0,0 to 7,7"},
    {"pixel_text", {"probe", "scene.gltf", "--pixel", "middle"}, "X,Y"},
};

INSTANTIATE_TEST_SUITE_P(usage, WrongUsageTest, testing::ValuesIn(kWrong),
                         [](const auto& tested) { return std::string(tested.param.name); });

using UsageTest = ProgramTest;

TEST_F(UsageTest, help_of_every_command_is_on_stdout) {
  const Outcome program = abbe({"--help"});
  EXPECT_EQ(program.exit_code, 0);
  for (const char* command : {"render", "display", "inspect", "probe", "spectra"}) {
    EXPECT_THAT(program.out, HasSubstr(command));
    const Outcome run = abbe({command, "--help"});
    EXPECT_EQ(run.exit_code, 0);
    EXPECT_THAT(run.out, HasSubstr("Usage: abbe " + std::string(command)));
    EXPECT_THAT(run.err, IsEmpty());
  }
}

TEST_F(UsageTest, help_of_render_states_the_defaults) {
  const std::string help = abbe({"render", "--help"}).out;
  for (const char* text : {"default: spectral", "default: 1.5, at most 256 samples",
                           "1 to 64 (default: 16)", "may leave (default: 16)", "(default: 0.02)",
                           "(default: gaussian)", "sRGB - Display", "ACES 1.0 - SDR Video"}) {
    EXPECT_THAT(help, HasSubstr(text));
  }
}

TEST_F(UsageTest, version_is_one_line_on_stdout) {
  const Outcome run = abbe({"--version"});
  EXPECT_EQ(run.exit_code, 0);
  EXPECT_EQ(run.out, "abbe " ABBE_VERSION "\n");
}

class StartTest : public ProgramTest {};

// A third of a second of every call would go into libraries that few calls need.
TEST_F(StartTest, program_stands_on_few_libraries) {
  set_environment("LD_TRACE_LOADED_OBJECTS", "1");  // The loader lists them instead of starting it.
  const std::string libraries = abbe({"--version"}).out;
  EXPECT_THAT(libraries, HasSubstr("libc.so"));
  EXPECT_THAT(libraries, testing::Not(HasSubstr("OpenImageIO")));
  EXPECT_LT(std::count(libraries.begin(), libraries.end(), '\n'), 40);
}

}  // namespace
}  // namespace abbe::test
