/// THE reflectance of a boundary, for all lanes at once: a dielectric, a conductor, a metal known
/// by its colour, each under the film it may carry. Highway code, compiled once per instruction
/// set.
///
/// Contract. As of fresnel-inl.h and thin_film-inl.h, of which it is made: no fused multiply-add,
/// the same bits on every instruction set level, every result in [0, 1]. It is held against
/// boundary_reflectance() in optics/boundary.h.

#if defined(ABBE_OPTICS_BOUNDARY_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef ABBE_OPTICS_BOUNDARY_INL_H_
#undef ABBE_OPTICS_BOUNDARY_INL_H_
#else
#define ABBE_OPTICS_BOUNDARY_INL_H_
#endif

#include <hwy/highway.h>

#include "abbe/optics/fresnel-inl.h"
#include "abbe/optics/thin_film-inl.h"

HWY_BEFORE_NAMESPACE();
namespace abbe {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

/// A lossless thin layer on a boundary, in some lanes.
/// Units: thickness in nm, inverse_wavelength in nm⁻¹ in vacuum; share of the boundary it covers.
template <class V>
struct FilmLanes {
  V n, thickness_nm, share, inverse_wavelength;
};

/// The reflectance of a boundary under its film: mixed by the share of the surface that the film
/// covers, and the bare one to the last bit where it has no thickness. n and k are those behind the
/// film, over the index of the medium of incidence.
template <class D, class V>
HWY_INLINE V UnderFilm(D d, const FilmLanes<V>* film, V cos_incident, V n_incident, V n, V k,
                       V bare) {
  if (film == nullptr) return bare;
  const V waves = hn::Mul(hn::Mul(film->thickness_nm, n_incident), film->inverse_wavelength);
  const V covered = ThinFilmReflectance(d, cos_incident, hn::Div(film->n, n_incident), n, k, waves);
  const V mixed = hn::Add(bare, hn::Mul(film->share, hn::Sub(covered, bare)));
  return hn::IfThenElse(hn::Gt(film->thickness_nm, hn::Zero(d)), mixed, bare);
}

/// Fraction of unpolarised light reflected at the boundary of a dielectric, and the cosine of the
/// refracted ray. `film` may be null.
/// Units:  eta_ti = n_transmitted / n_incident.
/// Domain: as DielectricReflectance() and ThinFilmReflectance().
template <class D, class V>
HWY_INLINE V DielectricBoundary(D d, const FilmLanes<V>* film, V cos_incident, V eta_ti,
                                V n_incident, V* cos_transmitted) {
  const V bare = DielectricReflectance(d, cos_incident, eta_ti, cos_transmitted);
  return UnderFilm(d, film, cos_incident, n_incident, eta_ti, hn::Zero(d), bare);
}

/// The same of a metal of index n + ik, both over the index of the medium of incidence.
template <class D, class V>
HWY_INLINE V ConductorBoundary(D d, const FilmLanes<V>* film, V cos_incident, V n, V k,
                               V n_incident) {
  const V bare = ConductorReflectance(d, cos_incident, n, k);
  return UnderFilm(d, film, cos_incident, n_incident, n, k, bare);
}

/// The same of a metal known by its reflectance at normal incidence alone. Under a film it takes
/// the real index that has this colour, as KHR_materials_iridescence has it.
template <class D, class V>
HWY_INLINE V ColoredMetalBoundary(D d, const FilmLanes<V>* film, V cos_incident, V f0,
                                  V n_incident) {
  const V one = hn::Set(d, 1.0f);
  const V bare = SchlickReflectance(d, f0, one, cos_incident);
  if (film == nullptr) return bare;
  const V root = hn::Sqrt(hn::Min(f0, hn::Set(d, 0.9999f)));
  const V n = hn::Div(hn::Add(one, root), hn::Sub(one, root));
  return UnderFilm(d, film, cos_incident, n_incident, n, hn::Zero(d), bare);
}

}  // namespace HWY_NAMESPACE
}  // namespace abbe
HWY_AFTER_NAMESPACE();

#endif  // ABBE_OPTICS_BOUNDARY_INL_H_
