#include "abbe/world/materials.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "abbe/base/constants.h"

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

Spectrum with_luminance(const Spectrum& spectrum, double luminance, const Observer& observer) {
  const double own = xyz_of(spectrum, observer).y;
  return own > 0.0 ? spectrum.scaled(luminance / own) : Spectrum();
}

// A texture image may be used both as colour and as data: one WorldTexture for each.
class TexturePool {
 public:
  TexturePool(const Scene& scene, World& world) : scene_(scene), world_(world) {}

  std::optional<TextureUse> use(const std::optional<TextureUse>& source, TextureEncoding encoding) {
    if (!source) return std::nullopt;
    const auto key = std::make_pair(source->texture, encoding);
    auto found = index_.find(key);
    if (found == index_.end()) {
      const Texture& texture = scene_.textures[source->texture];
      found = index_.emplace(key, static_cast<std::uint32_t>(world_.textures.size())).first;
      world_.textures.emplace_back(scene_.images[texture.image], texture, encoding,
                                   scene_.color_space);
    }
    TextureUse result = *source;
    result.texture = found->second;
    return result;
  }

 private:
  const Scene& scene_;
  World& world_;
  std::map<std::pair<std::uint32_t, TextureEncoding>, std::uint32_t> index_;
};

SurfaceMaterial tabulated(const Material& source, World& world, TexturePool& textures) {
  const LaneModel& lanes = world.lanes;
  SurfaceMaterial material;
  material.name = source.name;
  material.base_color_rec709 = source.base_color_rec709;
  material.base_color_texture = textures.use(source.base_color_texture, TextureEncoding::Srgb);
  material.metallic_roughness_texture =
      textures.use(source.metallic_roughness_texture, TextureEncoding::Data);
  material.normal_texture = textures.use(source.normal_texture, TextureEncoding::Data);
  material.transmission_texture = textures.use(source.transmission_texture, TextureEncoding::Data);
  material.normal_scale = source.normal_scale;
  material.metallic = source.metallic;
  material.roughness = source.roughness;
  material.alpha_mode = source.alpha_mode;
  material.alpha_cutoff = source.alpha_cutoff;
  material.unlit = source.unlit;
  material.index_is_infinite = source.index_is_infinite;
  if (source.ambient_factor) material.ambient_factor = static_cast<float>(*source.ambient_factor);

  Reflectance base = RgbRec709{Vec3d(Vec3f(source.base_color_rec709))};
  if (source.reflectance) {
    base = source.reflectance->spectrum;
    material.base_color_is_spectrum = true;
  }
  if (source.conductor) {
    material.metallic = 1.0f;
    if (!lanes.is_rgb(Cause::Fresnel)) {
      material.is_conductor = true;
      material.conductor_n = append_row(world, lanes.quantity(source.conductor->n));
      material.conductor_k = append_row(world, lanes.quantity(source.conductor->k));
    }
    base = normal_reflectance(*source.conductor);
    material.base_color_is_spectrum = true;
    material.metallic_roughness_texture.reset();
  }
  material.base_color = append_row(
      world, lanes.reflectance(base, source.conductor ? Cause::Fresnel : Cause::Reflectances));

  material.index = append_row(world, lanes.index(source.index));
  if (source.transmission > 0.0f && !source.conductor) {
    material.transmission_factor = source.transmission;
    material.transmission = source.has_volume ? Transmission::Medium : Transmission::ThinSheet;
  }
  if (material.transmission == Transmission::Medium) {
    if (source.absorption_per_m) {
      material.absorption_per_m = append_row(world, lanes.absorption(*source.absorption_per_m));
    } else if (std::isfinite(source.attenuation_distance_m) &&
               source.attenuation_color_rec709 != Vec3d(1.0)) {
      material.absorption_per_m = append_row(
          world, lanes.attenuation(source.attenuation_color_rec709, source.attenuation_distance_m));
    }
  }

  if (source.film && source.film->factor > 0.0f && !source.unlit) {
    SurfaceMaterial::Film film;
    film.index = append_row(world, lanes.index(source.film->index));
    film.factor = source.film->factor;
    film.factor_texture = textures.use(source.film->factor_texture, TextureEncoding::Data);
    film.thickness_texture = textures.use(source.film->thickness_texture, TextureEncoding::Data);
    film.thickness_min_nm = source.film->thickness_min_nm;
    film.thickness_max_nm = source.film->thickness_max_nm;
    material.film = film;
  }

  if (source.emission) {
    material.emission_is_spectrum = true;
    material.emission = append_row(
        world,
        lanes.emission(with_luminance(source.emission->spectrum.spectrum,
                                      source.emission->luminance_cd_per_m2, lanes.observer())));
  } else if (source.emissive_rec709 != Vec3f(0.0f)) {
    material.emissive_rec709 = source.emissive_rec709;
    material.emission = append_row(world, lanes.emission(RgbRec709{Vec3d(source.emissive_rec709)}));
  }
  if (material.emission) {
    material.emissive_texture = textures.use(source.emissive_texture, TextureEncoding::Srgb);
    material.emission_is_textured = material.emissive_texture.has_value();
  }
  if (source.unlit) {
    // What an unlit surface shows is its base colour as light.
    material.emission =
        append_row(world, lanes.emission(RgbRec709{Vec3d(Vec3f(source.base_color_rec709))}));
    material.emissive_rec709 = Vec3f(source.base_color_rec709);
    material.emissive_texture = material.base_color_texture;
    material.emission_is_textured = material.emissive_texture.has_value();
  }
  return material;
}

}  // namespace

RowId append_row(World& world, const std::vector<float>& row) {
  const RowId id = static_cast<RowId>(world.rows.size());
  world.rows.insert(world.rows.end(), row.begin(), row.end());
  return id;
}

void tabulate_materials(const Scene& scene, World& world) {
  TexturePool textures(scene, world);
  world.d65 = append_row(world, world.lanes.emission(world.lanes.d65()));
  world.inverse_wavelength = append_row(world, world.lanes.inverse_wavelength());
  world.uplift_abscissa = append_row(world, world.lanes.uplift_abscissa());
  for (std::size_t i = 0; world.lanes.uplift() == Uplift::MallettYuksel && i < 3; ++i) {
    world.uplift_basis[i] = append_row(world, world.lanes.uplift_basis(static_cast<int>(i)));
  }
  for (const Material& material : scene.materials) {
    world.materials.push_back(tabulated(material, world, textures));
    if (material.emission && !material.emission->spectrum.id.empty()) {
      world.lamp_ids.push_back(material.emission->spectrum.id);
    }
  }
}

void tabulate_lights(const Scene& scene, World& world) {
  const LaneModel& lanes = world.lanes;
  for (const Light& source : scene.lights) {
    WorldLight light;
    light.name = source.name;
    light.type = source.type;
    light.position = Vec3f(Vec3d(source.to_world[3]));
    light.direction = Vec3f(glm::normalize(Vec3d(source.to_world * Vec4d(0.0, 0.0, -1.0, 0.0))));
    if (source.beam) {
      light.is_beam = true;
      light.beam_x = Vec3f(glm::normalize(Vec3d(source.to_world[0])));
      light.beam_y = Vec3f(glm::normalize(Vec3d(source.to_world[1])));
      light.beam_half_x_m = static_cast<float>(0.5 * source.beam->width_m);
      light.beam_half_y_m = static_cast<float>(0.5 * source.beam->height_m);
    }
    if (std::isfinite(source.range_m) && source.range_m > 0.0) {
      light.range_m = static_cast<float>(source.range_m);
    }
    if (source.type == LightType::Spot) {
      const double cos_outer = std::cos(source.outer_cone_rad);
      const double scale = 1.0 / std::max(0.001, std::cos(source.inner_cone_rad) - cos_outer);
      light.spot_scale = static_cast<float>(scale);
      light.spot_offset = static_cast<float>(-cos_outer * scale);
    }
    if (source.spectrum) {
      if (!source.spectrum->id.empty()) world.lamp_ids.push_back(source.spectrum->id);
      light.row =
          append_row(world, lanes.emission(with_luminance(source.spectrum->spectrum,
                                                          source.intensity, lanes.observer())));
    } else {
      light.row =
          append_row(world, lanes.emission(RgbRec709{source.color_rec709 * source.intensity}));
    }
    world.lights.push_back(std::move(light));
  }
  if (scene.fog && scene.fog->extinction_per_m > 0.0) {
    world.fog = WorldFog{static_cast<float>(scene.fog->extinction_per_m),
                         append_row(world, lanes.reflectance(scene.fog->albedo))};
  }
  if (scene.ambient && scene.ambient->luminance_cd_per_m2 > 0.0) {
    if (!scene.ambient->spectrum.id.empty()) {
      world.lamp_ids.push_back(scene.ambient->spectrum.id);
    }
    world.ambient = append_row(world, lanes.emission(with_luminance(
                                          scene.ambient->spectrum.spectrum,
                                          scene.ambient->luminance_cd_per_m2, lanes.observer())));
  }
  std::sort(world.lamp_ids.begin(), world.lamp_ids.end());
  world.lamp_ids.erase(std::unique(world.lamp_ids.begin(), world.lamp_ids.end()),
                       world.lamp_ids.end());
}

std::vector<Spectrum> lamp_spectra(const Scene& scene, const Spectrum& d65) {
  std::vector<Spectrum> lamps;
  bool uses_d65 = false;
  for (const Light& light : scene.lights) {
    if (light.spectrum) {
      lamps.push_back(light.spectrum->spectrum);
    } else {
      uses_d65 = true;  // An RGB colour is a smooth reflectance under D65.
    }
  }
  for (const Material& material : scene.materials) {
    if (material.emission) {
      lamps.push_back(material.emission->spectrum.spectrum);
    } else if (material.emissive_rec709 != Vec3f(0.0f) || material.unlit) {
      uses_d65 = true;
    }
  }
  if (scene.ambient) lamps.push_back(scene.ambient->spectrum.spectrum);
  if (uses_d65) lamps.push_back(d65);
  return lamps;
}

}  // namespace abbe
