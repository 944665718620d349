/// A material at one place: textures looked up, vertex colours applied.
#pragma once

#include <cmath>

#include "abbe/integrate/surface/point.h"
#include "abbe/world/world.h"

namespace abbe {

/// A colour at a place, not yet spread over lanes: the product of a tabulated row and of a
/// colour from textures and vertices, either of which may be missing.
struct ColorSample {
  bool uses_row = true;
  bool uses_lookup = false;
  bool lookup_is_rgb = false;  ///< The channels themselves, not a spectrum.
  Vec3f lookup_rec709{0.0f};   ///< Linear.
};

/// What the lanes need of a colour that uses a lookup: coefficients of its smooth reflectance
/// (color/uplift.h), or of Mallett and Yuksel's basis, or its channels. Channels of reflectances,
/// and the basis, know no colours beyond Rec.709.
Vec3f looked_up(const World& world, const ColorSample& color);

/// The value of a colour in one lane. `row` is the tabulated colour, for a ColorSample that uses
/// it, and `lookup` what looked_up() gives, for one that uses a lookup.
inline float lane_value(const World& world, const ColorSample& color, const Vec3f& lookup,
                        const float* row, int set, int lane) {
  const float value = color.uses_row ? row[lane] : 1.0f;
  if (!color.uses_lookup) return value;
  if (color.lookup_is_rgb) return value * lookup[world.lanes.channel_of(lane)];
  if (world.lanes.uplift() == Uplift::MallettYuksel) {
    float sum = 0.0f;
    for (int i = 0; i < 3; ++i) {
      sum += lookup[i] * world.row(world.uplift_basis[static_cast<std::size_t>(i)], set)[lane];
    }
    return value * sum;
  }
  const float s = world.row(world.uplift_abscissa, set)[lane];
  const float x = (lookup.x * s + lookup.y) * s + lookup.z;
  return value * (0.5f + 0.5f * (x / std::sqrt(1.0f + x * x)));
}

/// A material at a place.
struct MaterialSample {
  ColorSample base_color;
  ColorSample emission;         ///< Its row is SurfaceMaterial::emission.
  float emission_scale = 1.0f;  ///< Of an emission that is looked up alone, in cd/m² of D65.
  float metallic = 0.0f, roughness = 1.0f, transmission = 0.0f;
  float film_factor = 0.0f, film_thickness_nm = 0.0f;
  float alpha = 1.0f;  ///< Coverage, after the alpha mode.
};

/// Looks up textures and applies vertex colours.
/// Units:  footprint_m is the width of the beam where it meets the surface.
MaterialSample material_sample(const World& world, const SurfaceMaterial& material,
                               const SurfacePoint& point, float footprint_m);

/// The layers of a material at a place.
struct LayerSample {
  float coat = 0.0f, coat_roughness = 0.0f;
  float sheen_roughness = 0.0f, sheen_most = 0.0f;  ///< Roughness; largest channel of the colour.
  float anisotropy = 0.0f;
  Vec2f direction{1.0f, 0.0f};                  ///< Of its tangent and bitangent.
  float specular = 1.0f, specular_most = 1.0f;  ///< Factor; largest channel of the colour.
  float through = 0.0f;
  ColorSample sheen, specular_color, through_color;  ///< Over ColorUse::scale; rows are its.
};

/// Looks up their textures. Domain: material.layers.
LayerSample layer_sample(const World& world, const SurfaceMaterial& material,
                         const SurfacePoint& point, float footprint_m);

/// The base colour as linear Rec.709, for the albedo channel.
Vec3f base_color_rec709(const World& world, const SurfaceMaterial& material,
                        const SurfacePoint& point, float footprint_m);

}  // namespace abbe
