#include "abbe/load/gltf/layers.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <vector>

namespace abbe::gltf {
namespace {

constexpr Range kUnit{0.0, 1.0};
// A reflectance at normal incidence is limited to 1 whatever its factor; of an index near 1 it
// takes a large one to get there.
constexpr Range kSpecular{0.0, 1e6};
constexpr Range kTurns{-1e6, 1e6};

float unit(const Fields& extension, const char* name, double otherwise) {
  return static_cast<float>(extension.limited(name, otherwise, kUnit));
}

void read_clearcoat(const Fields& extension, Textures& textures, Material& material) {
  Clearcoat coat;
  coat.factor = unit(extension, "clearcoatFactor", 0.0);
  coat.factor_texture = textures.use(extension, "clearcoatTexture");
  coat.roughness = unit(extension, "clearcoatRoughnessFactor", 0.0);
  coat.roughness_texture = textures.use(extension, "clearcoatRoughnessTexture");
  if (const auto normal = extension.object("clearcoatNormalTexture")) {
    coat.normal_texture = textures.use(extension, "clearcoatNormalTexture");
    coat.normal_scale = static_cast<float>(normal->number("scale", 1.0, {-1e3, 1e3}));
  }
  if (coat.factor > 0.0f) material.clearcoat = coat;
}

void read_sheen(const Fields& extension, Textures& textures, Material& material) {
  Sheen sheen;
  sheen.color_rec709 = Vec3f(extension.limited_triple("sheenColorFactor", Vec3d(0.0), kUnit));
  sheen.color_texture = textures.use(extension, "sheenColorTexture");
  sheen.roughness = unit(extension, "sheenRoughnessFactor", 0.0);
  sheen.roughness_texture = textures.use(extension, "sheenRoughnessTexture");
  if (sheen.color_rec709 != Vec3f(0.0f)) material.sheen = sheen;
}

void read_anisotropy(const Fields& extension, Textures& textures, Material& material) {
  Anisotropy anisotropy;
  anisotropy.strength = unit(extension, "anisotropyStrength", 0.0);
  anisotropy.rotation_rad = static_cast<float>(extension.number("anisotropyRotation", 0.0, kTurns));
  anisotropy.texture = textures.use(extension, "anisotropyTexture");
  if (anisotropy.strength > 0.0f) material.anisotropy = anisotropy;
}

void read_specular(const Fields& extension, Textures& textures, Material& material) {
  SpecularPart specular;
  specular.factor = unit(extension, "specularFactor", 1.0);
  specular.factor_texture = textures.use(extension, "specularTexture");
  specular.color_rec709 =
      Vec3f(extension.limited_triple("specularColorFactor", Vec3d(1.0), kSpecular));
  specular.color_texture = textures.use(extension, "specularColorTexture");
  material.specular = specular;
}

void read_diffuse_transmission(const Fields& extension, Document& document, Textures& textures,
                               Material& material) {
  DiffuseTransmission through;
  through.factor = unit(extension, "diffuseTransmissionFactor", 0.0);
  through.factor_texture = textures.use(extension, "diffuseTransmissionTexture");
  through.color_rec709 =
      Vec3f(extension.limited_triple("diffuseTransmissionColorFactor", Vec3d(1.0), kUnit));
  through.color_texture = textures.use(extension, "diffuseTransmissionColorTexture");
  if (!(through.factor > 0.0f)) return;
  material.diffuse_transmission = through;
  if (material.has_volume && material.transmission == 0.0f) {
    document.notes().warn(extension.where("diffuseTransmissionFactor"),
                          "light is not scattered inside the volume: it comes through the surface "
                          "as through a thin sheet");
  }
}

}  // namespace

void read_layers(const Fields& extensions, Document& document, Textures& textures,
                 Material& material) {
  if (const auto extension = extensions.object("KHR_materials_clearcoat")) {
    read_clearcoat(*extension, textures, material);
  }
  if (const auto extension = extensions.object("KHR_materials_sheen")) {
    read_sheen(*extension, textures, material);
  }
  if (const auto extension = extensions.object("KHR_materials_anisotropy")) {
    read_anisotropy(*extension, textures, material);
  }
  if (const auto extension = extensions.object("KHR_materials_specular")) {
    read_specular(*extension, textures, material);
  }
  if (const auto extension = extensions.object("KHR_materials_diffuse_transmission")) {
    read_diffuse_transmission(*extension, document, textures, material);
  }
}

void read_specular_glossiness(const Fields& extensions, Document& document, Textures& textures,
                              Material& material) {
  const auto extension = extensions.object("KHR_materials_pbrSpecularGlossiness");
  if (!extension) return;
  material.base_color_rec709 = Vec4f(1.0f);
  if (extension->has("diffuseFactor")) {
    std::array<double, 4> factor{};
    const std::vector<double> values = extension->numbers("diffuseFactor", 4, 4, {-1e6, 1e6});
    std::copy(values.begin(), values.end(), factor.begin());
    limit_all(factor, kUnit, extension->where("diffuseFactor"), document.notes());
    material.base_color_rec709 = Vec4f(Vec4d(factor[0], factor[1], factor[2], factor[3]));
  }
  material.base_color_texture = textures.use(*extension, "diffuseTexture");
  material.metallic = 0.0f;
  material.metallic_roughness_texture.reset();
  material.roughness = 1.0f - unit(*extension, "glossinessFactor", 1.0);
  material.glossiness_texture = textures.use(*extension, "specularGlossinessTexture");
  SpecularPart specular;
  constexpr double kNormalReflectance = 0.04;  // Of index 1.5.
  specular.color_rec709 =
      Vec3f(extension->limited_triple("specularFactor", Vec3d(1.0), kUnit) / kNormalReflectance);
  specular.color_texture = material.glossiness_texture;
  material.specular = specular;
  material.index = ConstantIndex{1.5};
  document.notes().info(document.where(extension->pointer()),
                        "specular and glossiness are rendered as index 1.5 with a specular colour");
}

}  // namespace abbe::gltf
