/// Spectra that users bring along, and colours of wider gamuts, through the program.
#include <gmock/gmock.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "abbe/image/exr/exr.h"
#include "program.h"

namespace abbe::test {
namespace {

using nlohmann::json;
using testing::HasSubstr;
using testing::Not;

constexpr const char* kAgf =
    "NM GREY 1 0 1.5 99\nCD 2.25\nLD 0.3 1\nIT 0.4 0.5 10\nIT 0.7 0.5 10\n";

// A pane of 10 mm before a wall that shines white, seen head-on. `material` is the pane's.
std::string pane(const json& material, const json& scene_extension = nullptr) {
  json document = json::parse(R"({
    "asset": {"version": "2.0"},
    "extensionsUsed": ["ABBE_material", "ABBE_shape", "ABBE_scene", "KHR_materials_unlit"],
    "scene": 0,
    "scenes": [{"nodes": [0, 1, 2]}],
    "nodes": [{"mesh": 0}, {"mesh": 1, "translation": [0, 0, -1]},
              {"camera": 0, "translation": [0, 0, 1]}],
    "cameras": [{"type": "orthographic",
                 "orthographic": {"xmag": 0.1, "ymag": 0.1, "znear": 0.01, "zfar": 10}}],
    "accessors": [{"componentType": 5126, "count": 3, "type": "VEC3",
                   "min": [0, 0, 0], "max": [0, 0, 0]}],
    "meshes": [
      {"primitives": [{"attributes": {"POSITION": 0}, "material": 0}],
       "extensions": {"ABBE_shape": {"convex": {"planes": [[1, 0, 0, 1], [-1, 0, 0, 1],
         [0, 1, 0, 1], [0, -1, 0, 1], [0, 0, 1, 0.005], [0, 0, -1, 0.005]]}}}},
      {"primitives": [{"attributes": {"POSITION": 0}, "material": 1}],
       "extensions": {"ABBE_shape": {"convex": {"planes": [[1, 0, 0, 9], [-1, 0, 0, 9],
         [0, 1, 0, 9], [0, -1, 0, 9], [0, 0, 1, 0.1], [0, 0, -1, 0.1]]}}}}],
    "materials": [{"name": "pane"},
      {"name": "wall", "extensions": {"KHR_materials_unlit": {}},
       "pbrMetallicRoughness": {"baseColorFactor": [1, 1, 1, 1]}}]
  })");
  document["materials"][0]["extensions"]["ABBE_material"] = material;
  if (!scene_extension.is_null()) {
    document["scenes"][0]["extensions"]["ABBE_scene"] = scene_extension;
  }
  return document.dump();
}

class LibraryTest : public ProgramTest {
 protected:
  std::vector<float> pixel(const std::string& scene, const Arguments& more = {}) const {
    write("library.gltf", scene);
    // What passes the pane is the wall's light alone: no studio that its faces would reflect.
    // All ways to and fro, none by chance.
    Arguments arguments{"render", "library.gltf", "-o", "out.exr", "--size", "2x2",    "--cutoff",
                        "1e-4",   "--spp",        "1",  "--rig",   "none",   "--quiet"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    const Outcome run = abbe(arguments);
    EXPECT_EQ(run.exit_code, 0) << run.err;
    const Image image = read_exr(file("out.exr"));
    std::vector<float> values;
    for (const char* name : {"R", "G", "B"}) {
      values.push_back(image.pixels.at(image.channel_index(name).value()));
    }
    return values;
  }
  void bring(const std::string& name, const std::string& text) {
    std::filesystem::create_directories(file("spectra"));
    write("spectra/" + name, text);
    set_environment("ABBE_SPECTRA_PATH", file("spectra").string());
  }
};

TEST_F(LibraryTest, transmittance_of_a_zemax_glass_reaches_the_image) {
  bring("mine.agf", kAgf);
  // R = 0.04 at both faces, half the light absorbed on each way through, and all ways to and fro.
  const double R = 0.04, t = 0.5;
  const double expected = (1.0 - R) * (1.0 - R) * t / (1.0 - R * R * t * t);
  write("other.agf", kAgf);
  for (const char* glass : {"mine/GREY", "GREY", "other.agf#GREY"}) {
    for (const float value : pixel(pane({{"dispersion", {{"glass", glass}}}}))) {
      EXPECT_NEAR(value, expected, 1e-4) << glass;  // white is 1 to single precision's sums
    }
  }
}

TEST_F(LibraryTest, formula_of_refractiveindex_info_reaches_the_image) {
  bring("mine.yml",
        "DATA:\n  - type: formula 5\n    wavelength_range: 0.3 1\n    coefficients: 2 0 -2\n");
  // n = 2: R = 1/9, and all ways to and fro: (1 − R)/(1 + R).
  for (const float value : pixel(pane({{"dispersion", {{"glass", "mine"}}}}))) {
    EXPECT_NEAR(value, 0.8, 1e-4);
  }
}

TEST_F(LibraryTest, plain_table_is_an_id_and_an_absorption) {
  bring("absorption/ink.csv", "");
  std::filesystem::create_directories(file("spectra/absorption"));
  bring("absorption/ink.csv", "400,69.314718\n700,69.314718\n");
  const double R = 0.04, t = 0.5;
  const double expected = (1.0 - R) * (1.0 - R) * t / (1.0 - R * R * t * t);
  const json clear = {{"sellmeier", {{"A", 1.25}, {"B", {0.0}}, {"C", {0.0}}}}};
  for (const float value : pixel(pane({{"dispersion", clear}, {"absorption", "ink"}}))) {
    EXPECT_NEAR(value, expected, 1e-4);
  }
  EXPECT_EQ(parsed({"spectra", "show", "ink", "--json"}).at("quantity"), "absorption");
}

TEST_F(LibraryTest, broken_file_is_a_warning_that_names_it) {
  bring("broken.agf", "no glass\n");
  bring("unsorted.csv", "nm,reflectance\n500,0.1\n400,0.1\n");
  bring("paint.csv", "nm,reflectance\n400,0.1\n700,0.1\n");
  const Outcome list = abbe({"spectra", "list", "--kind", "reflectance", "--json"});
  EXPECT_EQ(list.exit_code, 0);
  EXPECT_THAT(list.err, HasSubstr("broken.agf"));
  EXPECT_THAT(list.err, HasSubstr("unsorted.csv"));
  EXPECT_THAT(list.out, HasSubstr("\"paint\""));
  const Outcome render =
      abbe({"render", "scene.gltf", "-o", "a.exr", "--size", "2x2", "--spp", "1"});
  EXPECT_EQ(render.exit_code, 0);
  EXPECT_THAT(render.err, HasSubstr("broken.agf"));
  EXPECT_THAT(abbe({"spectra", "show", "unsorted"}).err, HasSubstr("line 3"));
}

TEST_F(LibraryTest, show_and_plot_take_files) {
  write("mine.csv", "nm,reflectance\n400,0.2\n700,0.8\n");
  write("mine.agf", kAgf);
  EXPECT_EQ(
      parsed({"spectra", "show", "mine.csv", "--at", "550", "--json"}).at("at").at(0).at("value"),
      0.5);
  const json glass = parsed({"spectra", "show", "mine.agf", "--at", "550", "--json"});
  EXPECT_NEAR(glass.at("n_d").get<double>(), 1.5, 1e-12);
  EXPECT_NEAR(glass.at("at").at(0).at("absorption_per_m").get<double>(), 69.3147, 1e-3);
  EXPECT_THAT(abbe({"spectra", "plot", "./mine.csv"}).out, HasSubstr("<polyline"));
  EXPECT_EQ(abbe({"spectra", "show", "missing.csv"}).exit_code, 3);
}

TEST_F(LibraryTest, show_of_a_lamp_gives_its_colour_rendering) {
  const json lamp = parsed({"spectra", "show", "FL2", "--json"});
  EXPECT_NEAR(lamp.at("CRI_Ra").get<double>(), 64.2, 0.2);
  EXPECT_EQ(lamp.at("CRI_R").size(), 14u);
  EXPECT_GT(parsed({"spectra", "show", "daylight/5600", "--json"}).at("CRI_Ra").get<double>(),
            99.0);
  // Two lines show no colours at all.
  EXPECT_LT(parsed({"spectra", "show", "lamp/sodium", "--json"}).at("CRI_Ra").get<double>(), -40.0);
}

TEST_F(LibraryTest, lamps_that_a_number_makes_light_a_scene) {
  for (const char* lamp : {"daylight/5000", "blackbody/2856", "lamp/mercury"}) {
    const Outcome run = abbe({"render", "scene.gltf", "-o", "a.exr", "--size", "2x2", "--spp", "1",
                              "--lamp", lamp, "--quiet"});
    EXPECT_EQ(run.exit_code, 0) << run.err;
    EXPECT_EQ(parsed({"inspect", "a.exr", "--json"}).at("attributes").at("abbe:lamp"), lamp);
  }
  EXPECT_EQ(abbe({"render", "scene.gltf", "-o", "a.exr", "--lamp", "daylight/100"}).exit_code, 2);
}

TEST_F(LibraryTest, colours_of_wide_gamuts_develop_to_themselves) {
  // Emission, at half its brightness possible: what is outside Rec.709 has negative channels.
  const auto shines = [](const char* space) {
    json document = json::parse(pane({{"dispersion", {{"abbe", {{"nd", 1.0}, {"vd", 60}}}}}}));
    document["scenes"][0]["extensions"]["ABBE_scene"] = {{"colorspace", space}};
    document["materials"][1]["pbrMetallicRoughness"]["baseColorFactor"] = {0.2, 0.6, 0.2, 1};
    return document.dump();
  };
  const std::vector<float> color = pixel(shines("Linear Rec.2020"), {"--wavelengths", "64"});
  // BT.2087's matrix times 0.2, 0.6, 0.2.
  EXPECT_NEAR(color[0], -0.0350, 2e-3);  // the quadrature of 64 wavelengths
  EXPECT_NEAR(color[1], 0.6532, 2e-3);
  EXPECT_NEAR(color[2], 0.1597, 2e-3);
  EXPECT_EQ(parsed({"inspect", "out.exr", "--json"}).at("attributes").at("abbe:uplift"),
            "Jakob-Hanika 2019, Rec.2020");
  // What knows Rec.709 only limits it.
  EXPECT_GE(pixel(shines("Linear Rec.2020"), {"--mode", "rgb"})[0], 0.0f);
}

TEST_F(LibraryTest, impossible_colours_are_counted) {
  const json clear = {{"dispersion", {{"abbe", {{"nd", 1.5}, {"vd", 60}}}}}};
  json document = json::parse(pane(clear, {{"colorspace", "ACEScg"}}));
  document["materials"][1].erase("extensions");
  document["materials"][1]["pbrMetallicRoughness"] = {{"baseColorFactor", {0, 1, 0, 1}},
                                                      {"metallicFactor", 0}};
  write("wide.gltf", document.dump());
  const json colors = parsed({"inspect", "wide.gltf", "--json"}).at("colors");
  EXPECT_EQ(colors.at("space"), "ACEScg");
  EXPECT_EQ(colors.at("outside_rec709"), 1);
  EXPECT_EQ(colors.at("impossible"), 1);
  EXPECT_THAT(abbe({"inspect", "wide.gltf"}).out, HasSubstr("impossible"));
  EXPECT_EQ(parsed({"inspect", "scene.gltf", "--json"}).at("colors").at("impossible"), 0);
}

TEST_F(LibraryTest, uplift_is_a_choice_that_files_remember) {
  const Arguments render{"render", "scene.gltf", "-o", "a.exr",  "--size",
                         "2x2",    "--spp",      "1",  "--quiet"};
  Arguments by_choice = render;
  by_choice.insert(by_choice.end(), {"--uplift", "mallett-yuksel"});
  EXPECT_EQ(abbe(by_choice).exit_code, 0);
  const json image = parsed({"inspect", "a.exr", "--json"});
  EXPECT_EQ(image.at("attributes").at("abbe:uplift"), "Mallett-Yuksel 2019, Rec.709");
  EXPECT_THAT(image.dump(), HasSubstr("--uplift mallett-yuksel"));
  EXPECT_EQ(abbe(render).exit_code, 0);
  EXPECT_THAT(parsed({"inspect", "a.exr", "--json"}).dump(), Not(HasSubstr("--uplift")));
  Arguments unknown = render;
  unknown.insert(unknown.end(), {"--uplift", "smits"});
  const Outcome run = abbe(unknown);
  EXPECT_EQ(run.exit_code, 2);
  EXPECT_THAT(run.err, HasSubstr("jakob-hanika"));
}

}  // namespace
}  // namespace abbe::test
