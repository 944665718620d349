/// Fresnel at flat facets for all lanes at once. Highway code, compiled once per instruction set.

#if defined(ABBE_INTEGRATE_LIGHT_FACET_REFLECTANCE_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef ABBE_INTEGRATE_LIGHT_FACET_REFLECTANCE_INL_H_
#undef ABBE_INTEGRATE_LIGHT_FACET_REFLECTANCE_INL_H_
#else
#define ABBE_INTEGRATE_LIGHT_FACET_REFLECTANCE_INL_H_
#endif

#include "abbe/math/lanes-inl.h"
#include "abbe/optics/fresnel-inl.h"
#include "abbe/optics/thin_film-inl.h"
#include "abbe/world/world.h"

HWY_BEFORE_NAMESPACE();
namespace abbe {
namespace HWY_NAMESPACE {

/// Share of light that a facet reflects, under its film; `inside`: for light from inside.
template <class D>
HWY_INLINE VecOf<D> FacetReflectance(D d, const World& world, const SurfaceMaterial& material,
                                     int set, int i, VecOf<D> cosine, bool inside) {
  const auto one = hn::Set(d, 1.0f);
  auto n_before = one;
  auto n = one;
  auto k = hn::Zero(d);
  auto bare = one;
  if (material.metallic > 0.0f) {
    if (material.is_conductor) {
      n = hn::LoadU(d, world.row(material.conductor_n, set) + i);
      k = hn::LoadU(d, world.row(material.conductor_k, set) + i);
      bare = ConductorReflectance(d, cosine, n, k);
    } else {
      const auto f0 = hn::LoadU(d, world.row(material.base_color, set) + i);
      const auto root = hn::Sqrt(hn::Min(f0, hn::Set(d, 0.9999f)));
      n = hn::Div(hn::Add(one, root), hn::Sub(one, root));
      bare = SchlickReflectance(d, f0, one, cosine);
    }
  } else {
    const auto index = hn::LoadU(d, world.row(material.index, set) + i);
    n = inside ? hn::Div(one, index) : index;
    if (inside) n_before = index;
    auto cos_transmitted = one;
    bare = DielectricReflectance(d, cosine, n, &cos_transmitted);
  }
  if (!material.film || !(material.film->thickness_max_nm > 0.0f)) return bare;
  const auto waves = hn::Mul(hn::Mul(hn::Set(d, material.film->thickness_max_nm), n_before),
                             hn::LoadU(d, world.row(world.inverse_wavelength, set) + i));
  const auto film_n = hn::Div(hn::LoadU(d, world.row(material.film->index, set) + i), n_before);
  const auto film = ThinFilmReflectance(d, cosine, film_n, n, k, waves);
  return hn::Add(bare, hn::Mul(hn::Set(d, material.film->factor), hn::Sub(film, bare)));
}

}  // namespace HWY_NAMESPACE
}  // namespace abbe
HWY_AFTER_NAMESPACE();

#endif  // ABBE_INTEGRATE_LIGHT_FACET_REFLECTANCE_INL_H_
