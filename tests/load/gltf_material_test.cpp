#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "load/gltf_builder.h"

namespace abbe {
namespace {

using testing::HasSubstr;
using testing::IsEmpty;

// A PNG of one red pixel, by hand from the format's definition.
const char* const kRedPixel =
    "data:image/png;base64,iVBORw0KGgoAAAANSUhEUgAAAAEAAAABCAIAAACQd1PeAAAADElEQVR4nGP4z8AAAAMBAQDJ"
    "/pLvAAAAAElFTkSuQmCC";

class GltfMaterial : public GltfTest {
 protected:
  Json& extension(const char* name) { return material()["extensions"][name]; }
  Material loaded() { return load().materials.at(0); }
  double index_at(const Material& m, double wavelength_nm) const {
    return refractive_index(m.index, wavelength_nm);
  }
  void use_texture() {
    document["images"] = {{{"uri", kRedPixel}}};
    document["textures"] = {{{"source", 0}}};
    primitive()["attributes"]["TEXCOORD_0"] =
        add_accessor(std::vector<float>{0, 0, 1, 0, 0, 1}, "VEC2");
    material()["pbrMetallicRoughness"]["baseColorTexture"] = {{"index", 0}};
  }
  Json& texture_info() { return material()["pbrMetallicRoughness"]["baseColorTexture"]; }
};

TEST_F(GltfMaterial, empty_material_has_the_defaults_of_the_format) {
  material() = Json::object();
  const Material m = loaded();
  EXPECT_EQ(m.base_color_rec709, Vec4f(1.0f));
  EXPECT_EQ(m.metallic, 1.0f);
  EXPECT_EQ(m.roughness, 1.0f);
  EXPECT_EQ(m.emissive_rec709, Vec3f(0.0f));
  EXPECT_EQ(m.alpha_mode, AlphaMode::Opaque);
  EXPECT_EQ(m.alpha_cutoff, 0.5f);
  EXPECT_FALSE(m.double_sided);
  EXPECT_FALSE(m.unlit);
  EXPECT_EQ(m.transmission, 0.0f);
  EXPECT_FALSE(m.has_volume);
  EXPECT_EQ(index_at(m, 550), 1.5);
  EXPECT_TRUE(std::isinf(m.attenuation_distance_m));
}

TEST_F(GltfMaterial, empty_extensions_have_their_defaults) {
  for (const char* name :
       {"KHR_materials_ior", "KHR_materials_transmission", "KHR_materials_volume",
        "KHR_materials_dispersion", "KHR_materials_emissive_strength"}) {
    extension(name) = Json::object();
  }
  material()["emissiveFactor"] = {1, 0.5, 0};
  const Material m = loaded();
  EXPECT_EQ(index_at(m, 400), 1.5);
  EXPECT_FALSE(is_dispersive(m.index));
  EXPECT_EQ(m.transmission, 0.0f);
  EXPECT_FALSE(m.has_volume);
  EXPECT_EQ(m.emissive_rec709, Vec3f(1, 0.5f, 0));
}

TEST_F(GltfMaterial, glass_of_the_khr_extensions) {
  extension("KHR_materials_ior") = {{"ior", 1.7}};
  extension("KHR_materials_transmission") = {{"transmissionFactor", 0.9}};
  extension("KHR_materials_volume") = {
      {"thicknessFactor", 0.01}, {"attenuationDistance", 0.25}, {"attenuationColor", {0.5, 1, 0}}};
  extension("KHR_materials_dispersion") = {{"dispersion", 0.5}};
  const Material m = loaded();
  EXPECT_FLOAT_EQ(m.transmission, 0.9f);
  EXPECT_TRUE(m.has_volume);
  EXPECT_EQ(m.attenuation_distance_m, 0.25);
  EXPECT_EQ(m.attenuation_color_rec709, Vec3d(0.5, 1, 0));
  // 20/0.5 = 40; the extension's rounded constants hold n_d to 1e-5 and V_d to 0.1 %.
  EXPECT_NEAR(index_at(m, 587.5618), 1.7, 1e-5);
  EXPECT_NEAR(abbe_number(m.index), 40.0, 0.04);
}

TEST_F(GltfMaterial, ior_of_zero_is_infinite_and_below_one_is_one) {
  extension("KHR_materials_ior") = {{"ior", 0}};
  extension("KHR_materials_dispersion") = {{"dispersion", 1}};
  EXPECT_TRUE(loaded().index_is_infinite);
  extension("KHR_materials_ior") = {{"ior", 0.9}};
  EXPECT_EQ(index_at(loaded(), 587.5618), 1.0);
  EXPECT_THAT(notes_text(), HasSubstr("/materials/0/extensions/KHR_materials_ior/ior: 0.9, "
                                      "expected 0 or at least 1; 1 is used"));
}

TEST_F(GltfMaterial, variant_chooses_among_the_materials_of_a_primitive) {
  document["materials"] = {{{"name", "red"}}, {{"name", "blue"}}, {{"name", "green"}}};
  document["extensions"]["KHR_materials_variants"]["variants"] = {
      {{"name", "sea"}}, {{"name", "wood"}}, {{"name", "sky"}}};
  primitive()["material"] = 0;
  primitive()["extensions"]["KHR_materials_variants"]["mappings"] = {
      {{"material", 1}, {"variants", {0, 2}}}, {{"material", 2}, {"variants", {1}}}};
  const Scene plain = load();
  EXPECT_EQ(plain.materials[plain.meshes[0].material].name, "red");
  EXPECT_THAT(plain.variants, testing::ElementsAre("sea", "wood", "sky"));
  const auto material_for = [&](const std::string& variant) {
    LoadOptions options;
    options.variant = variant;
    const Scene scene = load_gltf(folder / "scene.gltf", Catalogue::standard(), options, notes);
    return scene.materials[scene.meshes[0].material].name;
  };
  EXPECT_EQ(material_for("sky"), "blue");
  EXPECT_EQ(material_for("wood"), "green");
  EXPECT_EQ(notes_text(), "");
  try {
    material_for("fire");
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(error.detail().kind, ErrorKind::Usage);
    EXPECT_THAT(error.detail().choices, testing::ElementsAre("sea", "wood", "sky"));
  }
}

TEST_F(GltfMaterial, emissive_strength_multiplies) {
  material()["emissiveFactor"] = {1, 0.5, 0};
  extension("KHR_materials_emissive_strength") = {{"emissiveStrength", 40}};
  EXPECT_EQ(loaded().emissive_rec709, Vec3f(40, 20, 0));
}

TEST_F(GltfMaterial, negative_emissive_strength_is_limited) {
  material()["emissiveFactor"] = {1, 0.5, 0};
  extension("KHR_materials_emissive_strength") = {{"emissiveStrength", -1}};
  EXPECT_EQ(loaded().emissive_rec709, Vec3f(0.0f));
  EXPECT_THAT(notes_text(), HasSubstr("emissiveStrength: -1 is outside 0 to inf; limited"));
}

TEST_F(GltfMaterial, alpha_double_sided_and_unlit) {
  material()["alphaMode"] = "MASK";
  material()["alphaCutoff"] = 0.25;
  material()["doubleSided"] = true;
  extension("KHR_materials_unlit") = Json::object();
  Material m = loaded();
  EXPECT_EQ(m.alpha_mode, AlphaMode::Mask);
  EXPECT_EQ(m.alpha_cutoff, 0.25f);
  EXPECT_TRUE(m.double_sided);
  EXPECT_TRUE(m.unlit);
  material()["alphaMode"] = "BLEND";
  EXPECT_EQ(loaded().alpha_mode, AlphaMode::Blend);
  material()["alphaMode"] = "GLOW";
  EXPECT_EQ(loaded().alpha_mode, AlphaMode::Opaque);
  EXPECT_THAT(notes_text(), HasSubstr("GLOW"));
}

TEST_F(GltfMaterial, factors_beyond_their_range_are_limited_with_one_note) {
  material()["pbrMetallicRoughness"] = {{"baseColorFactor", {2, -1, 0.5, 1}}};
  EXPECT_EQ(loaded().base_color_rec709, Vec4f(1, 0, 0.5f, 1));
  EXPECT_EQ(notes.all().size(), 1u);
}

TEST_F(GltfMaterial, texture_is_decoded_with_its_sampler) {
  use_texture();
  document["samplers"] = {{{"wrapS", 33071}, {"wrapT", 33648}, {"magFilter", 9728}}};
  document["textures"][0]["sampler"] = 0;
  const Scene scene = load();
  ASSERT_EQ(scene.textures.size(), 1u);
  EXPECT_EQ(scene.textures[0].wrap_s, TextureWrap::ClampToEdge);
  EXPECT_EQ(scene.textures[0].wrap_t, TextureWrap::MirroredRepeat);
  EXPECT_EQ(scene.textures[0].filter, TextureFilter::Nearest);
  ASSERT_EQ(scene.images.size(), 1u);
  EXPECT_THAT(scene.images[0].rgba8, testing::ElementsAre(255, 0, 0, 255));
  ASSERT_TRUE(scene.materials[0].base_color_texture);
  EXPECT_EQ(scene.materials[0].base_color_texture->uv_set, 0u);
  EXPECT_EQ(notes_text(), "");
}

TEST_F(GltfMaterial, scheme_of_an_embedded_image_has_no_case) {
  use_texture();
  document["images"][0]["uri"] = "DATA" + std::string(kRedPixel).substr(4);
  EXPECT_EQ(load().images.size(), 1u);
  EXPECT_THAT(notes.all(), IsEmpty());
}

TEST_F(GltfMaterial, textures_of_one_image_decode_it_once) {
  use_texture();
  document["textures"].push_back({{"source", 0}});
  material()["emissiveTexture"] = {{"index", 1}};
  const Scene scene = load();
  EXPECT_EQ(scene.textures.size(), 2u);
  EXPECT_EQ(scene.images.size(), 1u);
}

TEST_F(GltfMaterial, texture_coordinates_that_the_mesh_lacks_are_a_note) {
  use_texture();
  texture_info()["texCoord"] = 1;
  EXPECT_EQ(loaded().base_color_texture->uv_set, 1u);
  EXPECT_THAT(notes_text(), HasSubstr("TEXCOORD_1"));
  texture_info()["texCoord"] = 2;
  EXPECT_FALSE(loaded().base_color_texture);
}

TEST_F(GltfMaterial, image_in_a_buffer_view_is_read) {
  use_texture();
  const std::string encoded = std::string(kRedPixel).substr(22);
  write("red.txt", encoded);
  ASSERT_EQ(std::system(("base64 -d " + (folder / "red.txt").string() + " > " +
                         (folder / "red.png").string())
                            .c_str()),
            0);
  std::ifstream stream(folder / "red.png", std::ios::binary);
  const std::vector<char> bytes{std::istreambuf_iterator<char>(stream), {}};
  document["images"][0] = {
      {"bufferView", add_view(std::vector<std::uint8_t>(bytes.begin(), bytes.end()))},
      {"mimeType", "image/png"}};
  EXPECT_EQ(load().images.at(0).width, 1);
  document["images"][0] = {{"uri", "red.png"}};
  EXPECT_EQ(load().images.at(0).width, 1);
  document["images"][0] = Json::object();
  EXPECT_THAT(error(), HasSubstr("/images/0"));
}

TEST_F(GltfMaterial, texture_transform_turns_as_the_khronos_test_model_shows) {
  // In TextureTransformTest the arrow's head is the texel (a, a), 1.1 from the corner; under a
  // rotation of 22.5° it must show where the marker "correct" stands, at this uv of the quad.
  use_texture();
  texture_info()["extensions"]["KHR_texture_transform"] = {{"rotation", 0.39269908169872414}};
  const TextureUse use = *loaded().base_color_texture;
  const double u = 0.5 - 0.07904822439840126;
  const double v = 0.5 + 0.5162674857624154;
  const double head = 0.5 + 0.2778174593052023;
  // Single-precision matrix and coordinates.
  EXPECT_NEAR(use.uv_linear[0] * u + use.uv_linear[1] * v, head, 1e-6);
  EXPECT_NEAR(use.uv_linear[2] * u + use.uv_linear[3] * v, head, 1e-6);
}

TEST_F(GltfMaterial, texture_transform_scales_first_and_shifts_last) {
  use_texture();
  texture_info()["extensions"]["KHR_texture_transform"] = {
      {"rotation", std::acos(0.0)}, {"scale", {2, 3}}, {"offset", {10, 20}}, {"texCoord", 0}};
  texture_info()["texCoord"] = 1;
  const TextureUse use = *loaded().base_color_texture;
  EXPECT_EQ(use.uv_set, 0u);
  // (1, 1) is scaled to (2, 3), turned to (3, −2), shifted to (13, 18). Rounding of cos 90°.
  EXPECT_NEAR(use.uv_linear[0] + use.uv_linear[1] + use.uv_offset.x, 13.0, 1e-5);
  EXPECT_NEAR(use.uv_linear[2] + use.uv_linear[3] + use.uv_offset.y, 18.0, 1e-5);
}

TEST_F(GltfMaterial, unknown_optional_extension_is_a_note_and_a_required_one_an_error) {
  document["extensionsUsed"] = {"EXT_future"};
  load();
  EXPECT_THAT(notes_text(), HasSubstr("EXT_future"));
  document["extensionsRequired"] = {"EXT_future"};
  EXPECT_THAT(error(), HasSubstr("the required extension EXT_future"));
}

TEST_F(GltfMaterial, required_extension_is_an_error_unless_it_is_optional_by_nature) {
  // Where things are depends on it.
  document["extensionsUsed"] = document["extensionsRequired"] = {"KHR_animation_pointer"};
  EXPECT_THAT(error(), HasSubstr("the required extension KHR_animation_pointer"));
  for (const char* name : {"KHR_xmp_json_ld", "KHR_materials_future", "EXT_structural_metadata"}) {
    document["extensionsUsed"] = document["extensionsRequired"] = {name};
    EXPECT_EQ(error(), "") << name;
    EXPECT_THAT(notes_text(), HasSubstr(name));
  }
}

TEST_F(GltfMaterial, catalogue_glass_implies_clear_polished_glass) {
  abbe_material()["dispersion"] = {{"glass", "N-BK7"}};
  const Material m = loaded();
  EXPECT_EQ(m.transmission, 1.0f);
  EXPECT_TRUE(m.has_volume);
  EXPECT_EQ(m.metallic, 0.0f);
  EXPECT_EQ(m.roughness, 0.0f);
  EXPECT_EQ(m.index_id, "glass/schott/N-BK7");
  EXPECT_NEAR(index_at(m, 587.5618), 1.516800, 1e-6);  // The catalogue's six digits.
  EXPECT_NEAR(abbe_number(m.index), 64.167, 5e-3);     // The catalogue's five digits.
  EXPECT_EQ(notes_text(), "");
}

TEST_F(GltfMaterial, stated_roughness_of_glass_is_kept) {
  material()["pbrMetallicRoughness"] = {{"roughnessFactor", 0.3}, {"metallicFactor", 0.2}};
  abbe_material()["dispersion"] = {{"glass", "N-BK7"}};
  EXPECT_EQ(loaded().roughness, 0.3f);
  EXPECT_EQ(loaded().metallic, 0.2f);
}

TEST_F(GltfMaterial, glass_by_formula_has_the_indices_of_the_catalogue) {
  // Schott N-BK7 and N-SF11.
  abbe_material()["dispersion"] = {{"sellmeier",
                                    {{"B", {1.03961212, 0.231792344, 1.01046945}},
                                     {"C", {0.00600069867, 0.0200179144, 103.560653}}}}};
  EXPECT_NEAR(index_at(loaded(), 587.5618), 1.516800, 1e-6);  // The catalogue's six digits.
  abbe_material()["dispersion"] = {{"abbe", {{"nd", 1.78472}, {"vd", 25.68}}}};
  EXPECT_NEAR(index_at(loaded(), 587.5618), 1.78472, 1e-9);  // Exact by construction.
  EXPECT_NEAR(abbe_number(loaded().index), 25.68, 1e-6);
  abbe_material()["dispersion"] = {{"cauchy", {{"A", 1.5}, {"B", 0.004}, {"C", 0.0001}}}};
  EXPECT_NEAR(index_at(loaded(), 500), 1.5 + 0.004 / 0.25 + 0.0001 / 0.0625, 1e-12);
}

TEST_F(GltfMaterial, formula_in_wrong_units_or_shape_is_an_error) {
  for (const Json& dispersion :
       {Json{{"sellmeier", {{"B", {1.0}}, {"C", {0.01, 0.02}}}}},
        Json{{"sellmeier", {{"B", {1.0}}, {"C", {10000.0}}}}},
        Json{{"cauchy", {{"A", 1.5}, {"B", 900}}}}, Json{{"cauchy", {{"B", 0.004}}}},
        Json{{"abbe", {{"nd", 1.5}}}}, Json{{"abbe", {{"nd", 0.5}, {"vd", 50}}}}, Json::object(),
        Json{{"glass", "N-BK7"}, {"abbe", {{"nd", 1.5}, {"vd", 50}}}}}) {
    abbe_material()["dispersion"] = dispersion;
    EXPECT_THAT(error(), HasSubstr("/materials/0/extensions/ABBE_material/dispersion"))
        << dispersion;
  }
}

TEST_F(GltfMaterial, unknown_glass_is_an_error_with_near_names) {
  abbe_material()["dispersion"] = {{"glass", "N-BK8"}};
  EXPECT_THAT(error(), HasSubstr("N-BK7"));
  abbe_material()["dispersion"] = {{"glass", "metal/Au-Johnson"}};
  EXPECT_THAT(error(), HasSubstr("metal/Au-Johnson"));
}

TEST_F(GltfMaterial, conductor_by_id_and_by_spectra) {
  abbe_material()["conductor"] = "metal/Au-Johnson";
  Material m = loaded();
  ASSERT_TRUE(m.conductor);
  EXPECT_EQ(m.conductor->id, "metal/Au-Johnson");
  EXPECT_EQ(m.metallic, 1.0f);
  EXPECT_EQ(m.roughness, 0.0f);
  // Gold is yellow: at 650 nm it reflects 0.95 (n, k of Johnson & Christy), at 450 nm 0.4.
  const auto reflects = [&m](double nm) {
    const double n = m.conductor->n.value(nm);
    const double k = m.conductor->k.value(nm);
    return ((n - 1) * (n - 1) + k * k) / ((n + 1) * (n + 1) + k * k);
  };
  EXPECT_NEAR(reflects(650), 0.9565222664, 1e-6);  // The reference material's oracle.
  abbe_material()["conductor"] = {{"n", 0.2}, {"k", {{400, 3}, {700, 4}}}};
  m = loaded();
  EXPECT_EQ(m.conductor->n.value(500), 0.2);
  EXPECT_DOUBLE_EQ(m.conductor->k.value(550), 3.5);
  abbe_material()["conductor"] = {{"n", 0.2}};
  EXPECT_THAT(error(), HasSubstr("conductor"));
}

TEST_F(GltfMaterial, emission_reflectance_absorption_and_ambient) {
  abbe_material() = {{"emission", {{"spectrum", "illuminant/A"}, {"luminance", 120}}},
                     {"reflectance", {{400, 0.1}, {700, 0.9}}},
                     {"absorption", 2.5},
                     {"ambient", 0.25}};
  const Material m = loaded();
  EXPECT_EQ(m.emission->luminance_cd_per_m2, 120.0);
  EXPECT_EQ(m.emission->spectrum.id, "illuminant/A");
  EXPECT_DOUBLE_EQ(m.reflectance->spectrum.value(550), 0.5);
  EXPECT_DOUBLE_EQ(m.reflectance->spectrum.value(360), 0.1);
  EXPECT_EQ(m.absorption_per_m->value(500), 2.5);
  EXPECT_EQ(m.ambient_factor, 0.25);
  EXPECT_EQ(notes_text(), "");
}

TEST_F(GltfMaterial, priority_is_an_integer_of_sixteen_bits) {
  abbe_material() = Json::object();
  EXPECT_EQ(loaded().priority, 0);
  for (const int priority : {-32768, -3, 7, 32767}) {
    abbe_material()["priority"] = priority;
    EXPECT_EQ(loaded().priority, priority);
  }
  abbe_material()["priority"] = 2.5;
  EXPECT_THAT(error(), HasSubstr("/materials/0/extensions/ABBE_material/priority"));
  EXPECT_THAT(error(), HasSubstr("an integer from -32768 to 32767"));
  abbe_material()["priority"] = 32768;
  EXPECT_THAT(error(), HasSubstr("from -32768 to 32767"));
  abbe_material()["priority"] = "high";
  EXPECT_THAT(error(), HasSubstr("/materials/0/extensions/ABBE_material/priority"));
}

TEST_F(GltfMaterial, unknown_fields_are_notes_that_list_the_valid_ones) {
  abbe_material() = {{"reflectence", 0.5}, {"fluorescence", {{"shift_nm", 40}}}};
  loaded();
  EXPECT_THAT(notes_text(), HasSubstr("/materials/0/extensions/ABBE_material/fluorescence"));
  EXPECT_THAT(notes_text(), HasSubstr("/materials/0/extensions/ABBE_material/reflectence"));
  EXPECT_THAT(notes_text(), HasSubstr("dispersion, conductor, reflectance"));
}

}  // namespace
}  // namespace abbe
