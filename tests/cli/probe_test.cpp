/// `abbe probe`: angles that can be checked by hand.
#include <gmock/gmock.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "program.h"
#include "scenes.h"

namespace abbe::test {
namespace {

using nlohmann::json;
using testing::HasSubstr;

constexpr double kRadians = 3.14159265358979323846 / 180.0;

class ProbeTest : public ProgramTest {
 protected:
  ProbeTest() { write("prism.gltf", prism_scene()); }

  json probe(const Arguments& more) const {
    Arguments arguments{"probe", "prism.gltf", "--size", "9x9", "--pixel", "4,4", "--json"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    const Outcome run = abbe(arguments);
    EXPECT_EQ(run.exit_code, 0) << run.err;
    return json::parse(run.out);
  }

  static const Arguments& lines() {
    static const Arguments kLines{"--lines", "486.1327,587.5618,656.2725"};
    return kLines;
  }
};

TEST_F(ProbeTest, prism_deviates_as_computed_in_closed_form) {
  // sin i = n sin(30°) for d; the others through both faces by Snell, with N-SF11's Sellmeier
  // index.
  const double expected_deg[] = {69.25084, 66.34263, 65.24956};
  const json rays = probe(lines()).at("rays");
  bool found = false;
  for (const json& ray : rays) {
    if (ray.at("depth") != 2 || ray.at("made_by") != "refracted") continue;
    if (rays.at(ray.at("parent").get<std::size_t>()).at("made_by") != "refracted") continue;
    ASSERT_FALSE(ray.at("hit"));
    ASSERT_EQ(ray.at("lanes").size(), 3u);
    for (std::size_t i = 0; i < 3; ++i) {
      // Single precision errs by up to 5e-5 degrees, the incidence is given to four decimals.
      EXPECT_NEAR(ray.at("lanes").at(i).at("deviation_deg").get<double>(), expected_deg[i], 2e-4);
    }
    found = true;
  }
  EXPECT_TRUE(found);
}

TEST_F(ProbeTest, angles_obey_snell_and_shares_add_up) {
  int checked = 0;
  const json rays = probe(lines()).at("rays");
  for (const json& ray : rays) {
    if (!ray.at("hit")) continue;
    for (const json& lane : ray.at("lanes")) {
      EXPECT_NEAR(lane.at("k_r").get<double>() + lane.at("k_t").get<double>(), 1.0,
                  1e-6);  // Floats.
      if (!lane.contains("refraction_deg")) continue;
      const double in =
          lane.at("n1").get<double>() * std::sin(lane.at("incidence_deg").get<double>() * kRadians);
      const double out = lane.at("n2").get<double>() *
                         std::sin(lane.at("refraction_deg").get<double>() * kRadians);
      EXPECT_NEAR(in, out, 1e-6);  // Indices and directions are floats.
      ++checked;
    }
  }
  EXPECT_GE(checked, 6);
}

TEST_F(ProbeTest, first_ray_is_united_and_its_refraction_spread) {
  const json rays = probe({}).at("rays");
  EXPECT_EQ(rays.at(0).at("made_by"), "camera");
  EXPECT_FALSE(rays.at(0).at("spread"));
  EXPECT_EQ(rays.at(0).at("lanes").size(), 16u);
  EXPECT_EQ(rays.at(0).at("instance"), "prism");
  EXPECT_EQ(rays.at(0).at("material"), "flint");
  EXPECT_EQ(rays.at(0).at("side"), "entering");
  EXPECT_NEAR(rays.at(0).at("lanes").at(0).at("incidence_deg").get<double>(), 63.1713, 1e-4);
  for (const json& ray : rays) {
    if (ray.contains("parent") && ray.at("parent") == 0) {
      EXPECT_EQ(ray.at("spread").get<bool>(), ray.at("made_by") == "refracted");
    }
  }
}

TEST_F(ProbeTest, total_reflection_is_said) {
  write("right.gltf", right_angle_prism_scene());
  const Arguments arguments{"probe",   "right.gltf", "--size",  "9x9",
                            "--pixel", "4,4",        "--lines", "587.5618"};
  Arguments as_json = arguments;
  as_json.push_back("--json");
  const json rays = json::parse(abbe(as_json).out).at("rays");
  int total = 0;
  for (const json& ray : rays) {
    if (!ray.at("hit")) continue;
    const json& lane = ray.at("lanes").at(0);
    const bool is_oblique = std::abs(lane.at("incidence_deg").get<double>() - 45.0) < 1e-3;
    ASSERT_EQ(lane.at("total_internal_reflection").get<bool>(), is_oblique);
    if (!is_oblique) continue;
    ++total;
    EXPECT_EQ(lane.at("k_r"), 1.0);
    EXPECT_EQ(lane.at("k_t"), 0.0);
    EXPECT_FALSE(lane.contains("refraction_deg"));
  }
  EXPECT_GE(total, 1);
  EXPECT_THAT(abbe(arguments).out, HasSubstr("leaving prism (flint), total internal reflection"));
}

TEST_F(ProbeTest, text_is_an_aligned_tree_of_bounded_width) {
  const Outcome run =
      abbe({"probe", "prism.gltf", "--size", "9x9", "--pixel", "4,4", "--faint", "0"});
  EXPECT_EQ(run.exit_code, 0) << run.err;
  EXPECT_THAT(run.out,
              HasSubstr("camera, united, 16 wavelengths, weight 1: entering prism (flint)"));
  EXPECT_THAT(run.out, HasSubstr("\n  refracted, spread, 16 wavelengths"));
  EXPECT_THAT(run.out, HasSubstr("leaves the scene"));
  EXPECT_THAT(run.out, HasSubstr("63.1713"));
  std::size_t begin = 0;
  while (begin < run.out.size()) {
    const std::size_t end = run.out.find('\n', begin);
    EXPECT_LE(end - begin, 150u) << run.out.substr(begin, end - begin);
    begin = end + 1;
  }
}

TEST_F(ProbeTest, sample_of_a_render_is_followed_on_request) {
  const json centre = probe({});
  const json sample = probe({"--sample", "3"});
  EXPECT_EQ(sample.at("sample"), 3);
  EXPECT_NE(centre.at("camera").at("origin_m"), sample.at("camera").at("origin_m"));
}

TEST_F(ProbeTest, rgb_modes_have_channels_instead_of_wavelengths) {
  for (const char* mode : {"rgb", "rgb3"}) {
    const json lanes = probe({"--mode", mode}).at("rays").at(0).at("lanes");
    ASSERT_EQ(lanes.size(), 3u);
    EXPECT_EQ(lanes.at(0).at("channel"), "R");
    // One index for all, or C and F of N-SF11.
    const double spread = lanes.at(2).at("n2").get<double>() - lanes.at(0).at("n2").get<double>();
    EXPECT_NEAR(spread, std::string(mode) == "rgb" ? 0.0 : 0.03056, 2e-5);
  }
}

TEST_F(ProbeTest, drawing_shows_the_rays_of_every_line_with_angles_and_the_prism) {
  Arguments arguments{"probe",   "prism.gltf", "--size", "9x9",
                      "--pixel", "4,4",        "--svg",  "rays.svg"};
  arguments.insert(arguments.end(), lines().begin(), lines().end());
  const Outcome run = abbe(arguments);
  EXPECT_EQ(run.exit_code, 0) << run.err;
  EXPECT_THAT(run.out, HasSubstr("63.1713"));
  const std::string svg = bytes("rays.svg");
  EXPECT_THAT(svg, testing::StartsWith("<?xml"));
  EXPECT_THAT(svg, testing::EndsWith("</svg>\n"));
  // Into the prism for the d line: minimum deviation.
  EXPECT_THAT(svg, HasSubstr("63.1713° → 30.0000°"));
  EXPECT_THAT(svg, HasSubstr("63.17°"));
  // Three sides are cut.
  std::size_t outlines = 0;
  for (std::size_t at = svg.find("<polyline"); at != std::string::npos;
       at = svg.find("<polyline", at + 1)) {
    ++outlines;
  }
  EXPECT_EQ(outlines, 3u);
  for (const char* name : {"486.1", "587.6", "656.3"}) EXPECT_THAT(svg, HasSubstr(name));
}

TEST_F(ProbeTest, drawing_that_cannot_be_written_fails_before_the_scene_is_read) {
  const Outcome run = abbe({"probe", "none.gltf", "--pixel", "4,4", "--svg", "nowhere/rays.svg"});
  EXPECT_EQ(run.exit_code, 4);
  EXPECT_TRUE(is_one_error_line(run.err));
  EXPECT_THAT(run.err, HasSubstr("nowhere"));
}

const std::string& newton_file() {
  static const std::string kFile = std::string(ABBE_SOURCE_DIR) + "/scenes/newton/newton.gltf";
  return kFile;
}

TEST_F(ProbeTest, light_is_followed_backwards_through_the_prism_to_its_lamp) {
  // A pixel in the green of the spectrum on the screen.
  const Arguments base{"probe",   newton_file(),   "--size", "960x540", "--pixel",
                       "500,151", "--wavelengths", "64",     "--light", "beam"};
  Arguments as_json = base;
  as_json.emplace_back("--json");
  const Outcome run = abbe(as_json);
  ASSERT_EQ(run.exit_code, 0) << run.err;
  const json light = json::parse(run.out).at("light");
  EXPECT_EQ(light.at("surface"), "screen");
  bool found = false;
  for (const json& chain : light.at("chains")) {
    if (chain.at("events") != json({"enter", "leave"})) continue;
    for (const json& path : chain.at("paths")) {
      const json& enter = path.at("crossings").at(0);
      EXPECT_EQ(enter.at("body"), "prism");
      // The beam's incidence, and Snell's law.
      EXPECT_NEAR(enter.at("incidence_deg").get<double>(), 63.1713, 1e-3);
      EXPECT_NEAR(std::sin(kRadians * enter.at("incidence_deg").get<double>()),
                  enter.at("n_after").get<double>() *
                      std::sin(kRadians * enter.at("exit_deg").get<double>()),
                  1e-6);
      found = true;
    }
  }
  EXPECT_TRUE(found);

  Arguments drawn = base;
  drawn.insert(drawn.end(), {"--svg", "light.svg"});
  const Outcome picture = abbe(drawn);
  ASSERT_EQ(picture.exit_code, 0) << picture.err;
  EXPECT_THAT(picture.out, HasSubstr("enter prism, leave prism"));
  EXPECT_THAT(bytes("light.svg"), HasSubstr("leave prism"));
}

TEST_F(ProbeTest, unknown_lamp_is_an_error_that_lists_the_lamps) {
  const Outcome run =
      abbe({"probe", newton_file(), "--size", "96x54", "--pixel", "50,15", "--light", "sun"});
  EXPECT_EQ(run.exit_code, 2);
  EXPECT_TRUE(is_one_error_line(run.err));
  EXPECT_THAT(run.err, HasSubstr("room light"));
}

}  // namespace
}  // namespace abbe::test
