/// `abbe inspect` and `abbe spectra`: what is understood of files.
#include <gmock/gmock.h>

#include <cmath>
#include <cstdlib>
#include <nlohmann/json.hpp>

#include "program.h"
#include "scenes.h"

namespace abbe::test {
namespace {

using nlohmann::json;
using testing::HasSubstr;

using InspectTest = ProgramTest;

TEST_F(InspectTest, scene_as_json_says_what_it_holds) {
  const json scene = parsed({"inspect", "scene.gltf", "--json"});
  EXPECT_EQ(scene.at("scene"), "stage");
  EXPECT_EQ(scene.at("rig"), "none");
  EXPECT_EQ(scene.at("cameras").at(0).at("name"), "eye");
  EXPECT_EQ(scene.at("cameras").at(0).at("projection"), "perspective");
  EXPECT_NEAR(scene.at("cameras").at(0).at("yfov_deg").get<double>(), 40.107, 1e-3);  // 0.7 rad
  EXPECT_EQ(scene.at("lights").at(0).at("intensity_cd"), 100.0);
  EXPECT_EQ(scene.at("lights").at(0).at("spectrum"), "illuminant/D65");
  EXPECT_EQ(scene.at("shapes").size(), 2u);
  const json& flint = scene.at("materials").at(0);
  EXPECT_EQ(flint.at("glass"), "glass/schott/N-SF11");
  EXPECT_NEAR(flint.at("n_d").get<double>(), 1.78472, 5e-6);  // As catalogued, five decimals.
  EXPECT_NEAR(flint.at("V_d").get<double>(), 25.68, 5e-3);    // As catalogued, two decimals.
  const json& low = scene.at("bounds").at("low_m");
  EXPECT_NEAR(low.at(2).get<double>(), -9.0, 1e-5);  // Floats, rounded outwards.
}

TEST_F(InspectTest, what_shines_and_the_environment_are_named_beside_the_lamps) {
  json shining = json::parse(small_scene());
  shining["materials"][1]["emissiveFactor"] = {1, 1, 1};
  write("shining.gltf", shining.dump());
  json scene = parsed({"inspect", "shining.gltf", "--json"});
  EXPECT_EQ(scene.at("emitters").at(0).at("name"), "red");
  EXPECT_EQ(scene.at("emitters").at(0).at("lights_others"), false);
  EXPECT_EQ(scene.at("emitters").at(0).at("because"), "the file has lamps of its own");
  EXPECT_FALSE(scene.contains("environment"));
  scene =
      parsed({"inspect", "shining.gltf", "--emissive-light", "on", "--rig", "surround", "--json"});
  EXPECT_EQ(scene.at("emitters").at(0).at("lights_others"), true);
  EXPECT_EQ(scene.at("emitters").at(0).at("because"), "--emissive-light on");
  EXPECT_EQ(scene.at("environment").at("spectrum"), "RGB, as a metamer under illuminant/D65");
}

// Its exporter writes lamps as 683 lm per W, and leaves images of the world as they are.
TEST_F(InspectTest, environment_beside_lamps_of_blender_is_in_watts) {
  ASSERT_EQ(
      abbe({"render", "scene.gltf", "--size", "8x4", "--spp", "1", "-o", "sky.exr"}).exit_code, 0);
  const auto scale_of = [&](const Arguments& more) {
    Arguments arguments{"inspect", "scene.gltf", "--environment", "sky.exr", "--json"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return parsed(arguments).at("environment").at("scale").get<double>();
  };
  EXPECT_EQ(scale_of({}), 1.0);
  json blender = json::parse(small_scene());
  blender["asset"]["generator"] = "Khronos glTF Blender I/O v4.2.60";
  write("scene.gltf", blender.dump());
  EXPECT_EQ(scale_of({}), 683.0);
  EXPECT_EQ(scale_of({"--environment-scale", "5"}), 5.0);
  const json turned = parsed({"inspect", "scene.gltf", "--environment", "sky.exr",
                              "--environment-rotation", "90", "--json"});
  EXPECT_EQ(turned.at("environment").at("rotation_deg"), 90.0);
}

TEST_F(InspectTest, formula_beyond_its_range_and_rough_surface_are_noted) {
  const json scene = parsed({"inspect", "scene.gltf", "--json"});
  const std::string notes = scene.at("notes").dump();
  EXPECT_THAT(notes, HasSubstr("stated for 370-2500 nm; extrapolated at 360-370 nm"));
  EXPECT_THAT(notes, HasSubstr("a blurred reflection of what is around it only where"));
  EXPECT_THAT(notes, HasSubstr("material red"));
}

TEST_F(InspectTest, what_is_ignored_is_noted) {
  std::string text = small_scene();
  const std::string used = "\"ABBE_material\",";
  text.replace(text.find(used), used.size(), "\"ABBE_material\", \"VENDOR_magic\",");
  write("vendor.gltf", text);
  const json scene = parsed({"inspect", "vendor.gltf", "--json"});
  EXPECT_THAT(scene.at("notes").dump(), HasSubstr("VENDOR_magic"));
}

TEST_F(InspectTest, text_names_the_same_things) {
  const Outcome run = abbe({"inspect", "scene.gltf"});
  EXPECT_EQ(run.exit_code, 0);
  for (const char* text : {"eye, projection perspective", "glass glass/schott/N-SF11",
                           "n_d 1.78472", "intensity_cd 100", "ball, shape sphere"}) {
    EXPECT_THAT(run.out, HasSubstr(text));
  }
}

TEST_F(InspectTest, exr_tells_its_provenance_and_channels) {
  const Outcome render = abbe({"render", "scene.gltf", "-o", "a.exr", "--size", "8x8", "--spp", "1",
                               "--bands", "400:700:50"});
  ASSERT_EQ(render.exit_code, 0) << render.err;
  const json image = parsed({"inspect", "a.exr", "--json"});
  EXPECT_EQ(image.at("size"), json::array({8, 8}));
  EXPECT_EQ(image.at("channels").size(), 9u);
  EXPECT_EQ(image.at("spectral_channels_nm").size(), 6u);
  EXPECT_EQ(image.at("attributes").at("abbe:mode"), "spectral");
  EXPECT_EQ(image.at("attributes").at("abbe:complete"), 1);
  const Outcome text = abbe({"inspect", "a.exr"});
  EXPECT_THAT(text.out, HasSubstr("spectral_channels_nm: 6, 425.0 to 675.0"));
  EXPECT_THAT(text.out, HasSubstr("abbe:bands: 400:700:50 nm"));
}

TEST_F(InspectTest, hostile_names_reach_the_terminal_without_control_characters) {
  std::string text = small_scene();
  const std::string name = "\"ball\"";
  text.replace(text.find(name), name.size(), R"("ball\u001b[2J")");
  write("escape.gltf", text);
  EXPECT_EQ(abbe({"inspect", "escape.gltf"}).out.find('\x1b'), std::string::npos);
  EXPECT_EQ(abbe({"probe", "escape.gltf", "--size", "9x9", "--pixel", "4,4"}).out.find('\x1b'),
            std::string::npos);
}

TEST_F(InspectTest, spectra_are_listed_and_shown) {
  EXPECT_GE(parsed({"spectra", "list", "--json"}).size(), 100u);
  const json glass = parsed({"spectra", "show", "N-BK7", "--json"});
  EXPECT_EQ(glass.at("id"), "glass/schott/N-BK7");
  EXPECT_NEAR(glass.at("n_d").get<double>(), 1.5168, 5e-6);  // As catalogued.
  EXPECT_THAT(glass.at("source").get<std::string>(), HasSubstr("SCHOTT"));
  EXPECT_THAT(abbe({"spectra", "list"}).out, HasSubstr("glass/schott/N-SF11"));
  EXPECT_THAT(abbe({"spectra", "show", "Au-Johnson"}).out, HasSubstr("Johnson"));
}

// Renders with some options, and again by the command that inspect prints.
class ReproduceTest : public ProgramTest {
 protected:
  void expect_same_bytes_again(const Arguments& options) const {
    Arguments arguments{"render", "scene.gltf", "-o", "a.exr", "--size", "30x20", "--spp", "2"};
    arguments.insert(arguments.end(), options.begin(), options.end());
    const Outcome run = abbe(arguments);
    ASSERT_EQ(run.exit_code, 0) << run.err;
    const Outcome inspect = abbe({"inspect", "a.exr", "--json"});
    ASSERT_EQ(inspect.exit_code, 0) << inspect.err;
    std::string command = nlohmann::json::parse(inspect.out)["command"];
    const auto replace = [&command](const std::string& what, const std::string& by) {
      const std::size_t at = command.find(what);
      if (at != std::string::npos) command.replace(at, what.size(), by);
    };
    replace("abbe render SCENE -o OUT.exr",
            std::string(ABBE_PROGRAM) + " render scene.gltf -o b.exr");
    replace("FILE.csv", "camera.csv");
    command = "cd '" + folder().string() + "' && " + command + " --quiet";
    ASSERT_EQ(std::system(command.c_str()), 0) << command;
    EXPECT_EQ(bytes("a.exr"), bytes("b.exr")) << command;
  }
};

TEST_F(ReproduceTest, command_of_a_plain_render_makes_the_same_bytes) {
  expect_same_bytes_again({});
}

TEST_F(ReproduceTest, command_of_an_elaborate_render_makes_the_same_bytes) {
  expect_same_bytes_again({"--bands",       "400:700:12.5",
                           "--range",       "390:710.5",
                           "--aov",         "Z,objectId,direct,spectralAlbedo",
                           "--wavelengths", "12",
                           "--filter",      "mitchell",
                           "--depth",       "5",
                           "--cutoff",      "0.0123",
                           "--seed",        "7",
                           "--crop",        "3,2,21,17",
                           "--camera",      "eye",
                           "--half",        "--multipart",
                           "--tiles",       "16",
                           "--compression", "zips"});
}

TEST_F(ReproduceTest, command_of_another_observer_white_and_space_makes_the_same_bytes) {
  expect_same_bytes_again({"--observer", "cie1964", "--white", "0.31234567,0.33", "--adaptation",
                           "bradford", "--colorspace", "Linear Rec.2020"});
  expect_same_bytes_again({"--white", "scene", "--drop", "--mode", "rgb3"});
  expect_same_bytes_again({"--lines", "486.1327,587.5618", "--white", "A"});
}

TEST_F(ReproduceTest, command_of_a_camera_asks_for_its_file) {
  std::string csv = "nm,r,g,b\n";
  for (int nm = 380; nm <= 780; nm += 20) {
    csv += std::to_string(nm);
    for (const double center : {600.0, 540.0, 460.0}) {
      csv += "," + std::to_string(std::exp(-0.5 * std::pow((nm - center) / 40.0, 2.0)));
    }
    csv += "\n";
  }
  write("camera.csv", csv);
  expect_same_bytes_again({"--observer", "camera.csv"});
  const Outcome inspect = abbe({"inspect", "a.exr"});
  EXPECT_THAT(inspect.out, testing::HasSubstr("csv:"));
  EXPECT_THAT(inspect.out, testing::Not(testing::HasSubstr("camera.csv")));
}

TEST_F(ReproduceTest, files_of_others_and_developed_anew_have_no_command) {
  ASSERT_EQ(abbe({"render", "scene.gltf", "-o", "a.exr", "--size", "8x8", "--spp", "1", "--bands",
                  "400:700:50"})
                .exit_code,
            0);
  ASSERT_EQ(abbe({"display", "a.exr", "-o", "b.exr", "--white", "A"}).exit_code, 0);
  const auto developed = nlohmann::json::parse(abbe({"inspect", "b.exr", "--json"}).out);
  EXPECT_FALSE(developed.contains("command"));
  EXPECT_EQ(developed["attributes"]["abbe:white"], "illuminant/A");
}

}  // namespace
}  // namespace abbe::test
