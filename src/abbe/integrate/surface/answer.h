/// What a surface does to the lanes of a fan, as values in SIMD layout.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "abbe/integrate/fan_origin.h"
#include "abbe/integrate/surface/hit.h"
#include "abbe/integrate/surface/media.h"
#include "abbe/math/lane_array.h"

namespace abbe {

/// What a material has beyond base, metal, transmission and film, where lanes met it, and what of
/// it depends on where they come from. Of a part that is not there, nothing is filled.
struct LayerLanes {
  bool has_coat = false;
  bool coat_is_rough = false;
  bool coat_is_behind = false;  ///< Light arrives from inside of the body.
  bool coat_is_apart = false;   ///< Its normal is not that of what it covers.
  LaneArray coat, coat_roughness;
  LaneArray3 coat_normal;  ///< On the side of arrival.
  LaneArray coat_view;     ///< What it reflects of light from where the lanes come from.
  LaneArray coat_mean;     ///< The same of light from all around.
  LaneArray coat_through;  ///< What it leaves of refracted light.

  bool has_sheen = false;
  LaneArray sheen, sheen_roughness;
  LaneArray sheen_view;  ///< As coat_view, of white sheen.
  LaneArray sheen_most;  ///< Of the colour's channels: what is under it keeps its hue.

  bool is_anisotropic = false;
  LaneArray alpha_t, alpha_b;  ///< Along the two directions.
  LaneArray3 tangent, bitangent;

  bool has_specular = false;
  LaneArray specular, specular_color;
  LaneArray specular_most;  ///< As sheen_most.

  bool has_through = false;
  LaneArray through, through_color;  ///< Share and colour of diffuse transmission.

  LaneArray ambient;         ///< Albedo of all lobes that no ray stands for, diffuse ones included.
  float coat_chance = 0.0f;  ///< That the sampled ray is drawn by the coat's microfacets.
};

/// A material where lanes met it.
struct MaterialLanes {
  LaneArray base_color;  ///< Reflectance of the base colour.
  LaneArray emission;    ///< W·m⁻²·sr⁻¹·nm⁻¹, in RGB modes cd/m².
  LaneArray metallic, roughness, transmission, alpha;
  LaneArray film_factor, film_thickness_nm;  ///< Filled where the material has a film.
  const LayerLanes* layers = nullptr;
};

/// Microfacets that lanes meet, and the roughness that they were drawn from.
struct MicrofacetLanes {
  LaneArray3 normal;
  LaneArray alpha;  ///< roughness²; of a material with a direction LayerLanes has two.
};

/// The lobe of light that rough metals scatter among their microfacets more than once:
/// factor · view_loss · (loss towards the light)/π, losses as of optics/rough/microfacet_loss.h.
struct ReboundLanes {
  LaneArray factor;  ///< F_ms over the mean loss, times the metallic part.
  LaneArray view_loss;
  LaneArray alpha;
  // How the sampled ray finds it: one for all lanes.
  float chance = 0.0f;       ///< Of being drawn by it, not by single scattering.
  float drawn_alpha = 0.0f;  ///< By whose losses its direction is drawn.
};

/// What a boundary between media is made of: rows of lanes; null means index 1, no row.
struct BoundaryRows {
  bool index_is_infinite = false;  ///< The dielectric part reflects everything.
  const float* n_incident = nullptr;
  const float* n_transmitted = nullptr;
  const float* n_medium = nullptr;     ///< Of the medium that light arrives in.
  const float* conductor_n = nullptr;  ///< Null: no conductor, metals by Schlick's rule.
  const float* conductor_k = nullptr;
  const float* film_n = nullptr;              ///< Of a thin film on the boundary; null: none.
  const float* inverse_wavelength = nullptr;  ///< In nm⁻¹, with film_n.
};

/// The boundary of a material for a wavelength set, met between one medium and another.
BoundaryRows boundary_rows(const World& world, const SurfaceMaterial& material,
                           const MediumChange& change, int set);

/// Light that comes coherently: from one direction per lane, and with what share of power.
struct Lobe {
  FanOrigin made_by = FanOrigin::Reflected;
  std::uint32_t order = 0;  ///< Among the lobes made alike; tells their paths apart.
  bool spreads = false;     ///< Lanes that arrived together part.
  /// Its direction was drawn with the density of SampledDensity() (scatter-inl.h): light sampled by
  /// other means may have found it, too. Otherwise it is the only way to what it meets.
  bool is_sampled = false;
  bool is_straight = false;  ///< Its rays go on as they came: shadow rays go there, too.
  bool is_bent = false;      ///< By a boundary between media, not by a sheet.
  float width_rad = 0.0f;    ///< Of what a ray drawn by chance stands for, where textures ask.
  MediumStack media;         ///< That its rays are in.
  LaneArray3 direction;      ///< Unit length, away from the surface.
  /// Of a sampled one, that density, where light is sampled; elsewhere null.
  const LaneArray* per_sr = nullptr;
  /// In [0, 1], and that of all lobes adds up to at most 1; of lobes taken by chance, in the mean.
  LaneArray share;
};

/// What a surface does to the light of a group of lanes.
struct SurfaceAnswer {
  LaneArray cos_incident;
  LaneArray eta_ti;      ///< n_transmitted / n_incident.
  LaneArray diffuse;     ///< Albedo of diffuse reflection: what no lobe takes; under layers.
  LaneArray through;     ///< Of diffuse transmission; filled where the material has it.
  LaneArray inverse_n2;  ///< 1/n² of the medium of arrival: light added here becomes basic.
  std::array<Lobe, kMaxLobes> lobes;
  std::size_t lobe_count = 0;
  /// Of light that sampled lobes share (light/shared_light-inl.h).
  std::uint32_t rough_samples = 0;
  bool is_lit_from_behind = false;  ///< By that light.

  /// The first lobe made that way, or null.
  const Lobe* lobe(FanOrigin made_by) const {
    for (std::size_t i = 0; i < lobe_count; ++i) {
      if (lobes[i].made_by == made_by) return &lobes[i];
    }
    return nullptr;
  }
};

/// A surface as light from anywhere meets it: all that decides what of it goes back along the
/// lanes.
struct ShadedSurface {
  const SurfaceHit& hit;
  const MaterialLanes& at;
  const BoundaryRows& rows;
  const SurfaceAnswer& answer;  ///< About the shading normal.
  bool has_rough_lobe = false;
  bool has_rough_coat = false;
  bool samples_rough_lobe = false;        ///< A ray stands for the rough lobes, too.
  const ReboundLanes* rebound = nullptr;  ///< Of a rough metal, if it has that lobe.
  const MediumStack* behind = nullptr;    ///< Where a ray of its microfacets goes through it.
  bool is_sheet = false;
  bool has_broad_lobe = true;  ///< Diffuse ones, sheen: no ray stands for those.
};

}  // namespace abbe
