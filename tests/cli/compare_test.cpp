// `abbe compare`: how far the modes are apart, why, and what is done again.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "abbe/image/exr/exr.h"
#include "cli/program.h"

namespace abbe::test {
namespace {

using testing::HasSubstr;
namespace fs = std::filesystem;

constexpr int kUsage = 2;
constexpr int kOutputFailed = 4;

std::string scene_file(const std::string& name) {
  return (fs::path(ABBE_SOURCE_DIR) / "scenes" / name / (name + ".gltf")).string();
}

class Compare : public ProgramTest {
 protected:
  // Runs into the folder "out" and reads its figures.
  nlohmann::json stats(Arguments arguments, double timeout_seconds = 300.0) const {
    arguments.insert(arguments.begin(), "compare");
    arguments.insert(arguments.end(), {"-o", "out", "--quiet"});
    const Outcome outcome = abbe(arguments, timeout_seconds);
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
    return nlohmann::json::parse(bytes("out/stats.json"));
  }
};

double share(const nlohmann::json& stats, const std::string& cause) {
  return stats["causes"][cause]["share"].get<double>();
}

// A grey ball, a ball of clear glass without dispersion, smoked glass, in daylight.
std::string neutral_scene() {
  return R"({
    "asset": {"version": "2.0"},
    "extensionsUsed": ["KHR_lights_punctual", "KHR_materials_ior", "KHR_materials_transmission",
                       "KHR_materials_volume", "ABBE_shape", "ABBE_scene"],
    "scene": 0,
    "scenes": [{"nodes": [0, 1, 2, 3, 4, 5],
                "extensions": {"ABBE_scene": {"ambient": {"luminance": 0.3,
                                                          "spectrum": "illuminant/D65"}}}}],
    "nodes": [
      {"mesh": 0, "translation": [-0.8, 0, 0]}, {"mesh": 1, "translation": [0, 0, 0.5]},
      {"mesh": 2, "translation": [0.8, 0, 0]}, {"mesh": 3, "translation": [0, -4, 0]},
      {"camera": 0, "translation": [0, 0.4, 3]},
      {"translation": [2, 4, 3], "extensions": {"KHR_lights_punctual": {"light": 0}}}],
    "cameras": [{"type": "perspective", "perspective": {"yfov": 0.7, "znear": 0.01}}],
    "extensions": {"KHR_lights_punctual": {"lights": [{"type": "point", "intensity": 80}]}},
    "materials": [
      {"pbrMetallicRoughness": {"baseColorFactor": [0.4, 0.4, 0.4, 1], "metallicFactor": 0,
                                "roughnessFactor": 0.5}},
      {"pbrMetallicRoughness": {"metallicFactor": 0, "roughnessFactor": 0},
       "extensions": {"KHR_materials_transmission": {"transmissionFactor": 1},
                      "KHR_materials_volume": {"thicknessFactor": 1}}},
      {"pbrMetallicRoughness": {"metallicFactor": 0, "roughnessFactor": 0},
       "extensions": {"KHR_materials_transmission": {"transmissionFactor": 1},
                      "KHR_materials_volume": {"thicknessFactor": 1, "attenuationDistance": 0.5,
                                               "attenuationColor": [0.4, 0.4, 0.4]}}},
      {"pbrMetallicRoughness": {"baseColorFactor": [0.7, 0.7, 0.7, 1], "metallicFactor": 1,
                                "roughnessFactor": 0}}],
    "meshes": [
      {"primitives": [{"attributes": {"POSITION": 0}, "material": 0}],
       "extensions": {"ABBE_shape": {"sphere": {"radius": 0.5}}}},
      {"primitives": [{"attributes": {"POSITION": 0}, "material": 1}],
       "extensions": {"ABBE_shape": {"sphere": {"radius": 0.4}}}},
      {"primitives": [{"attributes": {"POSITION": 0}, "material": 2}],
       "extensions": {"ABBE_shape": {"sphere": {"radius": 0.5}}}},
      {"primitives": [{"attributes": {"POSITION": 0}, "material": 3}],
       "extensions": {"ABBE_shape": {"sphere": {"radius": 3.4}}}}],
    "buffers": [{"byteLength": 36, "uri": "data:application/octet-stream;base64,AAAAAAAAAAAAAAAACtcjPAAAAAAAAAAAAAAAAArXIzwAAAAA"}],
    "bufferViews": [{"buffer": 0, "byteLength": 36}],
    "accessors": [{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3",
                   "min": [0, 0, 0], "max": [0.01, 0.01, 0]}]
  })";
}

TEST_F(Compare, neutral_scene_without_dispersion_is_the_same_in_all_modes) {
  write("neutral.gltf", neutral_scene());
  const nlohmann::json found = stats({"neutral.gltf", "--size", "64x36", "--spp", "4"});
  for (const char* mode : {"rgb", "rgb3"}) {
    const nlohmann::json& difference = found["difference"][mode]["delta_e2000"];
    // The promise is a mean of 0.1 and a maximum of 0.5.
    EXPECT_LT(difference["mean"].get<double>(), 0.1) << mode;
    EXPECT_LT(difference["max"].get<double>(), 0.5) << mode;
  }
  // Nothing acts, so nothing was rendered to find out.
  EXPECT_EQ(found["renders"]["rendered"], 3);
  for (const auto& cause : found["causes"]) EXPECT_FALSE(cause["acts"].get<bool>());
}

TEST_F(Compare, prism_differs_by_dispersion) {
  const nlohmann::json found = stats(
      {scene_file("prism"), "--size", "64x36", "--spp", "2", "--sweep", "wavelengths=4,8,16"});
  EXPECT_GT(found["difference"]["rgb"]["delta_e2000"]["mean"].get<double>(), 3.0);
  EXPECT_GE(share(found, "dispersion"), 0.9);  // The promise; measured 0.999.
  double sum = found["interaction"]["share"].get<double>();
  for (const auto& cause : found["causes"]) sum += cause["share"].get<double>();
  EXPECT_NEAR(sum, 1.0, 1e-6);  // Rounding: nothing is hidden.
  // More wavelengths are nearer to the most.
  const nlohmann::json& runs = found["sweeps"][0]["runs"];
  ASSERT_EQ(runs.size(), 2u);
  EXPECT_EQ(found["sweeps"][0]["finest"], 16);
  EXPECT_LT(runs[1]["delta_e2000"]["mean"].get<double>(),
            runs[0]["delta_e2000"]["mean"].get<double>());
  EXPECT_LT(runs[1]["rmse"].get<double>(), runs[0]["rmse"].get<double>());
  // The maps as numbers add up, pixel by pixel.
  const Image maps = read_exr(file("out/delta_e2000.exr"));
  for (int x = 0; x < maps.width; ++x) {
    const auto value = [&](const char* name) { return maps.at(x, 18, *maps.channel_index(name)); };
    EXPECT_NEAR(value("dispersion") + value("fresnel") + value("lamps") + value("uplift") +
                    value("interaction"),
                value("rgb"), 1e-4f)  // Single precision of values up to 80.
        << x;
  }
}

TEST_F(Compare, metamers_under_another_lamp_differ_by_lamp_and_uplift) {
  const nlohmann::json found = stats({scene_file("metamers"), "--lamp", "illuminant/A", "--size",
                                      "32x18", "--spp", "4", "--shapley"});
  EXPECT_GT(found["difference"]["rgb"]["delta_e2000"]["mean"].get<double>(), 1.0);
  EXPECT_GE(share(found, "lamps") + share(found, "uplift"), 0.9);  // The promise.
  EXPECT_FALSE(found["causes"]["dispersion"]["acts"].get<bool>());
}

TEST_F(Compare, deep_coloured_glass_differs_by_absorption) {
  const nlohmann::json found =
      stats({scene_file("coloured-glass"), "--size", "48x36", "--spp", "2"});
  EXPECT_GT(found["difference"]["rgb"]["delta_e2000"]["mean"].get<double>(), 0.3);
  EXPECT_GE(share(found, "absorption"), 0.9);  // The promise.
}

TEST_F(Compare, second_run_renders_only_what_has_changed) {
  const Arguments same{"scene.gltf", "--size", "16x9", "--spp", "1"};
  const nlohmann::json first = stats(same);
  const int all = first["renders"]["rendered"].get<int>();
  EXPECT_GT(all, 3);
  EXPECT_EQ(first["renders"]["reused"], 0);
  const std::string spectral = bytes("out/spectral.exr");

  nlohmann::json again = stats(same);
  EXPECT_EQ(again["renders"]["rendered"], 0);
  EXPECT_EQ(again["renders"]["reused"], all);
  EXPECT_EQ(again["difference"], first["difference"]);
  EXPECT_EQ(again["modes"]["rgb"]["seconds"], first["modes"]["rgb"]["seconds"]);

  // An exposure changes the pictures, not the renders.
  Arguments brighter = same;
  brighter.insert(brighter.end(), {"--exposure", "1"});
  again = stats(brighter);
  EXPECT_EQ(again["renders"]["rendered"], 0);
  EXPECT_NE(again["difference"], first["difference"]);

  // More wavelengths change what has wavelengths.
  Arguments finer = same;
  finer.insert(finer.end(), {"--wavelengths", "12"});
  EXPECT_EQ(stats(finer)["renders"]["reused"], 2);  // rgb and rgb3

  // A scene that has changed, or a broken file, is rendered again.
  std::string scene = bytes("scene.gltf");
  scene.replace(scene.find("100"), 3, "101");
  write("scene.gltf", scene);
  EXPECT_EQ(stats(same)["renders"]["reused"], 0);
  write("out/rgb.exr", "broken");
  EXPECT_EQ(stats(same)["renders"]["rendered"], 1);
  Arguments fresh = same;
  fresh.emplace_back("--fresh");
  EXPECT_EQ(stats(fresh)["renders"]["reused"], 0);
}

TEST_F(Compare, renders_are_those_of_abbe_render) {
  stats({"scene.gltf", "--size", "16x9", "--spp", "2"});
  ASSERT_EQ(abbe({"render", "scene.gltf", "-o", "rgb.exr", "--size", "16x9", "--spp", "2", "--mode",
                  "rgb", "--quiet"})
                .exit_code,
            0);
  EXPECT_EQ(read_exr(file("rgb.exr")).pixels, read_exr(file("out/rgb.exr")).pixels);
}

TEST_F(Compare, quick_look_is_small_unless_asked_otherwise) {
  EXPECT_EQ(stats({"scene.gltf", "--quick"})["size"][0], 160);
  EXPECT_EQ(stats({"scene.gltf", "--quick", "--size", "20x10"})["size"],
            (std::vector<int>{20, 10}));
}

TEST_F(Compare, page_and_pictures_are_written) {
  stats({"scene.gltf", "--size", "16x9", "--spp", "1", "--crop", "4,2,12,8"});
  for (const char* name : {"index.html", "rgb.png", "rgb3.png", "spectral.png", "map-rgb.png",
                           "map-dispersion.png", "causes"}) {
    EXPECT_TRUE(fs::exists(file("out") / name)) << name;
  }
  const std::string page = bytes("out/index.html");
  EXPECT_THAT(page, HasSubstr("\"spectral\": \"data:image/png;base64,"));
  EXPECT_THAT(page, testing::ContainsRegex("\"origin\": .[ \n]*4,[ \n]*2"));
}

TEST_F(Compare, wrong_use_is_said_before_anything_is_rendered) {
  const auto code_of = [this](Arguments arguments) {
    arguments.insert(arguments.begin(), {"compare", "scene.gltf", "-o", "out"});
    const Outcome outcome = abbe(arguments);
    EXPECT_TRUE(is_one_error_line(outcome.err)) << outcome.err;
    return outcome.exit_code;
  };
  EXPECT_EQ(code_of({"--mode", "rgb"}), kUsage);
  EXPECT_EQ(code_of({"--lines", "500"}), kUsage);
  EXPECT_EQ(code_of({"--range", "400:700"}), kUsage);
  EXPECT_EQ(code_of({"--sweep", "depth=1,2"}), kUsage);
  EXPECT_EQ(code_of({"--sweep", "spp=4"}), kUsage);
  EXPECT_EQ(code_of({"--sweep", "wavelengths=16,100"}), kUsage);
  EXPECT_FALSE(fs::exists(file("out")));
  write("out", "a file, no folder");
  EXPECT_EQ(code_of({"--quick"}), kOutputFailed);
}

TEST_F(Compare, more_wavelengths_than_frozen_ones_can_be_still_compare) {
  const nlohmann::json found =
      stats({"scene.gltf", "--size", "16x9", "--spp", "1", "--wavelengths", "64"});
  EXPECT_GT(share(found, "dispersion"), 0.0);
}

}  // namespace
}  // namespace abbe::test
