#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <cmath>

#include "load/gltf_builder.h"

namespace abbe {
namespace {

using testing::HasSubstr;

class GltfAbbe : public GltfTest {
 protected:
  // What a spectrum written as a reflectance reads as.
  NamedSpectrum read(const Json& spectrum) {
    abbe_material()["reflectance"] = spectrum;
    return *load().materials.at(0).reflectance;
  }
  std::string error_of(const Json& spectrum) {
    abbe_material()["reflectance"] = spectrum;
    return error();
  }
  Light light_with(const Json& spectrum) {
    document["extensions"]["KHR_lights_punctual"]["lights"] = {
        {{"type", "point"}, {"extensions", {{"ABBE_light", {{"spectrum", spectrum}}}}}}};
    node()["extensions"]["KHR_lights_punctual"]["light"] = 0;
    return load().lights.at(0);
  }
  Json& shape() { return document["meshes"][0]["extensions"]["ABBE_shape"]; }
};

TEST_F(GltfAbbe, spectrum_as_number_and_table) {
  EXPECT_EQ(read(0.25).spectrum.value(600), 0.25);
  EXPECT_EQ(read(0.25).id, "");
  EXPECT_DOUBLE_EQ(read({{500, 0.0}, {600, 1.0}}).spectrum.value(525), 0.25);
}

TEST_F(GltfAbbe, spectrum_as_csv_file_in_the_folder) {
  write("paint/red.csv", "wavelength,reflectance\n# measured\n500, 0.1\r\n600;0.3\n\n700\t0.5\n");
  const NamedSpectrum red = read("paint/red.csv");
  EXPECT_DOUBLE_EQ(red.spectrum.value(550), 0.2);
  EXPECT_DOUBLE_EQ(red.spectrum.value(700), 0.5);
  EXPECT_EQ(red.id, "paint/red.csv");
}

TEST_F(GltfAbbe, spectrum_as_file_of_the_catalogues_format) {
  write("mine.txt",
        "abbe-spectrum 1\nquantity: reflectance\nunit: 1\nwavelength: nm 400 700\nname: mine\n"
        "source: made up\nlicence: CC0-1.0\ncolumns: nm value\n400 0.2\n700 0.4\n");
  EXPECT_NEAR(read("mine.txt").spectrum.value(550), 0.3, 1e-12);  // Rounding.
}

TEST_F(GltfAbbe, spectrum_with_mistakes_names_file_and_line_or_pointer) {
  write("bad.csv", "500,0.1\n490,0.2\n");
  EXPECT_THAT(error_of("bad.csv"), HasSubstr("bad.csv: line 2"));
  write("words.csv", "500,0.1\nsix,hundred\n");
  EXPECT_THAT(error_of("words.csv"), HasSubstr("words.csv: line 2"));
  write("empty.csv", "");
  EXPECT_THAT(error_of("empty.csv"), HasSubstr("no row"));
  EXPECT_THAT(error_of("none.csv"), HasSubstr("none.csv"));
  EXPECT_THAT(error_of("../out.csv"), HasSubstr("leaves the folder"));
  EXPECT_THAT(error_of("/etc/passwd"), HasSubstr("leaves the folder"));
  EXPECT_THAT(error_of(Json::array()), HasSubstr("/reflectance"));
  EXPECT_THAT(error_of({{500, 0.1}, {500, 0.2}}), HasSubstr("/reflectance/1/0"));
  EXPECT_THAT(error_of({{500}}), HasSubstr("/reflectance/0"));
  EXPECT_THAT(error_of(true), HasSubstr("expected an id, a path, a number"));
  EXPECT_THAT(error_of("no-such-paint"), HasSubstr("no-such-paint"));
  EXPECT_THAT(error_of("illuminant/A"), HasSubstr("a reflectance"));
  EXPECT_THAT(error_of({{"blackbody", 3000}}), HasSubstr("/reflectance"));
}

TEST_F(GltfAbbe, spectrum_file_that_is_a_pipe_does_not_wait) {
  ASSERT_EQ(mkfifo((folder / "pipe.csv").c_str(), 0600), 0);
  EXPECT_THAT(error_of("pipe.csv"), HasSubstr("a named pipe"));
}

TEST_F(GltfAbbe, reflectance_above_one_is_limited_with_a_note) {
  EXPECT_EQ(read(3.0).spectrum.value(500), 1.0);
  EXPECT_THAT(notes_text(), HasSubstr("limited"));
}

TEST_F(GltfAbbe, spectrum_file_changes_the_content_hash) {
  write("a.csv", "500,0.1\n");
  abbe_material()["reflectance"] = "a.csv";
  const std::string before = load().content_hash;
  EXPECT_EQ(load().content_hash, before);
  write("a.csv", "500,0.2\n");
  EXPECT_NE(load().content_hash, before);
}

TEST_F(GltfAbbe, content_hash_is_16_hex_digits_and_follows_every_file) {
  const std::string before = load().content_hash;
  EXPECT_THAT(before, testing::MatchesRegex("[0-9a-f]{16}"));
  binary[4] = static_cast<char>(binary[4] ^ 1);
  EXPECT_NE(load().content_hash, before);
}

TEST_F(GltfAbbe, light_spectra) {
  EXPECT_EQ(light_with("illuminant/FL11").spectrum->id, "illuminant/FL11");
  // Planck: the ratio of 450 and 650 nm at 3000 K, from c2 = 1.4387769e-2 m·K.
  const auto planck = [](double nm) {
    return 1.0 / (std::pow(nm, 5) * std::expm1(1.4387769e7 / (nm * 3000.0)));
  };
  const Spectrum hot = light_with({{"blackbody", 3000}}).spectrum->spectrum;
  EXPECT_NEAR(hot.value(450) / hot.value(650), planck(450) / planck(650), 1e-6);  // Digits of c2.
  const Spectrum sodium = light_with({{"lines", {{589.59, 1}, {588.995, 2}}}}).spectrum->spectrum;
  ASSERT_EQ(sodium.lines().size(), 2u);
  EXPECT_EQ(sodium.lines()[0].wavelength_nm, 588.995);
  EXPECT_EQ(sodium.lines()[0].strength, 2.0);
  EXPECT_TRUE(sodium.is_lines_only());
}

TEST_F(GltfAbbe, lamp_table_is_dark_outside_and_other_tables_are_clamped) {
  EXPECT_EQ(light_with({{500, 1.0}, {600, 1.0}}).spectrum->spectrum.value(700), 0.0);
  EXPECT_EQ(read({{500, 0.5}, {600, 0.5}}).spectrum.value(700), 0.5);
}

TEST_F(GltfAbbe, light_spectra_that_mean_nothing_are_errors) {
  for (const Json& spectrum : {Json{{"blackbody", -5}}, Json{{"lines", Json::array()}},
                               Json{{"lines", {{200, 1}}}}, Json::object()}) {
    try {
      light_with(spectrum);
      ADD_FAILURE() << spectrum;
    } catch (const Error& caught) {
      EXPECT_THAT(caught.what(), HasSubstr("/extensions/KHR_lights_punctual/lights/0"));
    }
  }
}

TEST_F(GltfAbbe, beam_of_a_directional_light_keeps_its_size) {
  document["extensions"]["KHR_lights_punctual"]["lights"] = {
      {{"type", "directional"},
       {"extensions", {{"ABBE_light", {{"beam", {{"width", 0.5}, {"height", 2}}}}}}}}};
  node()["extensions"]["KHR_lights_punctual"]["light"] = 0;
  const Scene scene = load();
  ASSERT_TRUE(scene.lights.at(0).beam);
  EXPECT_EQ(scene.lights[0].beam->width_m, 0.5);
  EXPECT_EQ(scene.lights[0].beam->height_m, 2.0);
}

TEST_F(GltfAbbe, beam_of_another_light_is_an_error) {
  document["extensions"]["KHR_lights_punctual"]["lights"] = {
      {{"type", "point"},
       {"extensions", {{"ABBE_light", {{"beam", {{"width", 0.5}, {"height", 2}}}}}}}}};
  node()["extensions"]["KHR_lights_punctual"]["light"] = 0;
  EXPECT_THROW(load(), Error);
}

TEST_F(GltfAbbe, fog_of_the_scene) {
  document["scenes"][0]["extensions"]["ABBE_scene"] = {
      {"fog", {{"extinction", 0.25}, {"albedo", 0.5}}}};
  const Scene scene = load();
  ASSERT_TRUE(scene.fog);
  EXPECT_EQ(scene.fog->extinction_per_m, 0.25);
  EXPECT_EQ(std::get<Spectrum>(scene.fog->albedo).value(500), 0.5);
}

TEST_F(GltfAbbe, extension_where_nothing_reads_it_is_said_to_belong_elsewhere) {
  document["extensions"]["ABBE_scene"] = {{"fog", {{"extinction", 0.25}}}};
  node()["extensions"]["ABBE_material"] = Json::object();
  material()["extensions"]["ABBE_shine"] = Json::object();
  EXPECT_FALSE(load().fog);
  EXPECT_THAT(notes_text(),
              HasSubstr("/extensions/ABBE_scene: ignored: it belongs into /scenes/*/extensions"));
  EXPECT_THAT(notes_text(), HasSubstr("/nodes/0/extensions/ABBE_material: ignored"));
  EXPECT_THAT(notes_text(), HasSubstr("ABBE_shine: no such extension"));
}

TEST_F(GltfAbbe, ambient_of_the_scene) {
  document["scenes"][0]["extensions"]["ABBE_scene"] = {
      {"ambient", {{"luminance", 3}, {"spectrum", {{"blackbody", 5000}}}}},
      {"weather", Json::object()}};
  const Scene scene = load();
  ASSERT_TRUE(scene.ambient);
  EXPECT_EQ(scene.ambient->luminance_cd_per_m2, 3.0);
  EXPECT_GT(scene.ambient->spectrum.spectrum.value(500), 0.0);
  EXPECT_THAT(notes_text(), HasSubstr("ABBE_scene/weather"));
  document["scenes"][0]["extensions"]["ABBE_scene"] = {{"ambient", {{"luminance", 3}}}};
  EXPECT_EQ(load().ambient->spectrum.id, "illuminant/D65");
}

TEST_F(GltfAbbe, sphere_replaces_the_triangles_and_takes_their_material) {
  material()["name"] = "glass";
  document["materials"].push_back({{"name", "other"}});
  primitive()["material"] = 1;
  shape() = {{"sphere", {{"radius", 2.5}}}};
  node()["scale"] = {1, 2, 3};
  const Scene scene = load();
  EXPECT_TRUE(scene.meshes.empty());
  const Shape& sphere = std::get<Shape>(scene.instances.at(0).what);
  EXPECT_EQ(std::get<SphereShape>(sphere.geometry).radius_m, 2.5);
  EXPECT_EQ(scene.materials[sphere.material].name, "other");
}

TEST_F(GltfAbbe, convex_body_keeps_its_planes) {
  shape() = {{"convex",
              {{"planes",
                {{1, 0, 0, 1},
                 {-1, 0, 0, 1},
                 {0, 2, 0, 2},
                 {0, -1, 0, 1},
                 {0, 0, 1, 1},
                 {0, 0, -1, 1}}}}}};
  const Scene scene = load();
  const auto& body = std::get<ConvexShape>(std::get<Shape>(scene.instances.at(0).what).geometry);
  EXPECT_EQ(body.planes.size(), 6u);
  EXPECT_EQ(body.planes[2], Vec4d(0, 2, 0, 2));
  EXPECT_EQ(bounds_of(scene).high, Vec3d(1, 1, 1));
}

TEST_F(GltfAbbe, shapes_that_enclose_nothing_are_errors) {
  const Json open = {{1, 0, 0, 1}, {-1, 0, 0, 1}, {0, 1, 0, 1}, {0, -1, 0, 1}};
  const Json empty = {{1, 0, 0, -1}, {-1, 0, 0, -1}, {0, 1, 0, 1},
                      {0, -1, 0, 1}, {0, 0, 1, 1},   {0, 0, -1, 1}};
  const Json flat = {{0, 0, 0, 1}, {-1, 0, 0, 1}, {0, 1, 0, 1}, {0, -1, 0, 1}};
  const Json parallel = {{1, 0, 0, 1}, {1, 0, 0, 2}, {-1, 0, 0, 1}, {-1, 0, 0, 3}};
  for (const Json& planes : {open, empty, flat, parallel, Json::array()}) {
    shape() = {{"convex", {{"planes", planes}}}};
    EXPECT_THAT(error(), HasSubstr("/meshes/0/extensions/ABBE_shape/convex/planes")) << planes;
  }
  for (const Json& bad : {Json::object(), Json{{"sphere", {{"radius", 0}}}},
                          Json{{"sphere", {{"radius", 1}}}, {"convex", Json::object()}}}) {
    shape() = bad;
    EXPECT_THAT(error(), HasSubstr("/meshes/0/extensions/ABBE_shape")) << bad;
  }
}

TEST_F(GltfAbbe, glass_that_is_stated_for_a_part_of_the_visible_is_one_warning) {
  write("half.yml",
        "DATA:\n  - type: formula 5\n    wavelength_range: 0.5 0.65\n"
        "    coefficients: 1.5 0.004 -2\n");
  abbe_material()["dispersion"]["glass"] = "half.yml";
  const Scene scene = load();
  ASSERT_EQ(notes.all().size(), 1u) << notes_text();
  EXPECT_EQ(notes.all().front().kind, NoteKind::Warning);
  EXPECT_THAT(notes_text(), HasSubstr("half.yml is stated for 500-650 nm"));
  EXPECT_THAT(notes_text(), HasSubstr("360-500 nm and 650-830 nm"));
  EXPECT_THAT(notes_text(), HasSubstr(scene.materials[0].name));
}

TEST_F(GltfAbbe, glass_with_a_pole_is_one_warning) {
  // λ² = 0.25 µm²: at 500 nm.
  write("pole.yml",
        "DATA:\n  - type: formula 2\n    wavelength_range: 0.3 1\n"
        "    coefficients: 1.25 0.01 0.25\n");
  abbe_material()["dispersion"]["glass"] = "pole.yml";
  load();
  ASSERT_EQ(notes.all().size(), 1u) << notes_text();
  EXPECT_THAT(notes_text(), HasSubstr("breaks down at 4"));
  EXPECT_THAT(notes_text(), HasSubstr("pole.yml"));
}

TEST_F(GltfAbbe, glass_of_a_zemax_catalogue_brings_its_absorption) {
  write("mine.agf",
        "NM GREY 1 0 1.5 99\nCD 2.25\nLD 0.3 1\nIT 0.4 0.5 10\nIT 0.7 0.25 10\n"
        "NM OTHER 1 0 1.5 99\nCD 2.25\nLD 0.3 1\n");
  abbe_material()["dispersion"]["glass"] = "mine.agf#GREY";
  const Scene scene = load();
  ASSERT_TRUE(scene.materials[0].absorption_per_m);
  // −ln(0.5)/10 mm and −ln(0.25)/10 mm.
  EXPECT_NEAR(scene.materials[0].absorption_per_m->value(400.0), 69.314718, 1e-6);
  EXPECT_NEAR(scene.materials[0].absorption_per_m->value(700.0), 138.629436, 1e-6);
  abbe_material()["dispersion"]["glass"] = "mine.agf";
  EXPECT_THAT(error(), HasSubstr("FILE.agf#GLASS"));
}

TEST_F(GltfAbbe, ids_that_a_number_makes_are_lamps) {
  EXPECT_EQ(light_with("daylight/5000").spectrum->id, "daylight/5000");
  const Spectrum hot = light_with("blackbody/3000").spectrum->spectrum;
  EXPECT_EQ(hot.value(600.0), light_with({{"blackbody", 3000}}).spectrum->spectrum.value(600.0));
}

TEST_F(GltfAbbe, colorspace_of_the_scene_turns_its_colours_into_rec709) {
  document["scenes"][0]["extensions"]["ABBE_scene"] = {{"colorspace", "Linear Rec.2020"}};
  material()["pbrMetallicRoughness"]["baseColorFactor"] = {0.0, 1.0, 0.0, 0.5};
  material()["emissiveFactor"] = {1.0, 1.0, 1.0};
  const Scene scene = load();
  EXPECT_EQ(scene.color_space, RgbSpace::Rec2020);
  const Vec4f base = scene.materials[0].base_color_rec709;
  // ITU-R BT.2087's middle column, four digits.
  EXPECT_NEAR(base.x, -0.5876, 5e-5);
  EXPECT_NEAR(base.y, 1.1329, 5e-5);
  EXPECT_NEAR(base.z, -0.1006, 5e-5);
  EXPECT_EQ(base.w, 0.5f);
  for (int c = 0; c < 3; ++c) EXPECT_NEAR(scene.materials[0].emissive_rec709[c], 1.0f, 1e-6f);
  document["scenes"][0]["extensions"]["ABBE_scene"] = {{"colorspace", "Rec.2020"}};
  EXPECT_THAT(error(), HasSubstr("Linear Rec.2020"));
}

}  // namespace
}  // namespace abbe
