#include "abbe/integrate/surface/material_sample.h"

#include <algorithm>

#include "abbe/color/uplift/uplift.h"

namespace abbe {
namespace {

Vec4f texel(const World& world, const TextureUse& use, const SurfacePoint& point,
            float footprint_m) {
  const float footprint_uv = footprint_m * point.uv_per_m[use.uv_set];
  return world.textures[use.texture].value(transformed_uv(use, point.uv[use.uv_set]), footprint_uv);
}

// Everything that multiplies the base colour at this place; the factor's alpha included.
Vec4f base_modulation(const World& world, const SurfaceMaterial& material,
                      const SurfacePoint& point, float footprint_m) {
  Vec4f value = point.color_rec709;
  if (material.base_color_texture) {
    value *= texel(world, *material.base_color_texture, point, footprint_m);
  }
  return value;
}

void look_up(const Vec3f& rec709, bool is_rgb, ColorSample& color) {
  color.uses_lookup = true;
  color.lookup_is_rgb = is_rgb;
  color.lookup_rec709 = is_rgb ? glm::clamp(rec709, 0.0f, 1.0f) : rec709;
}

// What is as large as the cutoff at every corner may be less between them, by the roundings of the
// weights, their sum and the products with factors.
constexpr float kRoundings = 1e-6f;

float coverage(const SurfaceMaterial& material, float alpha) {
  switch (material.alpha_mode) {
    case AlphaMode::Opaque:
      return 1.0f;
    case AlphaMode::Mask:
      return alpha >= (1.0f - kRoundings) * material.alpha_cutoff ? 1.0f : 0.0f;
    case AlphaMode::Blend:
      break;
  }
  return std::clamp(alpha, 0.0f, 1.0f);
}

}  // namespace

Vec3f looked_up(const World& world, const ColorSample& color) {
  if (color.lookup_is_rgb) return color.lookup_rec709;
  return world.lanes.uplift() == Uplift::JakobHanika ? uplift_rec709_from_table(color.lookup_rec709)
                                                     : glm::clamp(color.lookup_rec709, 0.0f, 1.0f);
}

MaterialSample material_sample(const World& world, const SurfaceMaterial& material,
                               const SurfacePoint& point, float footprint_m) {
  MaterialSample sample;
  sample.metallic = material.metallic;
  sample.roughness = material.roughness;
  sample.transmission = material.transmission_factor;

  const Surface& surface = world.geometry.surfaces[point.surface];
  const bool modulated = material.base_color_texture || surface.colors_offset;
  Vec4f modulation(1.0f);
  if (modulated) {
    modulation = base_modulation(world, material, point, footprint_m);
    const Vec3f factor =
        material.base_color_is_spectrum ? Vec3f(1.0f) : Vec3f(material.base_color_rec709);
    sample.base_color.uses_row = material.base_color_is_spectrum;
    look_up(factor * Vec3f(modulation), world.lanes.is_rgb(Cause::Reflectances), sample.base_color);
  }
  sample.alpha = coverage(material, material.base_color_rec709.w * modulation.w);

  if (material.metallic_roughness_texture) {
    const Vec4f value = texel(world, *material.metallic_roughness_texture, point, footprint_m);
    sample.roughness *= value.y;
    sample.metallic *= value.z;
  }
  if (material.glossiness_texture) {
    const float glossiness = texel(world, *material.glossiness_texture, point, footprint_m).w;
    sample.roughness = 1.0f - (1.0f - sample.roughness) * glossiness;
  }
  if (material.transmission_texture) {
    sample.transmission *= texel(world, *material.transmission_texture, point, footprint_m).x;
  }
  if (material.film) {
    const SurfaceMaterial::Film& film = *material.film;
    sample.film_factor = film.factor;
    sample.film_thickness_nm = film.thickness_max_nm;
    if (film.factor_texture) {
      sample.film_factor *= texel(world, *film.factor_texture, point, footprint_m).x;
    }
    if (film.thickness_texture) {
      const float mix = texel(world, *film.thickness_texture, point, footprint_m).y;
      sample.film_thickness_nm =
          film.thickness_min_nm + mix * (film.thickness_max_nm - film.thickness_min_nm);
    }
  }
  if (material.emission_is_textured || (material.unlit && modulated)) {
    const Vec3f factor = material.unlit
                             ? Vec3f(modulation)
                             : Vec3f(texel(world, *material.emissive_texture, point, footprint_m));
    const Vec3f emitted_rec709 =
        material.emission_is_spectrum ? factor : material.emissive_rec709 * factor;
    sample.emission.uses_row = material.emission_is_spectrum;
    if (material.emission_is_spectrum) {
      look_up(emitted_rec709, world.lanes.is_rgb(Cause::Reflectances), sample.emission);
    } else if (world.lanes.is_rgb(Cause::Lamps)) {
      sample.emission.uses_lookup = true;
      sample.emission.lookup_is_rgb = true;
      sample.emission.lookup_rec709 = glm::max(emitted_rec709, 0.0f);
    } else {
      // The scale rule for unbounded colours: see uplift_emission.
      const float scale =
          2.0f * std::max({emitted_rec709.x, emitted_rec709.y, emitted_rec709.z, 0.0f});
      sample.emission_scale = scale;
      look_up(scale > 0.0f ? emitted_rec709 / scale : Vec3f(0.0f), false, sample.emission);
    }
  }
  return sample;
}

LayerSample layer_sample(const World& world, const SurfaceMaterial& material,
                         const SurfacePoint& point, float footprint_m) {
  const SurfaceLayers& layers = *material.layers;
  const auto texel_of = [&](const std::optional<TextureUse>& use) {
    return use ? texel(world, *use, point, footprint_m) : Vec4f(1.0f);
  };
  const auto color_of = [&](const ColorUse& use, ColorSample& color) {
    if (!use.texture) return use.factor_rec709;
    const Vec3f rec709 = use.factor_rec709 * Vec3f(texel_of(use.texture));
    color.uses_row = false;
    look_up(rec709 / use.scale, world.lanes.is_rgb(Cause::Reflectances), color);
    return rec709;
  };
  LayerSample sample;
  if (layers.coat) {
    sample.coat = layers.coat->factor * texel_of(layers.coat->factor_texture).x;
    sample.coat_roughness = layers.coat->roughness * texel_of(layers.coat->roughness_texture).y;
  }
  if (layers.sheen) {
    const Vec3f rec709 = color_of(layers.sheen->color, sample.sheen);
    sample.sheen_most = std::max({rec709.x, rec709.y, rec709.z});
    sample.sheen_roughness = layers.sheen->roughness * texel_of(layers.sheen->roughness_texture).w;
  }
  if (layers.anisotropy) {
    const Anisotropy& anisotropy = *layers.anisotropy;
    Vec2f direction(1.0f, 0.0f);
    sample.anisotropy = anisotropy.strength;
    if (anisotropy.texture) {
      const Vec4f value = texel_of(anisotropy.texture);
      const Vec2f mapped = 2.0f * Vec2f(value) - 1.0f;
      const float length = std::sqrt(glm::dot(mapped, mapped));
      if (length > 0.0f) direction = mapped / length;
      sample.anisotropy *= value.z;
    }
    const float c = std::cos(anisotropy.rotation_rad), s = std::sin(anisotropy.rotation_rad);
    sample.direction = {c * direction.x - s * direction.y, s * direction.x + c * direction.y};
  }
  if (layers.specular) {
    sample.specular = layers.specular->factor * texel_of(layers.specular->factor_texture).w;
    const Vec3f rec709 = color_of(layers.specular->color, sample.specular_color);
    sample.specular_most = std::max({rec709.x, rec709.y, rec709.z});
  }
  if (layers.through) {
    sample.through = layers.through->factor * texel_of(layers.through->factor_texture).w;
    color_of(layers.through->color, sample.through_color);
  }
  return sample;
}

Vec3f base_color_rec709(const World& world, const SurfaceMaterial& material,
                        const SurfacePoint& point, float footprint_m) {
  return Vec3f(material.base_color_rec709) *
         Vec3f(base_modulation(world, material, point, footprint_m));
}

}  // namespace abbe
