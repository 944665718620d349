/// How much light the layers of a material send back in all, integrated once: what is under them
/// gets the rest.
#pragma once

#include <array>

namespace abbe {

/// Sheens below this roughness are as ones of it: their fibres show at the horizon alone.
inline constexpr float kLeastSheenRoughness = 0.1f;

/// Directional albedos: of white light from an angle, the share that a layer sends back.
class LayerAlbedo {
 public:
  /// The one table, made when it is first asked for, in some tenths of a second.
  static const LayerAlbedo& table();

  /// Of a clear layer of index 1.5 in air whose surface has GGX microfacets: single scattering.
  /// Within 0.002 of the integral. Domain: cosine and roughness in [0, 1].
  float coat(float cosine, float roughness) const;
  /// The mean over light from all around, 2∫ coat(μ) μ dμ.
  float coat_mean(float roughness) const;
  /// Of white sheen before sheen_lobe() limits it to 1; within 0.01 where it is below. Domain: as
  /// coat().
  float sheen(float cosine, float roughness) const;
  float sheen_mean(float roughness) const;

 private:
  LayerAlbedo();
  static constexpr int kSteps = 32;
  static constexpr int kNodes = kSteps + 1;
  /// Rows are even in roughness, columns in the root of the cosine: layers are steep near grazing.
  using Table = std::array<std::array<float, kNodes>, kNodes>;
  Table coat_{}, sheen_{};
  std::array<float, kNodes> coat_mean_{}, sheen_mean_{};
};

/// Smith's Λ of the sheen's fibres, a fit. Domain: cosine in [0, 1], alpha = roughness² in (0, 1].
/// Source: Estevez & Kulla, Production Friendly Microfacet Sheen BRDF, SIGGRAPH 2017 course, with
///         the roughness of KHR_materials_sheen.
double sheen_lambda(double cosine, double alpha);

/// f_r of white sheen in sr⁻¹: fibres whose directions are spread about the surface. Where its
/// albedo would pass 1, near the horizon, it is divided by it, for either direction.
/// Domain: cosines with the normal of view, light and half vector in [0, 1].
/// Source: Khronos, KHR_materials_sheen.
float sheen_lobe(float cos_view, float cos_light, float cos_half, float roughness);

}  // namespace abbe
