#include "abbe/load/gltf/materials.h"

#include <fmt/format.h>

#include <array>

#include "abbe/base/error.h"
#include "abbe/load/gltf/film.h"
#include "abbe/load/gltf/layers.h"

namespace abbe::gltf {
namespace {

constexpr Range kUnit{0.0, 1.0};
// The sun's disc has 1.6e9 cd/m²; 1000 times that still leaves single precision its head-room.
constexpr double kBrightest_cd_per_m2 = 1e12;

void read_base_color(const Fields& pbr, Notes& notes, Material& material) {
  if (!pbr.has("baseColorFactor")) return;
  std::array<double, 4> factor{};
  for (std::size_t c = 0; c < 4; ++c) factor[c] = pbr.at("baseColorFactor")[c].get<double>();
  // Above 1 a surface would give back more light than it gets.
  limit_all(factor, kUnit, pbr.where("baseColorFactor"), notes);
  material.base_color_rec709 = Vec4f(Vec4d(factor[0], factor[1], factor[2], factor[3]));
}

void read_alpha(const Fields& source, Notes& notes, Material& material) {
  if (source.has("alphaMode")) {
    const std::string mode = source.required_text("alphaMode");
    if (mode == "MASK") {
      material.alpha_mode = AlphaMode::Mask;
    } else if (mode == "BLEND") {
      material.alpha_mode = AlphaMode::Blend;
    } else if (mode != "OPAQUE") {
      notes.warn(source.where("alphaMode"),
                 "\"" + mode + "\" is none of OPAQUE, MASK and BLEND; OPAQUE is used");
    }
  }
  material.alpha_cutoff = static_cast<float>(source.limited("alphaCutoff", 0.5, {0.0, 1e6}));
  material.double_sided = source.has("doubleSided") && source.at("doubleSided").get<bool>();
}

void read_emissive(const Fields& source, const std::optional<Fields>& extensions, Notes& notes,
                   Textures& textures, Material& material) {
  const Vec3d factor =
      source.limited_triple("emissiveFactor", Vec3d(0.0), {0.0, kBrightest_cd_per_m2});
  double strength = 1.0;
  if (extensions) {
    if (const auto extension = extensions->object("KHR_materials_emissive_strength")) {
      strength = extension->limited("emissiveStrength", 1.0, {0.0});
    }
  }
  Vec3d emitted = strength * factor;
  limit_all({&emitted[0], 3}, {0.0, kBrightest_cd_per_m2}, source.where("emissiveFactor"), notes);
  material.emissive_rec709 = Vec3f(emitted);
  material.emissive_texture = textures.use(source, "emissiveTexture");
}

void read_index(const Fields& extensions, Document& document, Material& material) {
  double n_d = 1.5;
  if (const auto extension = extensions.object("KHR_materials_ior")) {
    n_d = extension->number("ior", 1.5, {0.0});
    if (n_d == 0.0) {
      material.index_is_infinite = true;
      return;
    }
    if (n_d < 1.0) {
      document.fault(extension->pointer("ior"), fmt::format("{:g}", n_d), "0 or at least 1",
                     "1 is used");
      n_d = 1.0;
    }
    constexpr double kLargestIndex = 1000.0;  // As refractive_index() limits it.
    n_d = limit(n_d, {1.0, kLargestIndex}, extension->where("ior"), document.notes());
  }
  material.index = ConstantIndex{n_d};
  if (const auto extension = extensions.object("KHR_materials_dispersion")) {
    const double dispersion = extension->number("dispersion", 0.0, {0.0, 1e6});
    if (dispersion > 0.0) material.index = AbbeNumber{n_d, 20.0 / dispersion};
  }
}

void read_volume(const Fields& extensions, Document& document, Material& material) {
  const auto extension = extensions.object("KHR_materials_volume");
  if (!extension) return;
  const double thickness = extension->number("thicknessFactor", 0.0, {0.0});
  // The rest of the extension describes a medium, and a thin wall encloses none.
  material.has_volume = thickness > 0.0;
  material.attenuation_color_rec709 =
      extension->limited_triple("attenuationColor", Vec3d(1.0), kUnit);
  if (extension->has("attenuationDistance")) {
    const double distance_m = finite_number(extension->at("attenuationDistance"),
                                            extension->where("attenuationDistance"), {0.0});
    if (distance_m > 0.0) {
      material.attenuation_distance_m = distance_m;
    } else {
      document.fault(extension->pointer("attenuationDistance"), "0", "a number above 0",
                     "nothing is absorbed");
    }
  }
  if (material.transmission == 0.0f && !extensions.has("ABBE_material")) {
    document.notes().warn(
        extension->where("thicknessFactor"),
        "a volume shows only with KHR_materials_transmission; the surface is opaque");
  }
}

}  // namespace

Material read_material(Document& document, std::size_t index, Textures& textures,
                       Spectra& spectra) {
  const Json& json = document.json()["materials"][index];
  const std::string pointer = fmt::format("/materials/{}", index);
  const Fields source(document, json, pointer);
  Notes& notes = document.notes();

  Material material;
  material.name =
      source.has("name") ? source.required_text("name") : fmt::format("material {}", index);
  if (const auto pbr = source.object("pbrMetallicRoughness")) {
    read_base_color(*pbr, notes, material);
    material.metallic = static_cast<float>(pbr->limited("metallicFactor", 1.0, kUnit));
    material.roughness = static_cast<float>(pbr->limited("roughnessFactor", 1.0, kUnit));
    material.base_color_texture = textures.use(*pbr, "baseColorTexture");
    material.metallic_roughness_texture = textures.use(*pbr, "metallicRoughnessTexture");
  }
  if (const auto normal = source.object("normalTexture")) {
    material.normal_texture = textures.use(source, "normalTexture");
    material.normal_scale = static_cast<float>(normal->number("scale", 1.0, {-1e3, 1e3}));
  }
  read_alpha(source, notes, material);

  const auto extensions = source.object("extensions");
  read_emissive(source, extensions, notes, textures, material);
  if (!extensions) return material;
  material.unlit = extensions->has("KHR_materials_unlit");
  if (const auto extension = extensions->object("KHR_materials_transmission")) {
    material.transmission =
        static_cast<float>(extension->limited("transmissionFactor", 0.0, kUnit));
    material.transmission_texture = textures.use(*extension, "transmissionTexture");
  }
  read_index(*extensions, document, material);
  read_volume(*extensions, document, material);
  read_iridescence(*extensions, document, textures, material);
  read_specular_glossiness(*extensions, document, textures, material);
  read_layers(*extensions, document, textures, material);
  if (const auto extension = extensions->object("ABBE_material")) {
    apply_abbe_material(document, *extension, json, spectra, material);
  }
  return material;
}

}  // namespace abbe::gltf
