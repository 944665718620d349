/// Fresnel's formulas in closed form and double precision: what the renderer's vector code is
/// measured against, and what `abbe probe` prints.
#pragma once

namespace abbe {

/// What happens to light at a smooth boundary of two dielectrics, by polarisation.
struct DielectricFresnel {
  double reflectance_s =
      0.0;  ///< Fraction of power, electric field normal to the plane of incidence.
  double reflectance_p = 0.0;    ///< Electric field in the plane of incidence.
  double cos_transmitted = 0.0;  ///< 0 at total internal reflection.

  /// Unpolarised light.
  double reflectance() const { return 0.5 * (reflectance_s + reflectance_p); }
  /// The rest: nothing is absorbed at the boundary.
  double transmittance() const { return 1.0 - reflectance(); }
};

/// Reflectances of a smooth dielectric boundary.
/// Units:  dimensionless; eta_ti = n_transmitted / n_incident.
/// Domain: cos_incident in [0, 1], eta_ti > 0; at total internal reflection exactly 1.
/// Source: Born & Wolf, Principles of Optics, 7th ed., 1.5.2.
DielectricFresnel fresnel_dielectric(double cos_incident, double eta_ti);

/// Fraction of unpolarised light reflected at a smooth conductor of index n + ik.
/// Units:  dimensionless; n_incident is the index of the medium that light comes from.
/// Domain: cos_incident in [0, 1], n > 0, k >= 0, n_incident > 0.
/// Source: Born & Wolf, Principles of Optics, 7th ed., 14.2.
double fresnel_conductor(double cos_incident, double n, double k, double n_incident = 1.0);

/// Schlick's approximation f0 + (f90 − f0)(1 − cos)⁵, which glTF uses. Source: Schlick 1994.
double fresnel_schlick(double cos_incident, double f0, double f90 = 1.0);

/// Reflectance of a dielectric at normal incidence, ((eta_ti − 1)/(eta_ti + 1))².
double normal_reflectance(double eta_ti);

/// Angle of incidence at which p-polarised light is not reflected, in radians.
double brewster_angle_rad(double eta_ti);

/// Angle of incidence from which on all light is reflected, in radians.
/// Domain: eta_ti <= 1; above that, where there is none, π/2.
double critical_angle_rad(double eta_ti);

}  // namespace abbe
