/// Materials of a scene, ready to shade.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "abbe/scene/scene.h"
#include "abbe/world/lanes.h"
#include "abbe/world/rows.h"
#include "abbe/world/texture.h"

namespace abbe {

/// Materials a scene may have: fans keep the media they are in as 16-bit numbers.
inline constexpr std::size_t kMaxMaterials = 65535;

/// How a surface bounds the space behind it.
enum class Transmission : std::uint8_t {
  None,       ///< Opaque.
  ThinSheet,  ///< Infinitely thin: tints, does not refract.
  Medium,     ///< The boundary of a medium.
};

/// A colour that a factor and a texture make. Colours above 1 are `scale` times one within.
struct ColorUse {
  Vec3f factor_rec709{1.0f};
  std::optional<TextureUse> texture;
  float scale = 1.0f;
  RowId row = 0;  ///< Of the untextured factor, over `scale`.
};

/// What a material has beyond base, metal, transmission and film: as in the scene, but for colours.
struct SurfaceLayers {
  std::optional<Clearcoat> coat;
  struct Fibres {
    ColorUse color;
    float roughness = 0.0f;
    std::optional<TextureUse> roughness_texture;
  };
  std::optional<Fibres> sheen;
  std::optional<Anisotropy> anisotropy;
  struct Dielectric {
    float factor = 1.0f;
    std::optional<TextureUse> factor_texture;
    ColorUse color;
  };
  std::optional<Dielectric> specular;
  struct Through {
    float factor = 0.0f;
    std::optional<TextureUse> factor_texture;
    ColorUse color;
  };
  std::optional<Through> through;

  bool is_textured() const {
    return (coat && (coat->factor_texture || coat->roughness_texture)) ||
           (sheen && (sheen->color.texture || sheen->roughness_texture)) ||
           (anisotropy && anisotropy->texture) ||
           (specular && (specular->factor_texture || specular->color.texture)) ||
           (through && (through->factor_texture || through->color.texture));
  }
};

/// A material ready to shade. Rows hold one value per lane.
struct SurfaceMaterial {
  std::string name;
  RowId base_color = 0;  ///< Of the untextured factor.
  Vec4f base_color_rec709{1.0f};
  bool base_color_is_spectrum = false;  ///< A measured reflectance: textures multiply it.
  std::optional<TextureUse> base_color_texture, metallic_roughness_texture, normal_texture,
      emissive_texture, transmission_texture, glossiness_texture;
  float normal_scale = 1.0f;
  float metallic = 0.0f;
  float roughness = 1.0f;
  float transmission_factor = 0.0f;
  Transmission transmission = Transmission::None;
  AlphaMode alpha_mode = AlphaMode::Opaque;
  float alpha_cutoff = 0.5f;
  bool unlit = false;
  bool is_front_only = false;  ///< Triangles are not there for rays from behind, nor shine there.

  std::optional<RowId> emission;
  Vec3f emissive_rec709{0.0f};  ///< For textured emission.
  bool emission_is_textured = false;
  bool emission_is_spectrum = false;  ///< A lamp's spectrum: textures multiply it.
  bool lights_others = false;         ///< What it emits lights other surfaces.

  RowId index = 0;  ///< n per lane.
  bool index_is_infinite = false;
  std::optional<RowId> absorption_per_m;  ///< Of the medium inside; absent when clear.

  bool is_conductor = false;  ///< Exact Fresnel with n and k; otherwise Schlick's with base colour.
  RowId conductor_n = 0, conductor_k = 0;
  /// In RGB modes conductors have their colour at normal incidence here, as base_color.

  /// A thin layer on the surface; its textures change factor and thickness.
  struct Film {
    RowId index = 0;  ///< n per lane.
    float factor = 1.0f;
    float thickness_min_nm = 0.0f, thickness_max_nm = 0.0f;
    std::optional<TextureUse> factor_texture, thickness_texture;
  };
  std::optional<Film> film;
  std::optional<SurfaceLayers> layers;  ///< Absent where there is nothing in it.

  std::optional<float> ambient_factor;

  std::int16_t priority = 0;  ///< Where bodies overlap, the highest owns the space.

  bool is_textured() const {
    return base_color_texture || metallic_roughness_texture || transmission_texture ||
           emissive_texture || glossiness_texture || (layers && layers->is_textured()) ||
           (film && (film->factor_texture || film->thickness_texture));
  }
  bool coat_has_own_normal() const {
    return layers && layers->coat && (layers->coat->normal_texture || normal_texture);
  }
  /// Whether points need a direction along the surface, or a normal besides the shading normal.
  bool needs_frame() const { return layers && (layers->anisotropy || coat_has_own_normal()); }
  /// Whether it is the boundary of a medium everywhere, and nothing else.
  bool bounds_clear_medium() const {
    return transmission == Transmission::Medium && alpha_mode == AlphaMode::Opaque && !unlit &&
           !index_is_infinite && !layers;
  }
  bool lets_light_pass() const {
    return transmission != Transmission::None || alpha_mode != AlphaMode::Opaque;
  }
};

/// Materials, numbered as in the scene, and the textures that they name.
struct Materials {
  std::vector<SurfaceMaterial> surfaces;
  std::vector<WorldTexture> textures;
};

/// The materials of a scene, their spectra added to `rows`.
/// Errors: an input Error that names the scene where it has more than kMaxMaterials.
Materials tabulate_materials(const Scene& scene, const LaneModel& lanes, Rows& rows);

}  // namespace abbe
