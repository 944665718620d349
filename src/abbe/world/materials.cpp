#include "abbe/world/materials.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <memory>
#include <tuple>
#include <utility>

#include "abbe/base/constants.h"
#include "abbe/base/error.h"

namespace abbe {
namespace {

// Reflectance at normal incidence of a metal in air: the F0 that the RGB modes use.
Spectrum normal_reflectance(const Conductor& conductor) {
  std::vector<double> nm, values;
  for (double x = kRangeMin_nm; x <= kRangeMax_nm; x += 1.0) {
    const double n = conductor.n.value(x);
    const double k = conductor.k.value(x);
    nm.push_back(x);
    values.push_back(((n - 1.0) * (n - 1.0) + k * k) / ((n + 1.0) * (n + 1.0) + k * k));
  }
  return Spectrum::tabulated(std::move(nm), std::move(values), OutsideTable::Clamp);
}

/// Makes materials one by one, and the textures that they share.
class Tabulator {
 public:
  Tabulator(const Scene& scene, const LaneModel& lanes, Rows& rows)
      : scene_(scene), lanes_(lanes), rows_(rows) {}

  SurfaceMaterial material(const Material& source) {
    SurfaceMaterial material;
    material.name = source.name;
    material.base_color_rec709 = source.base_color_rec709;
    material.base_color_texture = use(source.base_color_texture, TextureEncoding::Srgb);
    material.metallic_roughness_texture =
        use(source.metallic_roughness_texture, TextureEncoding::Data);
    material.normal_texture = use(source.normal_texture, TextureEncoding::Data);
    material.transmission_texture = use(source.transmission_texture, TextureEncoding::Data);
    material.glossiness_texture = use(source.glossiness_texture, TextureEncoding::Data);
    material.normal_scale = source.normal_scale;
    material.metallic = source.metallic;
    material.roughness = source.roughness;
    material.alpha_mode = source.alpha_mode;
    material.alpha_cutoff = source.alpha_cutoff;
    material.unlit = source.unlit;
    material.index_is_infinite = source.index_is_infinite;
    material.priority = source.priority;
    if (source.ambient_factor) material.ambient_factor = static_cast<float>(*source.ambient_factor);
    if (source.conductor) {
      material.metallic = 1.0f;
      material.metallic_roughness_texture.reset();
      material.is_conductor = !lanes_.is_rgb(Cause::Fresnel);
    }
    if (material.is_conductor) {
      material.conductor_n = rows_.add(lanes_.quantity(source.conductor->n));
      material.conductor_k = rows_.add(lanes_.quantity(source.conductor->k));
    }
    material.base_color_is_spectrum = source.reflectance || source.conductor;
    material.base_color = base_color(source);
    material.index = rows_.add(lanes_.index(source.index));
    // Metal lets nothing through.
    const bool is_metal = material.metallic >= 1.0f && !material.metallic_roughness_texture;
    if (source.transmission > 0.0f && !is_metal) {
      material.transmission_factor = source.transmission;
      material.transmission = source.has_volume ? Transmission::Medium : Transmission::ThinSheet;
    }
    if (material.transmission == Transmission::Medium) {
      material.absorption_per_m = absorption(source);
    }
    material.film = film(source);
    material.layers = layers(source);
    add_emission(source, material);
    const bool is_asked = source.lights_others == LightsOthers::Auto
                              ? scene_.emissive_light
                              : source.lights_others == LightsOthers::Yes;
    material.lights_others = is_asked && material.emission && !material.unlit;
    material.is_front_only = source.is_front_only();
    return material;
  }

  std::vector<WorldTexture> take_textures() { return std::move(textures_); }

 private:
  // A texture image may be used both as colour and as data, and at several scales: one WorldTexture
  // for each, which share their texels.
  std::optional<TextureUse> use(const std::optional<TextureUse>& source, TextureEncoding encoding) {
    if (!source) return std::nullopt;
    const float scale = uv_scale(*source);
    const auto [found, is_new] =
        texture_number_.try_emplace({source->texture, encoding, scale}, textures_.size());
    if (is_new) {
      const Texture& texture = scene_.textures[source->texture];
      const bool has_mipmaps = texture.filter == TextureFilter::Linear;
      std::shared_ptr<const TexturePyramid>& pyramid =
          pyramids_[{texture.image, encoding, has_mipmaps}];
      if (!pyramid) {
        pyramid = std::make_shared<const TexturePyramid>(scene_.images[texture.image], encoding,
                                                         has_mipmaps);
      }
      textures_.emplace_back(pyramid, texture, encoding, scene_.color_space, scale);
    }
    TextureUse result = *source;
    result.texture = static_cast<std::uint32_t>(found->second);
    return result;
  }

  RowId base_color(const Material& source) {
    if (source.conductor) {
      return rows_.add(lanes_.reflectance(normal_reflectance(*source.conductor), Cause::Fresnel));
    }
    if (source.reflectance) return rows_.add(lanes_.reflectance(source.reflectance->spectrum));
    return rows_.add(lanes_.reflectance(RgbRec709{Vec3d(Vec3f(source.base_color_rec709))}));
  }

  std::optional<RowId> absorption(const Material& source) {
    if (source.absorption_per_m) return rows_.add(lanes_.absorption(*source.absorption_per_m));
    if (!std::isfinite(source.attenuation_distance_m) ||
        source.attenuation_color_rec709 == Vec3d(1.0)) {
      return std::nullopt;
    }
    return rows_.add(
        lanes_.attenuation(source.attenuation_color_rec709, source.attenuation_distance_m));
  }

  std::optional<SurfaceMaterial::Film> film(const Material& source) {
    if (!source.film || !(source.film->factor > 0.0f) || source.unlit) return std::nullopt;
    return SurfaceMaterial::Film{
        .index = rows_.add(lanes_.index(source.film->index)),
        .factor = source.film->factor,
        .thickness_min_nm = source.film->thickness_min_nm,
        .thickness_max_nm = source.film->thickness_max_nm,
        .factor_texture = use(source.film->factor_texture, TextureEncoding::Data),
        .thickness_texture = use(source.film->thickness_texture, TextureEncoding::Data)};
  }

  ColorUse color(const Vec3f& factor_rec709, const std::optional<TextureUse>& texture) {
    ColorUse result;
    result.factor_rec709 = factor_rec709;
    result.texture = use(texture, TextureEncoding::Srgb);
    result.scale = std::max({1.0f, factor_rec709.x, factor_rec709.y, factor_rec709.z});
    result.row = rows_.add(lanes_.reflectance(RgbRec709{Vec3d(factor_rec709 / result.scale)}));
    return result;
  }

  std::optional<SurfaceLayers> layers(const Material& source) {
    if (source.unlit) return std::nullopt;
    SurfaceLayers layers;
    bool any = false;
    if (source.clearcoat && source.clearcoat->factor > 0.0f) {
      Clearcoat& coat = layers.coat.emplace(*source.clearcoat);
      coat.factor_texture = use(coat.factor_texture, TextureEncoding::Data);
      coat.roughness_texture = use(coat.roughness_texture, TextureEncoding::Data);
      coat.normal_texture = use(coat.normal_texture, TextureEncoding::Data);
      any = true;
    }
    if (source.sheen && source.sheen->color_rec709 != Vec3f(0.0f)) {
      layers.sheen = {
          .color = color(source.sheen->color_rec709, source.sheen->color_texture),
          .roughness = source.sheen->roughness,
          .roughness_texture = use(source.sheen->roughness_texture, TextureEncoding::Data)};
      any = true;
    }
    if (source.anisotropy && source.anisotropy->strength > 0.0f) {
      layers.anisotropy = source.anisotropy;
      layers.anisotropy->texture = use(source.anisotropy->texture, TextureEncoding::Data);
      any = true;
    }
    if (source.specular && !source.specular->is_plain() && !source.conductor) {
      layers.specular = {
          .factor = source.specular->factor,
          .factor_texture = use(source.specular->factor_texture, TextureEncoding::Data),
          .color = color(source.specular->color_rec709, source.specular->color_texture)};
      any = true;
    }
    if (source.diffuse_transmission && source.diffuse_transmission->factor > 0.0f) {
      const DiffuseTransmission& through = *source.diffuse_transmission;
      layers.through = {.factor = through.factor,
                        .factor_texture = use(through.factor_texture, TextureEncoding::Data),
                        .color = color(through.color_rec709, through.color_texture)};
      any = true;
    }
    return any ? std::optional(std::move(layers)) : std::nullopt;
  }

  void add_emission(const Material& source, SurfaceMaterial& material) {
    if (source.unlit) {
      // What an unlit surface shows is its base colour as light.
      material.emissive_rec709 = Vec3f(source.base_color_rec709);
      material.emissive_texture = material.base_color_texture;
    } else if (source.emission || source.emissive_rec709 != Vec3f(0.0f)) {
      material.emissive_texture = use(source.emissive_texture, TextureEncoding::Srgb);
      if (!source.emission) material.emissive_rec709 = source.emissive_rec709;
    } else {
      return;
    }
    material.emission_is_spectrum = source.emission.has_value();
    material.emission_is_textured = material.emissive_texture.has_value();
    material.emission =
        rows_.add(source.emission && !source.unlit
                      ? lanes_.emission(source.emission->spectrum.spectrum,
                                        source.emission->luminance_cd_per_m2)
                      : lanes_.emission(RgbRec709{Vec3d(material.emissive_rec709)}));
  }

  // By image, encoding and whether there are mipmaps: textures that differ in wrapping share.
  std::map<std::tuple<std::uint32_t, TextureEncoding, bool>, std::shared_ptr<const TexturePyramid>>
      pyramids_;
  const Scene& scene_;
  const LaneModel& lanes_;
  Rows& rows_;
  std::map<std::tuple<std::uint32_t, TextureEncoding, float>, std::size_t> texture_number_;
  std::vector<WorldTexture> textures_;
};

}  // namespace

Materials tabulate_materials(const Scene& scene, const LaneModel& lanes, Rows& rows) {
  if (scene.materials.size() > kMaxMaterials) {
    throw_input_error(scene.name, fmt::format("{} materials", scene.materials.size()),
                      fmt::format("at most {}", kMaxMaterials));
  }
  Tabulator tabulator(scene, lanes, rows);
  Materials result;
  for (const Material& material : scene.materials) {
    result.surfaces.push_back(tabulator.material(material));
  }
  result.textures = tabulator.take_textures();
  return result;
}

}  // namespace abbe
