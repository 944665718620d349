/// What a boundary between two media reflects, in closed form and double precision: the judge of
/// the vector code in boundary-inl.h, and what searches for light and straight shadow rays use.
#pragma once

#include <cstdint>
#include <optional>

namespace abbe {

/// What lies behind a boundary.
enum class BoundaryKind : std::uint8_t {
  Dielectric,
  Conductor,     ///< A metal of index n + ik.
  ColoredMetal,  ///< A metal known by its reflectance at normal incidence alone: Schlick's rule.
};

/// A lossless thin layer on a boundary.
struct BoundaryFilm {
  double n = 1.0;
  double thickness_nm = 0.0;
  double share = 1.0;  ///< Of the boundary that it covers.
};

/// A smooth boundary at one wavelength.
struct Boundary {
  BoundaryKind kind = BoundaryKind::Dielectric;
  double n_incident = 1.0;     ///< Of the medium that light comes from.
  double n = 1.0, k = 0.0;     ///< Behind, of a dielectric or a conductor.
  double f0 = 1.0;             ///< Of a coloured metal.
  double wavelength_nm = 0.0;  ///< In vacuum; read where there is a film.
  std::optional<BoundaryFilm> film = {};
};

/// Fraction of unpolarised light that a boundary reflects. A coloured metal takes, under a film,
/// the real index over that of the medium of incidence which has its colour at normal incidence, as
/// KHR_materials_iridescence has it.
/// Units:  dimensionless.
/// Domain: cos_incident in [0, 1]; n_incident, n > 0, k >= 0, f0 in [0, 1]; at total internal
///         reflection exactly 1 but for light that tunnels through a film.
/// Source: optics/fresnel.h, optics/thin_film.h.
double boundary_reflectance(const Boundary& boundary, double cos_incident);

}  // namespace abbe
