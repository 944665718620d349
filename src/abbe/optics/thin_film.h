/// Reflection at a boundary that carries one thin layer, in double precision: what the renderer's
/// vector code is measured against, and what straight shadow rays use.
#pragma once

#include <complex>

namespace abbe {

/// Fraction of unpolarised light reflected at a boundary with one lossless layer on it: the sum of
/// all reflections inside the layer, with their phases (Airy). What is not reflected enters the
/// substrate.
/// Units:  indices absolute or all relative to the same medium; lengths in nm.
/// Domain: cos_incident in [0, 1], n_incident and n_film > 0, Re n_substrate > 0, Im n_substrate
///         >= 0 (a metal is n + ik), thickness_nm >= 0, wavelength_nm > 0. Past the layer's
///         critical angle the wave in it is evanescent and light tunnels through. Thickness 0 is
///         the bare boundary.
/// Source: Born & Wolf, Principles of Optics, 7th ed., 1.6.4 and 7.6.1.
double thin_film_reflectance(double cos_incident, double n_incident, double n_film,
                             std::complex<double> n_substrate, double thickness_nm,
                             double wavelength_nm);

}  // namespace abbe
