/// Fresnel at flat facets for all lanes at once. Highway code, compiled once per instruction set.

#if defined(ABBE_CAUSTICS_FLAT_LIGHT_FACET_REFLECTANCE_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef ABBE_CAUSTICS_FLAT_LIGHT_FACET_REFLECTANCE_INL_H_
#undef ABBE_CAUSTICS_FLAT_LIGHT_FACET_REFLECTANCE_INL_H_
#else
#define ABBE_CAUSTICS_FLAT_LIGHT_FACET_REFLECTANCE_INL_H_
#endif

#include "abbe/caustics/flat/chain.h"
#include "abbe/math/lanes-inl.h"
#include "abbe/optics/boundary-inl.h"
#include "abbe/world/world.h"

HWY_BEFORE_NAMESPACE();
namespace abbe {
namespace HWY_NAMESPACE {

/// Share of light that the facet of a step reflects, under its film.
template <class D>
HWY_INLINE VecOf<D> FacetReflectance(D d, const TabulatedScene& tables, const ChainStep& step,
                                     int set, int i, VecOf<D> cosine) {
  const SurfaceMaterial& material = tables.materials[step.material];
  const auto row = [&](RowId id) HWY_ATTR { return hn::LoadU(d, tables.row(id, set) + i); };
  const bool is_metal = material.metallic > 0.0f;
  const auto outside = step.outside ? row(tables.materials[*step.outside].index) : hn::Set(d, 1.0f);
  const auto index = is_metal ? outside : row(material.index);
  const bool inside = step.comes_from_inside();
  const auto n_incident = inside ? index : outside;
  FilmLanes<VecOf<D>> store;
  const FilmLanes<VecOf<D>>* film = nullptr;
  if (material.film && material.film->thickness_max_nm > 0.0f) {
    store = {row(material.film->index), hn::Set(d, material.film->thickness_max_nm),
             hn::Set(d, material.film->factor), row(tables.inverse_wavelength)};
    film = &store;
  }
  if (!is_metal) {
    auto cos_transmitted = n_incident;
    const auto eta = hn::Div(inside ? outside : index, n_incident);
    return DielectricBoundary(d, film, cosine, eta, n_incident, &cos_transmitted);
  }
  if (!material.is_conductor) {
    return ColoredMetalBoundary(d, film, cosine, row(material.base_color), n_incident);
  }
  return ConductorBoundary(d, film, cosine, row(material.conductor_n), row(material.conductor_k),
                           n_incident);
}

}  // namespace HWY_NAMESPACE
}  // namespace abbe
HWY_AFTER_NAMESPACE();

#endif  // ABBE_CAUSTICS_FLAT_LIGHT_FACET_REFLECTANCE_INL_H_
