#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "load/gltf_builder.h"

namespace abbe {
namespace {

class GltfLayers : public GltfTest {
 protected:
  Json& extension(const char* name) { return material()["extensions"][name]; }
  Material loaded() { return load().materials.at(0); }
};

TEST_F(GltfLayers, empty_extensions_do_nothing) {
  for (const char* name : {"KHR_materials_clearcoat", "KHR_materials_sheen",
                           "KHR_materials_anisotropy", "KHR_materials_diffuse_transmission"}) {
    extension(name) = Json::object();
  }
  extension("KHR_materials_specular") = Json::object();
  const Material m = loaded();
  EXPECT_FALSE(m.clearcoat);
  EXPECT_FALSE(m.sheen);
  EXPECT_FALSE(m.anisotropy);
  EXPECT_FALSE(m.diffuse_transmission);
  ASSERT_TRUE(m.specular);
  EXPECT_EQ(m.specular->factor, 1.0f);
  EXPECT_EQ(m.specular->color_rec709, Vec3f(1.0f));
}

TEST_F(GltfLayers, factors_are_read_and_have_the_defaults_of_their_texts) {
  extension("KHR_materials_clearcoat") = {{"clearcoatFactor", 0.5}};
  extension("KHR_materials_sheen") = {{"sheenColorFactor", {0.1, 0.2, 0.3}}};
  extension("KHR_materials_anisotropy") = {{"anisotropyStrength", 0.6},
                                           {"anisotropyRotation", 1.5}};
  extension("KHR_materials_specular") = {{"specularFactor", 0.25},
                                         {"specularColorFactor", {2.0, 1.0, 0.0}}};
  extension("KHR_materials_diffuse_transmission") = {{"diffuseTransmissionFactor", 0.75}};
  const Material m = loaded();
  ASSERT_TRUE(m.clearcoat && m.sheen && m.anisotropy && m.specular && m.diffuse_transmission);
  EXPECT_EQ(m.clearcoat->factor, 0.5f);
  EXPECT_EQ(m.clearcoat->roughness, 0.0f);
  EXPECT_EQ(m.sheen->color_rec709, Vec3f(0.1f, 0.2f, 0.3f));
  EXPECT_EQ(m.sheen->roughness, 0.0f);
  EXPECT_EQ(m.anisotropy->strength, 0.6f);
  EXPECT_EQ(m.anisotropy->rotation_rad, 1.5f);
  EXPECT_EQ(m.specular->factor, 0.25f);
  EXPECT_EQ(m.specular->color_rec709, Vec3f(2.0f, 1.0f, 0.0f));
  EXPECT_EQ(m.diffuse_transmission->factor, 0.75f);
  EXPECT_EQ(m.diffuse_transmission->color_rec709, Vec3f(1.0f));
}

TEST_F(GltfLayers, specular_and_glossiness_keep_both_colours) {
  extension("KHR_materials_pbrSpecularGlossiness") = {{"diffuseFactor", {0.5, 0.4, 0.3, 0.2}},
                                                      {"specularFactor", {0.2, 0.04, 0.0}},
                                                      {"glossinessFactor", 0.75}};
  const Material m = loaded();
  EXPECT_EQ(m.base_color_rec709, Vec4f(0.5f, 0.4f, 0.3f, 0.2f));
  EXPECT_EQ(m.metallic, 0.0f);
  EXPECT_EQ(m.roughness, 0.25f);
  ASSERT_TRUE(m.specular);
  // Times 0.04, the reflectance of index 1.5, that is the factor.
  EXPECT_NEAR(m.specular->color_rec709.x, 5.0f, 1e-5f);
  EXPECT_NEAR(m.specular->color_rec709.y, 1.0f, 1e-6f);
  EXPECT_EQ(m.specular->color_rec709.z, 0.0f);
}

}  // namespace
}  // namespace abbe
