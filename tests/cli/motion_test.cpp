/// Animated scenes: one time, and sequences of frames.
#include <gmock/gmock.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "abbe/image/exr/exr.h"
#include "program.h"

namespace abbe::test {
namespace {

using nlohmann::json;
using testing::ElementsAre;
using testing::HasSubstr;

/// A glowing ball of radius 0.5 that goes from x = 0 to x = 2 in 2 s, before a camera that sees
/// x = -0.5 to 3.5, a metre a pixel.
std::string moving_ball() {
  return R"({
  "asset": {"version": "2.0"},
  "extensionsUsed": ["ABBE_shape", "VENDOR_magic"],
  "scene": 0, "scenes": [{"nodes": [0, 1]}],
  "nodes": [{"mesh": 0}, {"camera": 0, "translation": [1.5, 0, 5]}],
  "cameras": [{"type": "orthographic",
               "orthographic": {"xmag": 2, "ymag": 0.5, "znear": 0.1, "zfar": 10}}],
  "materials": [{"emissiveFactor": [1, 1, 1]}],
  "meshes": [{"extensions": {"ABBE_shape": {"sphere": {"radius": 0.5}}},
              "primitives": [{"attributes": {"POSITION": 0}, "material": 0}]}],
  "animations": [{"name": "roll",
    "samplers": [{"input": 1, "output": 2}],
    "channels": [{"sampler": 0, "target": {"node": 0, "path": "translation"}}]}],
  "accessors": [
    {"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3"},
    {"bufferView": 1, "componentType": 5126, "count": 2, "type": "SCALAR", "min": [0], "max": [2]},
    {"bufferView": 2, "componentType": 5126, "count": 2, "type": "VEC3"}],
  "bufferViews": [{"buffer": 0, "byteLength": 36},
                  {"buffer": 0, "byteOffset": 36, "byteLength": 8},
                  {"buffer": 0, "byteOffset": 44, "byteLength": 24}],
  "buffers": [{"byteLength": 68, "uri": "data:application/octet-stream;base64,AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAAAAAAAAAAAEAAAAAAAAAAAAAAAAAAAABAAAAAAAAAAAA="}]
})";
}

class MotionTest : public ProgramTest {
 protected:
  MotionTest() { write("ball.gltf", moving_ball()); }

  /// Which of the four columns of a picture shine.
  std::vector<bool> columns(const std::string& name) const {
    const Image image = read_exr(file(name));
    const std::size_t green = *image.channel_index("G");
    std::vector<bool> shine;
    for (std::size_t x = 0; x < 4; ++x) {
      shine.push_back(image.pixels[x * image.channel_count() + green] > 0.25f);
    }
    return shine;
  }

  static Arguments with_small(Arguments arguments) {
    for (const char* more : {"--size", "4x1", "--spp", "4", "--filter", "box", "--rig", "none"}) {
      arguments.emplace_back(more);
    }
    return arguments;
  }
};

TEST_F(MotionTest, time_poses_the_scene_and_is_written_down) {
  ASSERT_EQ(abbe(with_small({"render", "ball.gltf", "-o", "rest.exr"})).exit_code, 0);
  EXPECT_THAT(columns("rest.exr"), ElementsAre(true, false, false, false));
  ASSERT_EQ(abbe(with_small({"render", "ball.gltf", "-o", "b.exr", "--time", "1"})).exit_code, 0);
  EXPECT_THAT(columns("b.exr"), ElementsAre(false, true, false, false));
  EXPECT_THAT(abbe({"inspect", "b.exr"}).out, HasSubstr("--time 1"));
}

TEST_F(MotionTest, frames_are_files_of_their_own) {
  const Outcome run = abbe(
      with_small({"render", "ball.gltf", "-o", "f.###.exr", "--frames", "9:11", "--fps", "5"}));
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_THAT(new_files(), ElementsAre("f.009.exr", "f.010.exr", "f.011.exr"));
  const std::string note = "VENDOR_magic";  // Said once.
  EXPECT_THAT(run.err, HasSubstr(note));
  EXPECT_EQ(run.err.find(note), run.err.rfind(note)) << run.err;
  ASSERT_EQ(abbe(with_small({"render", "ball.gltf", "-o", "t.exr", "--time", "2"})).exit_code, 0);
  // The same but for the exposure, which is that of the first frame.
  EXPECT_EQ(read_exr(file("f.010.exr")).pixels, read_exr(file("t.exr")).pixels);
  EXPECT_THAT(columns("f.010.exr"), ElementsAre(false, false, true, false));
  const auto exposure_of = [&](const char* name) {
    return read_exr(file(name)).attributes.at("abbe:exposure");
  };
  EXPECT_EQ(exposure_of("f.009.exr"), exposure_of("f.011.exr"));
}

// The camera turns half round about a white ball between frames 0 and 1: its studio stays.
TEST_F(MotionTest, frames_are_lit_by_what_was_chosen_for_the_first) {
  json scene = json::parse(moving_ball());
  scene["nodes"][0]["children"] = {1};
  scene["nodes"][1]["translation"] = {0, 0, 5};
  scene["materials"] = {{{"pbrMetallicRoughness", {{"metallicFactor", 0}}}}};
  scene["scenes"][0]["nodes"] = {0, 2};
  scene["nodes"].push_back({{"mesh", 0}});
  scene["nodes"][0].erase("mesh");
  // Of the ball's way: to (0, 1, 0) as the last three of four numbers, half a turn.
  scene["animations"][0]["samplers"][0]["output"] = 3;
  scene["animations"][0]["channels"][0]["target"]["path"] = "rotation";
  scene["accessors"].push_back(
      {{"bufferView", 3}, {"componentType", 5126}, {"count", 2}, {"type", "VEC4"}});
  scene["bufferViews"].push_back({{"buffer", 1}, {"byteLength", 32}});
  // 0, 0, 0, 1 and 0, 1, 0, 0.
  scene["buffers"].push_back(
      {{"byteLength", 32},
       {"uri",
        "data:application/octet-stream;base64,AAAAAAAAAAAAAAAAAACAPwAAAAAAAIA/AAAAAAAAAAA="}});
  write("turn.gltf", scene.dump());
  const auto render = [&](const Arguments& more) {
    Arguments all{"render", "turn.gltf", "--size", "32x18", "--spp", "16"};
    all.insert(all.end(), more.begin(), more.end());
    return abbe(all);
  };
  const Outcome run = render({"-o", "f.#.exr", "--frames", "0:1", "--fps", "0.5"});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  const std::string note = "lit by a studio";
  EXPECT_THAT(run.err, HasSubstr("as at 0 s, in all frames"));
  EXPECT_EQ(run.err.find(note), run.err.rfind(note)) << run.err;
  const auto brightest = [&](const char* name) {
    const Image image = read_exr(file(name));
    return *std::max_element(image.pixels.begin(), image.pixels.end());
  };
  // From behind, the ball shows the side that the key light does not reach.
  EXPECT_LT(brightest("f.1.exr"), 0.8f * brightest("f.0.exr"));
  const Outcome again = abbe({"inspect", "f.1.exr"});
  EXPECT_THAT(again.out, HasSubstr("--rig-time 0"));
  ASSERT_EQ(render({"-o", "t.exr", "--time", "2", "--rig-time", "0"}).exit_code, 0);
  EXPECT_EQ(read_exr(file("f.1.exr")).pixels, read_exr(file("t.exr")).pixels);
  ASSERT_EQ(render({"-o", "own.exr", "--time", "2"}).exit_code, 0);
  EXPECT_GT(brightest("own.exr"), 1.2f * brightest("f.1.exr"));
}

TEST_F(MotionTest, sequences_that_cannot_be_are_usage_errors) {
  const auto fails = [&](const Arguments& more, const std::string& part) {
    Arguments all{"render", "ball.gltf", "-o", "f.#.exr"};
    all.insert(all.end(), more.begin(), more.end());
    const Outcome run = abbe(all);
    EXPECT_EQ(run.exit_code, 2);
    EXPECT_THAT(run.err, HasSubstr(part));
  };
  fails({"--frames", "3"}, "--frames: found \"3\"");
  fails({"--frames", "3:2"}, "A at most B");
  fails({"--frames", "0:1", "--time", "1"}, "--time");
  fails({"--frames", "0:1", "--fps", "0"}, "--fps");
  fails({"--fps", "5"}, "--frames with it");
  fails({"--frames", "0:1", "-o", "same.exr"}, "-o: found \"same.exr\"");
  fails({"--frames", "0:1", "--stats", "same.json"}, "--stats: found \"same.json\"");
  fails({"--animation", "roll"}, "--animation");
  fails({"--time", "1", "--animation", "fall"}, "roll");
  EXPECT_TRUE(new_files().empty());
}

TEST_F(MotionTest, reference_image_of_a_posed_scene_is_made_again) {
  ASSERT_EQ(
      abbe(with_small({"golden", "make", "ball.gltf", "-o", "gold", "--time", "1"})).exit_code, 0);
  EXPECT_THAT(columns("gold/ball_spectral.exr"), ElementsAre(false, true, false, false));
  const Outcome run = abbe({"golden", "check", "gold"});
  EXPECT_EQ(run.exit_code, 0) << run.out << run.err;
}

TEST_F(MotionTest, inspect_lists_animations) {
  const json scene = parsed({"inspect", "ball.gltf", "--json"});
  EXPECT_EQ(scene.at("animations").at(0).at("name"), "roll");
  EXPECT_EQ(scene.at("animations").at(0).at("length_s"), 2.0);
}

}  // namespace
}  // namespace abbe::test
