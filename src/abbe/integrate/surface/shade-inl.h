/// Shading for all lanes at once: what a surface does to the lanes of a fan. Highway code, compiled
/// once per instruction set.
///
/// Contract. No fused multiply-add and no reduction across lanes whose order depends on the vector
/// width, so that a result has the same bits on every instruction set level.

#if defined(ABBE_INTEGRATE_SURFACE_SHADE_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef ABBE_INTEGRATE_SURFACE_SHADE_INL_H_
#undef ABBE_INTEGRATE_SURFACE_SHADE_INL_H_
#else
#define ABBE_INTEGRATE_SURFACE_SHADE_INL_H_
#endif

#include <hwy/highway.h>

#include "abbe/integrate/surface/microfacet.h"
#include "abbe/integrate/surface/shading.h"
#include "abbe/math/lanes-inl.h"
#include "abbe/optics/fresnel-inl.h"
#include "abbe/optics/thin_film-inl.h"
#include "abbe/world/world.h"

HWY_BEFORE_NAMESPACE();
namespace abbe {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

template <class D>
HWY_INLINE VecOf<D> RowOr(D d, const float* row, int i, float otherwise) {
  return row != nullptr ? hn::LoadU(d, row + i) : hn::Set(d, otherwise);
}

/// The reflectance of a boundary, given that of the bare one, under the film it may carry: mixed by
/// the share of the surface that the film covers, and the bare one to the last bit where it has no
/// thickness. n and k are those behind the film, over the index of the medium of arrival.
template <class D>
HWY_INLINE VecOf<D> UnderFilm(D d, const BoundaryRows& rows, const Interaction& at, int i,
                              VecOf<D> cosine, VecOf<D> n_medium, VecOf<D> n, VecOf<D> k,
                              VecOf<D> bare) {
  if (rows.film_n == nullptr) return bare;
  const auto thickness_nm = hn::Load(d, at.film_thickness_nm.v + i);
  const auto waves =
      hn::Mul(hn::Mul(thickness_nm, n_medium), hn::LoadU(d, rows.inverse_wavelength + i));
  const auto film =
      ThinFilmReflectance(d, cosine, hn::Div(hn::LoadU(d, rows.film_n + i), n_medium), n, k, waves);
  const auto mixed = hn::Add(bare, hn::Mul(hn::Load(d, at.film_factor.v + i), hn::Sub(film, bare)));
  return hn::IfThenElse(hn::Gt(thickness_nm, hn::Zero(d)), mixed, bare);
}

/// Fresnel's k_r of the dielectric part of a surface.
template <class D>
HWY_INLINE VecOf<D> DielectricPart(D d, const BoundaryRows& rows, const Interaction& at, int i,
                                   VecOf<D> eta, VecOf<D> n_medium, VecOf<D> cosine,
                                   VecOf<D>* cos_transmitted) {
  const auto bare = DielectricReflectance(d, cosine, eta, cos_transmitted);
  return UnderFilm(d, rows, at, i, cosine, n_medium, eta, hn::Zero(d), bare);
}

/// Fresnel's k_r of the metallic part. A metal known by its colour alone takes, under a film, the
/// real index that has this colour at normal incidence, as KHR_materials_iridescence has it.
template <class D>
HWY_INLINE VecOf<D> MetalPart(D d, const BoundaryRows& rows, const Interaction& at, int i,
                              VecOf<D> n_medium, VecOf<D> cosine) {
  const auto one = hn::Set(d, 1.0f);
  if (rows.conductor_n == nullptr) {
    const auto f0 = hn::Load(d, at.base_color.v + i);
    const auto bare = SchlickReflectance(d, f0, one, cosine);
    if (rows.film_n == nullptr) return bare;
    const auto root = hn::Sqrt(hn::Min(f0, hn::Set(d, 0.9999f)));
    const auto n = hn::Div(hn::Add(one, root), hn::Sub(one, root));
    return UnderFilm(d, rows, at, i, cosine, n_medium, n, hn::Zero(d), bare);
  }
  const auto n = hn::Div(hn::LoadU(d, rows.conductor_n + i), n_medium);
  const auto k = hn::Div(hn::LoadU(d, rows.conductor_k + i), n_medium);
  return UnderFilm(d, rows, at, i, cosine, n_medium, n, k, ConductorReflectance(d, cosine, n, k));
}

/// Fills a Shading: shares of light and the directions of the coherent rays.
/// `infinite_index` makes the dielectric part reflect everything; `hidden` is a boundary inside
/// another medium, where light goes straight on; `thin` does not refract.
template <class D>
HWY_INLINE void ShadeLanes(D d, int stride, const BoundaryRows& rows, bool infinite_index,
                           bool hidden, bool thin, const Interaction& at, Shading& out) {
  const auto one = hn::Set(d, 1.0f);
  const auto zero = hn::Zero(d);
  const int step = static_cast<int>(hn::Lanes(d));
  for (int i = 0; i < stride; i += step) {
    const auto direction = Load3(d, at.direction, i);
    const auto outward = Load3(d, at.outward, i);
    auto normal = Load3(d, at.normal, i);
    // The geometric normal on the side of arrival.
    const auto from_front = hn::Lt(Dot3(d, direction, outward), zero);
    const auto side = hn::IfThenElse(from_front, one, hn::Neg(one));
    const Vec3Of<D> facing{hn::Mul(side, outward.x), hn::Mul(side, outward.y),
                           hn::Mul(side, outward.z)};
    auto cosine = hn::Neg(Dot3(d, direction, normal));
    // Interpolated normals may turn away from a ray that sees the surface.
    const auto turned_away = hn::Le(cosine, zero);
    normal = Select3(d, turned_away, facing, normal);
    cosine = hn::IfThenElse(turned_away, hn::Neg(Dot3(d, direction, facing)), cosine);
    cosine = hn::Min(hn::Max(cosine, zero), one);

    const auto n_medium = RowOr(d, rows.n_medium, i, 1.0f);
    const auto eta =
        hn::Div(RowOr(d, rows.n_transmitted, i, 1.0f), RowOr(d, rows.n_incident, i, 1.0f));
    auto cos_transmitted = one;
    auto dielectric = DielectricPart(d, rows, at, i, eta, n_medium, cosine, &cos_transmitted);
    if (infinite_index) dielectric = one;
    const auto base_color = hn::Load(d, at.base_color.v + i);
    const auto metallic = hn::Load(d, at.metallic.v + i);
    const auto transmission = hn::Load(d, at.transmission.v + i);
    const auto metal = MetalPart(d, rows, at, i, n_medium, cosine);
    const auto dielectric_part = hn::Sub(one, metallic);
    const auto refracted_share =
        hn::Mul(hn::Mul(dielectric_part, hn::Sub(one, dielectric)), base_color);
    auto k_r = hn::Add(hn::Mul(dielectric_part, dielectric), hn::Mul(metallic, metal));
    auto k_t = hn::Mul(refracted_share, transmission);
    auto diffuse = hn::Mul(refracted_share, hn::Sub(one, transmission));

    // Reflection about the shading normal, unless that would lead into the surface.
    const auto two_cosine = hn::Add(cosine, cosine);
    auto reflected = Combine3(d, one, direction, two_cosine, normal);
    const auto two_facing = hn::Mul(hn::Set(d, -2.0f), Dot3(d, direction, facing));
    reflected = Select3(d, hn::Gt(Dot3(d, reflected, facing), zero), reflected,
                        Combine3(d, one, direction, two_facing, facing));
    reflected = Normalized3(d, reflected);

    // Snell: t = d/eta + (cos_i/eta − cos_t)·n, with eta = n_t/n_i.
    const auto inverse_eta = hn::Div(one, eta);
    auto refracted = Combine3(d, inverse_eta, direction,
                              hn::Sub(hn::Mul(inverse_eta, cosine), cos_transmitted), normal);
    const auto stays_outside = hn::Ge(Dot3(d, refracted, facing), zero);
    refracted = Select3(d, stays_outside, direction, refracted);
    refracted = Normalized3(d, refracted);

    if (hidden) {
      k_r = zero;
      k_t = one;
      diffuse = zero;
    }
    if (hidden || thin) refracted = direction;
    hn::Store(cosine, d, out.cos_incident.v + i);
    hn::Store(eta, d, out.eta_ti.v + i);
    hn::Store(cos_transmitted, d, out.cos_transmitted.v + i);
    hn::Store(k_r, d, out.k_r.v + i);
    hn::Store(k_t, d, out.k_t.v + i);
    hn::Store(diffuse, d, out.diffuse.v + i);
    hn::Store(hn::Div(one, hn::Mul(n_medium, n_medium)), d, out.inverse_n2.v + i);
    Store3(d, reflected, out.reflected, i);
    Store3(d, refracted, out.refracted, i);
  }
}

/// KHR_lights_punctual's window of distance and cone of a spot, for a lamp in direction `to_light`.
template <class D>
HWY_INLINE VecOf<D> LampWindow(D d, const WorldLight& light, VecOf<D> distance,
                               const Vec3Of<D>& to_light) {
  const auto one = hn::Set(d, 1.0f);
  const auto zero = hn::Zero(d);
  auto window = one;
  if (light.range_m < kInfinity) {
    const auto ratio = hn::Div(distance, hn::Set(d, light.range_m));
    const auto ratio2 = hn::Mul(ratio, ratio);
    window = hn::Max(hn::Min(hn::Sub(one, hn::Mul(ratio2, ratio2)), one), zero);
  }
  if (light.type == LightType::Spot) {
    const auto cosine = Dot3(d, to_light, Set3(d, -light.direction));
    const auto cone = hn::Max(hn::Min(hn::Add(hn::Mul(cosine, hn::Set(d, light.spot_scale)),
                                              hn::Set(d, light.spot_offset)),
                                      one),
                              zero);
    window = hn::Mul(window, hn::Mul(cone, cone));
  }
  return window;
}

/// Light of a lamp that arrives straight, per lane, before visibility: Φ/r² and
/// KHR_lights_punctual's window and cone, or the irradiance of parallel light inside its beam.
template <class D>
HWY_INLINE void StraightLight(D d, int stride, const WorldLight& light, const float* light_row,
                              const LaneArray3& positions, LightGeometry& geometry) {
  const auto one = hn::Set(d, 1.0f);
  const auto zero = hn::Zero(d);
  const int step = static_cast<int>(hn::Lanes(d));
  for (int i = 0; i < stride; i += step) {
    Vec3Of<D> to_light;
    auto attenuation = one;
    auto distance = hn::Set(d, kInfinity);
    if (light.type == LightType::Directional) {
      to_light = Set3(d, -light.direction);
      if (light.is_beam) {
        const auto position = Load3(d, positions, i);
        const auto from_light =
            Combine3(d, one, position, hn::Set(d, -1.0f), Set3(d, light.position));
        const auto along = Dot3(d, from_light, Set3(d, light.direction));
        const auto x = hn::Abs(Dot3(d, from_light, Set3(d, light.beam_x)));
        const auto y = hn::Abs(Dot3(d, from_light, Set3(d, light.beam_y)));
        const auto inside =
            hn::And(hn::Ge(along, zero), hn::And(hn::Le(x, hn::Set(d, light.beam_half_x_m)),
                                                 hn::Le(y, hn::Set(d, light.beam_half_y_m))));
        attenuation = hn::IfThenElseZero(inside, one);
        distance = hn::Max(along, zero);
      }
    } else {
      const auto position = Load3(d, positions, i);
      const Vec3Of<D> offset{hn::Sub(hn::Set(d, light.position.x), position.x),
                             hn::Sub(hn::Set(d, light.position.y), position.y),
                             hn::Sub(hn::Set(d, light.position.z), position.z)};
      const auto distance2 = hn::Max(Dot3(d, offset, offset), hn::Set(d, 1e-30f));
      distance = hn::Sqrt(distance2);
      const auto inverse = hn::Div(one, distance);
      to_light = {hn::Mul(offset.x, inverse), hn::Mul(offset.y, inverse),
                  hn::Mul(offset.z, inverse)};
      attenuation = hn::Mul(hn::Div(one, distance2), LampWindow(d, light, distance, to_light));
    }
    Store3(d, to_light, geometry.direction, i);
    hn::Store(distance, d, geometry.distance_m.v + i);
    hn::Store(hn::Mul(hn::LoadU(d, light_row + i), attenuation), d, geometry.irradiance.v + i);
  }
}

/// Light that would reach the camera by direct reflection of what arrives from a lamp, per lane,
/// before visibility: throughput/n² · E · f_r · cosθ.
/// Source: GGX and its height-correlated masking, glTF 2.0 appendix B.
template <class D>
HWY_INLINE void ReflectLight(D d, int stride, const BoundaryRows& rows, bool infinite_index,
                             bool has_rough_lobe, const Interaction& at, const Shading& shading,
                             const LightGeometry& geometry, float* contribution) {
  const auto one = hn::Set(d, 1.0f);
  const auto zero = hn::Zero(d);
  const auto inverse_pi = hn::Set(d, static_cast<float>(1.0 / kPi));
  const int step = static_cast<int>(hn::Lanes(d));
  for (int i = 0; i < stride; i += step) {
    const auto view = Load3(d, at.direction, i);
    const auto outward = Load3(d, at.outward, i);
    const auto normal = Load3(d, at.normal, i);
    const auto front = hn::Lt(Dot3(d, view, outward), zero);
    const auto side = hn::IfThenElse(front, one, hn::Neg(one));
    const auto to_light = Load3(d, geometry.direction, i);
    const auto cos_light = Dot3(d, normal, to_light);
    const auto sees_light =
        hn::And(hn::Gt(cos_light, zero), hn::Gt(hn::Mul(side, Dot3(d, outward, to_light)), zero));

    auto reflected = hn::Mul(hn::Load(d, shading.diffuse.v + i), inverse_pi);
    if (has_rough_lobe) {
      const Vec3Of<D> to_view{hn::Neg(view.x), hn::Neg(view.y), hn::Neg(view.z)};
      const auto half = Normalized3(d, Combine3(d, one, to_light, one, to_view));
      const auto cos_half = hn::Min(hn::Max(Dot3(d, normal, half), zero), one);
      const auto cos_view_half = hn::Min(hn::Max(Dot3(d, to_view, half), zero), one);
      const auto cos_view = hn::Max(hn::Load(d, shading.cos_incident.v + i), hn::Set(d, 1e-4f));
      const auto roughness = hn::Max(hn::Load(d, at.roughness.v + i), hn::Set(d, kSmoothRoughness));
      const auto alpha = hn::Mul(roughness, roughness);
      const auto alpha2 = hn::Mul(alpha, alpha);
      const auto bracket = hn::Add(hn::Mul(hn::Mul(cos_half, cos_half), hn::Sub(alpha2, one)), one);
      const auto distribution = hn::Div(hn::Mul(alpha2, inverse_pi), hn::Mul(bracket, bracket));
      const auto masking = [&](auto cosine) {
        return hn::Sqrt(hn::Add(hn::Mul(hn::Mul(cosine, cosine), hn::Sub(one, alpha2)), alpha2));
      };
      const auto cos_light_positive = hn::Max(cos_light, hn::Set(d, 1e-6f));
      const auto visibility =
          hn::Div(hn::Set(d, 0.5f), hn::Add(hn::Mul(cos_light_positive, masking(cos_view)),
                                            hn::Mul(cos_view, masking(cos_light_positive))));
      auto cos_transmitted = one;
      const auto n_medium = RowOr(d, rows.n_medium, i, 1.0f);
      auto fresnel = DielectricPart(d, rows, at, i, hn::Load(d, shading.eta_ti.v + i), n_medium,
                                    cos_view_half, &cos_transmitted);
      if (infinite_index) fresnel = one;
      const auto metallic = hn::Load(d, at.metallic.v + i);
      const auto metal = MetalPart(d, rows, at, i, n_medium, cos_view_half);
      fresnel = hn::Add(hn::Mul(hn::Sub(one, metallic), fresnel), hn::Mul(metallic, metal));
      reflected = hn::Add(reflected, hn::Mul(fresnel, hn::Mul(distribution, visibility)));
    }
    const auto arriving = hn::Mul(hn::Load(d, geometry.irradiance.v + i), cos_light);
    const auto throughput =
        hn::Mul(hn::Load(d, at.throughput.v + i), hn::Load(d, shading.inverse_n2.v + i));
    const auto light_out =
        hn::IfThenElseZero(sees_light, hn::Mul(hn::Mul(throughput, arriving), reflected));
    hn::StoreU(light_out, d, contribution + i);
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace abbe
HWY_AFTER_NAMESPACE();

#endif  // ABBE_INTEGRATE_SURFACE_SHADE_INL_H_
