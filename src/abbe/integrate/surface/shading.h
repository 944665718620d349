/// What shading works with, in SIMD layout.
#pragma once

#include "abbe/integrate/surface/interaction.h"

namespace abbe {

/// What a boundary between media is made of, per lane; null pointers mean index 1, no row.
struct BoundaryRows {
  const float* n_incident = nullptr;
  const float* n_transmitted = nullptr;
  const float* n_medium = nullptr;     ///< Of the medium that light arrives in.
  const float* conductor_n = nullptr;  ///< Null: no conductor, metals by Schlick's rule.
  const float* conductor_k = nullptr;
  const float* film_n = nullptr;              ///< Of a thin film on the boundary; null: none.
  const float* inverse_wavelength = nullptr;  ///< In nm⁻¹, with film_n.
};

/// What shading found, per lane.
struct Shading {
  LaneArray cos_incident;
  LaneArray eta_ti;
  LaneArray cos_transmitted;
  LaneArray k_r, k_t;    ///< Shares of power; k_t includes tint and transmission factor.
  LaneArray diffuse;     ///< Albedo that is left for diffuse reflection.
  LaneArray inverse_n2;  ///< 1/n² of the medium of arrival: light added here becomes basic.
  LaneArray3 reflected, refracted;
};

/// Where light comes from in every lane: unit directions to it, and how much of it.
struct LightGeometry {
  LaneArray3 direction;
  LaneArray distance_m;
  LaneArray irradiance;  ///< Across that direction, before visibility.
};

}  // namespace abbe
