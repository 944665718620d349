/// A scene made ready to trace: shapes flattened into one accelerator, every spectrum tabulated for
/// the lanes of the render, lights in a table.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "abbe/accel/accelerator.h"
#include "abbe/base/notes.h"
#include "abbe/scene/scene.h"
#include "abbe/world/chains.h"
#include "abbe/world/flat_bodies.h"
#include "abbe/world/geometry.h"
#include "abbe/world/lanes.h"
#include "abbe/world/point_chains.h"
#include "abbe/world/texture.h"

namespace abbe {

/// A spectrum tabulated for every wavelength set: an offset into World::rows.
using RowId = std::uint32_t;

/// Materials a world may have: fans keep the media they are in as 16-bit numbers.
inline constexpr std::size_t kMaxMaterials = 65535;

/// How a surface bounds the space behind it.
enum class Transmission : std::uint8_t {
  None,       ///< Opaque.
  ThinSheet,  ///< Infinitely thin: tints, does not refract.
  Medium,     ///< The boundary of a medium.
};

/// A material ready to shade. Rows hold one value per lane.
struct SurfaceMaterial {
  std::string name;
  RowId base_color = 0;  ///< Of the untextured factor.
  Vec4f base_color_rec709{1.0f};
  bool base_color_is_spectrum = false;  ///< A measured reflectance: textures multiply it.
  std::optional<TextureUse> base_color_texture, metallic_roughness_texture, normal_texture,
      emissive_texture, transmission_texture;
  float normal_scale = 1.0f;
  float metallic = 0.0f;
  float roughness = 1.0f;
  float transmission_factor = 0.0f;
  Transmission transmission = Transmission::None;
  AlphaMode alpha_mode = AlphaMode::Opaque;
  float alpha_cutoff = 0.5f;
  bool unlit = false;

  std::optional<RowId> emission;
  Vec3f emissive_rec709{0.0f};  ///< For textured emission.
  bool emission_is_textured = false;
  bool emission_is_spectrum = false;  ///< A lamp's spectrum: textures multiply it.

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

  std::optional<float> ambient_factor;
  bool uses_vertex_colors = false;

  bool is_textured() const {
    return base_color_texture || metallic_roughness_texture || transmission_texture ||
           emissive_texture || (film && (film->factor_texture || film->thickness_texture));
  }
  bool lets_light_pass() const {
    return transmission != Transmission::None || alpha_mode != AlphaMode::Opaque;
  }
};

/// A punctual light; its row is radiant intensity (or irradiance, for directional ones).
struct WorldLight {
  std::string name;
  LightType type = LightType::Point;
  Vec3f position{0.0f};
  Vec3f direction{0.0f, 0.0f, -1.0f};  ///< In which it shines.
  float range_m = kInfinity;
  float spot_scale = 0.0f, spot_offset = 0.0f;
  // A beam shines from a rectangle about `position`, with these axes and half widths.
  bool is_beam = false;
  /// Light through flat glass comes on chains; straight rays end there.
  bool has_chains = false;
  Vec3f beam_x{1.0f, 0.0f, 0.0f}, beam_y{0.0f, 1.0f, 0.0f};
  float beam_half_x_m = 0.0f, beam_half_y_m = 0.0f;
  RowId row = 0;
};

/// Mask of flat glass through which light is found exactly: in the way of straight light of some
/// lamps, transparent for that of others (WorldLight::has_chains).
inline constexpr VisibilityMask kExactGlassBit = 4;

/// Fog outside all bodies.
struct WorldFog {
  float extinction_per_m = 0.0f;
  RowId albedo = 0;
};

/// Everything the integrator reads; nothing in it changes while rays are traced.
struct World {
  explicit World(LaneModel model) : lanes(std::move(model)) {}

  LaneModel lanes;
  std::vector<float> rows;         ///< All tabulated spectra, each set_count × lane_stride.
  std::vector<float> xyz_weights;  ///< set_count × 3 × lane_stride
  std::vector<float> importance;   ///< set_count × lane_stride

  Geometry geometry;
  std::vector<SurfaceMaterial> materials;

  std::unique_ptr<const Accelerator> accelerator;
  /// Which kinds of surfaces there are, as bits of the accelerator's masks.
  VisibilityMask visibility_bits = 0;

  std::vector<WorldLight> lights;
  std::optional<RowId> ambient;
  std::optional<WorldFog> fog;

  FlatBodies flat;            ///< Empty without exact caustics.
  std::vector<Chain> chains;  ///< Largest first.
  std::vector<float> chain_rows;
  PointChains point_chains;
  /// Per surface: whether light that it lets pass is on chains, and straight rays end there.
  std::vector<std::uint8_t> surface_is_exact;
  CausticReport caustics;
  std::vector<WorldTexture> textures;
  RowId d65 = 0;  ///< Emission of D65 at 1 cd/m², for textured emission.
  /// For textured colours (color/uplift.h): s of each lane's wavelength, and the three curves of
  /// Mallett and Yuksel where they are used.
  RowId uplift_abscissa = 0;
  std::array<RowId, 3> uplift_basis{};

  RowId inverse_wavelength = 0;  ///< 1/λ of each lane in nm⁻¹, for the phases of thin films.

  std::vector<std::string> lamp_ids;  ///< Named spectra of the scene's lights, for provenance.
  double build_seconds = 0.0;

  const float* row(RowId id, int set) const {
    return rows.data() + id + static_cast<std::size_t>(set) * lanes.lane_stride();
  }
  /// Least and greatest index of a material among the lanes of a set; filled with point_chains.
  const Vec2d& index_range(std::uint32_t material, int set) const {
    return index_ranges[material * static_cast<std::size_t>(lanes.set_count()) +
                        static_cast<std::size_t>(set)];
  }
  std::vector<Vec2d> index_ranges;
};

/// Settings that shape how a scene is tabulated.
struct WorldOptions {
  Mode mode = Mode::Spectral;
  WavelengthOptions wavelengths;
  DevelopmentOptions development = {};
  Uplift uplift = Uplift::JakobHanika;
  CausticOptions caustics = {};
  CauseSet frozen = {};                ///< Spectral mode only.
  std::string accelerator = "kdtree";  ///< One of accelerator_names(). Never shapes the image.
};

/// Flattens, tabulates and builds.
World make_world(const Scene& scene, const WorldOptions& options, const Observer& observer,
                 const Spectrum& d65, Notes& notes);

/// The emission spectra of a scene, scaled to what they contribute: for the wavelength density.
std::vector<Spectrum> lamp_spectra(const Scene& scene, const Spectrum& d65);

}  // namespace abbe
