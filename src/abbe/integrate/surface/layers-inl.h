/// Layers on a surface: how much light a clearcoat and a sheen send back, and what is under them
/// gets of the rest. Highway code, compiled once per instruction set.
///
/// A coat covers the share c of a surface. It reflects E(μ) of light that arrives at the cosine μ,
/// Fresnel's k_r where it is smooth, and lets 1 − E by on the way in and on the way out. Of what is
/// below, with the reflectance R, light goes back and forth: (1 − E)(1 − E')/(1 − R·E), so that a
/// white body stays white. Sheen leaves 1 − m·E on the way where it takes more, m the largest
/// channel of its colour. Either way no more leaves than arrives.
/// Source: Khronos, KHR_materials_clearcoat and KHR_materials_sheen, which count the coat once.

#if defined(ABBE_INTEGRATE_SURFACE_LAYERS_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef ABBE_INTEGRATE_SURFACE_LAYERS_INL_H_
#undef ABBE_INTEGRATE_SURFACE_LAYERS_INL_H_
#else
#define ABBE_INTEGRATE_SURFACE_LAYERS_INL_H_
#endif

#include <hwy/highway.h>

#include <algorithm>

#include "abbe/integrate/surface/answer-inl.h"
#include "abbe/optics/microfacet.h"
#include "abbe/optics/rough/layer_albedo.h"

HWY_BEFORE_NAMESPACE();
namespace abbe {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

/// The index of clearcoats.
inline constexpr float kCoatIndex = 1.5f;

/// Fresnel's k_r of a coat, met from its outside.
template <class D>
HWY_INLINE VecOf<D> CoatFresnel(D d, const BoundaryRows& rows, int i, VecOf<D> cosine) {
  VecOf<D> cos_transmitted;
  const auto eta = hn::Div(hn::Set(d, kCoatIndex), RowOr(d, rows.n_medium, i, 1.0f));
  return DielectricReflectance(d, hn::Min(hn::Max(cosine, hn::Zero(d)), hn::Set(d, 1.0f)), eta,
                               &cos_transmitted);
}

/// What a coat reflects in all of light that arrives along, or leaves to, a direction.
template <class D>
HWY_INLINE VecOf<D> CoatAlbedo(D d, const BoundaryRows& rows, const LayerLanes& layers, int i,
                               const Vec3Of<D>& direction) {
  if (!layers.has_coat) return hn::Zero(d);
  const auto cosine = hn::Max(Dot3(d, Load3(d, layers.coat_normal, i), direction), hn::Zero(d));
  if (!layers.coat_is_rough) return CoatFresnel(d, rows, i, cosine);
  LaneArray cosines, albedo;
  hn::Store(cosine, d, cosines.v);
  for (int k = 0; k < static_cast<int>(hn::Lanes(d)); ++k) {
    albedo[k] = LayerAlbedo::table().coat(cosines[k], layers.coat_roughness[i + k]);
  }
  return hn::Load(d, albedo.v);
}

template <class D>
HWY_INLINE VecOf<D> CoatView(D d, const LayerLanes& layers, int i) {
  return layers.has_coat ? hn::Load(d, layers.coat_view.v + i) : hn::Zero(d);
}

template <class D>
HWY_INLINE VecOf<D> CoatMean(D d, const LayerLanes& layers, int i) {
  return layers.has_coat ? hn::Load(d, layers.coat_mean.v + i) : hn::Zero(d);
}

/// What a coat leaves of light that comes in reflecting `coat_out` and goes out to the view, of
/// what is below: `reflectance`, which light meets again that the coat reflects back by `between`.
template <class D>
HWY_INLINE VecOf<D> UnderCoat(D d, const LayerLanes& layers, int i, VecOf<D> coat_out,
                              VecOf<D> reflectance, VecOf<D> between) {
  const auto one = hn::Set(d, 1.0f);
  if (!layers.has_coat || layers.coat_is_behind) return one;
  const auto c = hn::Load(d, layers.coat.v + i);
  const auto both =
      hn::Mul(hn::Sub(one, hn::Load(d, layers.coat_view.v + i)), hn::Sub(one, coat_out));
  const auto often = hn::Sub(one, hn::Mul(reflectance, between));
  const auto covered = hn::Div(both, hn::Max(often, hn::Set(d, 1e-6f)));
  return hn::Add(hn::Sub(one, c), hn::Mul(c, covered));
}

/// What sheen leaves of light between the view and a direction of that cosine.
template <class D>
HWY_INLINE VecOf<D> UnderSheen(D d, const LayerLanes& layers, int i, VecOf<D> cosine) {
  const auto one = hn::Set(d, 1.0f);
  if (!layers.has_sheen) return one;
  LaneArray cosines, albedo;
  hn::Store(cosine, d, cosines.v);
  for (int k = 0; k < static_cast<int>(hn::Lanes(d)); ++k) {
    albedo[k] =
        std::min(1.0f, LayerAlbedo::table().sheen(cosines[k], layers.sheen_roughness[i + k]));
  }
  const auto most = hn::Max(hn::Load(d, layers.sheen_view.v + i), hn::Load(d, albedo.v));
  const auto taken = hn::Mul(hn::Load(d, layers.sheen_most.v + i), most);
  return hn::Max(hn::Sub(one, taken), hn::Zero(d));
}

/// GGX at the half vector of a rough coat.
template <class D>
struct CoatWay {
  VecOf<D> cos_view, alpha2, root_view, distribution;
};

template <class D>
HWY_INLINE CoatWay<D> CoatHalfWay(D d, const LayerLanes& layers, int i, const Arrival<D>& arrival,
                                  const Vec3Of<D>& half) {
  const auto normal = Load3(d, layers.coat_normal, i);
  const auto roughness =
      hn::Max(hn::Load(d, layers.coat_roughness.v + i), hn::Set(d, kSmoothRoughness));
  const auto alpha = hn::Mul(roughness, roughness);
  CoatWay<D> way;
  way.alpha2 = hn::Mul(alpha, alpha);
  way.cos_view = hn::Max(hn::Neg(Dot3(d, arrival.direction, normal)), hn::Set(d, kLeastCosine));
  way.root_view = SmithRoot(d, hn::Min(way.cos_view, hn::Set(d, 1.0f)), way.alpha2);
  const auto across = Combine3(d, hn::Set(d, 1.0f), half, hn::Neg(Dot3(d, normal, half)), normal);
  way.distribution = GgxDistribution(d, Dot3(d, across, across), way.alpha2);
  return way;
}

/// A rough coat's microfacet normals as SampleMicrofacets() draws those of a surface, and where
/// they reflect to. Domain: u in [0, 1)².
template <class D>
void ReflectAtCoat(D d, int stride, const SurfaceHit& hit, const LayerLanes& layers, bool spread,
                   const Vec2f& u, LaneArray3& reflected) {
  const int last = spread ? stride : 1;
  for (int lane = 0; lane < last; ++lane) {
    const int source = hit.lanes.test(lane) ? lane : hit.lanes.front();
    const Basis basis(layers.coat_normal.get(source));
    const Vec3f direction = hit.direction.get(source);
    Vec3f view = basis.to_local(-direction);
    view.z = std::max(view.z, kLeastCosine);
    const float rough = std::max(layers.coat_roughness[source], kSmoothRoughness);
    const Vec3f facet =
        basis.to_world(sample_visible_normal(glm::normalize(view), rough * rough, u));
    reflected.set(lane, glm::normalize(direction - 2.0f * glm::dot(direction, facet) * facet));
  }
  if (!spread) Splat(d, stride, reflected.get(0), reflected);
}

/// What depends on the view of the layers that lanes met, of which everything else is filled.
template <class D>
void FillViewOfLayers(D d, int stride, const MediumChange& change, const BoundaryRows& rows,
                      const SurfaceHit& hit, const SurfaceAnswer& answer, LayerLanes& layers) {
  layers.coat_is_behind = layers.has_coat && !hit.front && change.crossing != Crossing::None;
  if (layers.coat_is_behind) layers.coat_is_rough = false;
  const LayerAlbedo& table = LayerAlbedo::table();
  if (layers.has_sheen) {
    for (int lane = 0; lane < stride; ++lane) {
      layers.sheen_view[lane] =
          std::min(1.0f, table.sheen(answer.cos_incident[lane], layers.sheen_roughness[lane]));
    }
  }
  if (!layers.has_coat) return;
  for (int lane = 0; lane < stride; ++lane) {
    layers.coat_mean[lane] = table.coat_mean(layers.coat_roughness[lane]);
  }
  const auto one = hn::Set(d, 1.0f);
  const auto zero = hn::Zero(d);
  for (int i = 0; i < stride; i += static_cast<int>(hn::Lanes(d))) {
    if (!layers.coat_is_behind) {
      const auto direction = Load3(d, hit.direction, i);
      const Vec3Of<D> back{hn::Neg(direction.x), hn::Neg(direction.y), hn::Neg(direction.z)};
      hn::Store(CoatAlbedo(d, rows, layers, i, back), d, layers.coat_view.v + i);
      continue;
    }
    // At the angle that light has outside; behind total reflection there is none.
    const auto cosine = hn::Load(d, answer.cos_incident.v + i);
    const auto eta = change.is_boundary() ? hn::Load(d, answer.eta_ti.v + i) : one;
    const auto sin2 = hn::Div(hn::Sub(one, hn::Mul(cosine, cosine)), hn::Mul(eta, eta));
    const auto cos_outside = hn::Sqrt(hn::Max(hn::Sub(one, sin2), zero));
    const float* outside = change.is_boundary() ? rows.n_transmitted : rows.n_medium;
    VecOf<D> cos_in_coat;
    const auto k_r = DielectricReflectance(
        d, cos_outside, hn::Div(hn::Set(d, kCoatIndex), RowOr(d, outside, i, 1.0f)), &cos_in_coat);
    hn::Store(hn::IfThenElseZero(hn::Lt(sin2, one), k_r), d, layers.coat_view.v + i);
  }
}

/// Puts the layers over the answer of a smooth surface: what coherent rays carry, and the ambient
/// albedo. A smooth coat's own ray is the surface's where both go the same way, else a lobe more.
template <class D>
void LayOver(D d, int stride, const BoundaryRows& rows, const SurfaceHit& hit, bool rough,
             LayerLanes& layers, SurfaceAnswer& answer) {
  const auto one = hn::Set(d, 1.0f);
  const auto zero = hn::Zero(d);
  Lobe& reflection = answer.lobes[0];
  Lobe* refraction = answer.lobe_count > 1 ? &answer.lobes[1] : nullptr;
  const bool has_ray = layers.has_coat && !layers.coat_is_behind && !layers.coat_is_rough;
  const bool is_apart = has_ray && (layers.coat_is_apart || rough);
  Lobe* own = nullptr;
  if (is_apart) {
    own = &answer.lobes[answer.lobe_count++];
    own->made_by = FanOrigin::Reflected;
    own->order = 1;
    own->media = reflection.media;
    own->spreads = false;
    own->is_sampled = false;
    own->is_straight = false;
  }
  for (int i = 0; i < stride; i += static_cast<int>(hn::Lanes(d))) {
    const auto arrival = ArrivalAt(d, hit, i);
    const auto diffuse = hn::Load(d, answer.diffuse.v + i);
    const auto k_r = hn::Load(d, reflection.share.v + i);
    const auto k_t = refraction != nullptr ? hn::Load(d, refraction->share.v + i) : zero;
    const auto view = CoatView(d, layers, i);
    const auto c = layers.has_coat ? hn::Load(d, layers.coat.v + i) : zero;
    const auto sheen = UnderSheen(d, layers, i, hn::Load(d, answer.cos_incident.v + i));

    // Refraction, either way, and what a coat behind sends back into the body.
    const auto often = hn::Max(hn::Sub(one, hn::Mul(k_r, view)), hn::Set(d, 1e-6f));
    const auto through =
        hn::Mul(sheen, hn::Add(hn::Sub(one, c), hn::Mul(c, hn::Div(hn::Sub(one, view), often))));
    hn::Store(through, d, layers.coat_through.v + i);
    auto reflected = k_r;
    if (layers.coat_is_behind) {
      reflected = hn::Add(k_r, hn::Mul(c, hn::Div(hn::Mul(hn::Mul(k_t, k_t), view), often)));
    } else if (layers.has_coat) {
      const auto out = layers.coat_is_apart
                           ? CoatAlbedo(d, rows, layers, i, Load3(d, reflection.direction, i))
                           : view;
      reflected = hn::Mul(k_r, UnderCoat(d, layers, i, out, k_r, hn::Min(view, out)));
    }
    reflected = hn::Mul(reflected, sheen);
    const auto of_coat = has_ray ? hn::Mul(c, view) : zero;
    if (own != nullptr) {
      const auto normal = Load3(d, layers.coat_normal, i);
      const auto cosine = hn::Neg(Dot3(d, arrival.direction, normal));
      auto away = ReflectedDirection(d, arrival.direction, normal, cosine);
      const auto cos_facing = hn::Neg(Dot3(d, arrival.direction, arrival.facing));
      away = Select3(d, hn::Gt(Dot3(d, away, arrival.facing), zero), away,
                     ReflectedDirection(d, arrival.direction, arrival.facing, cos_facing));
      Store3(d, Normalized3(d, away), own->direction, i);
      hn::Store(of_coat, d, own->share.v + i);
    } else {
      reflected = hn::Add(reflected, of_coat);
    }
    hn::Store(reflected, d, reflection.share.v + i);
    if (refraction != nullptr) hn::Store(hn::Mul(k_t, through), d, refraction->share.v + i);

    // Light from all around: means for what comes in, and by Jensen's inequality not too much.
    const auto mean = CoatMean(d, layers, i);
    auto taken = zero;
    auto ambient = zero;
    if (layers.has_sheen) {
      const auto of_sheen = hn::Load(d, layers.sheen_view.v + i);
      LaneArray average;
      for (int k = 0; k < static_cast<int>(hn::Lanes(d)); ++k) {
        average[k] = LayerAlbedo::table().sheen_mean(layers.sheen_roughness[i + k]);
      }
      taken =
          hn::Mul(hn::Load(d, layers.sheen_most.v + i), hn::Max(of_sheen, hn::Load(d, average.v)));
      ambient = hn::Mul(hn::Mul(hn::Load(d, layers.sheen.v + i), of_sheen),
                        UnderCoat(d, layers, i, mean, zero, zero));
    }
    const auto left = hn::Max(hn::Sub(one, taken), zero);
    ambient = hn::Add(
        ambient, hn::Mul(hn::Mul(diffuse, left), UnderCoat(d, layers, i, mean, diffuse, mean)));
    if (layers.has_through) {
      ambient = hn::Add(ambient, hn::Mul(hn::Mul(hn::Load(d, answer.through.v + i), left),
                                         UnderCoat(d, layers, i, zero, zero, zero)));
    }
    hn::Store(ambient, d, layers.ambient.v + i);
  }
}

/// How often the sampled ray is drawn by a rough coat, rather than by what is under it: by what
/// each reflects, in the mean over the lanes.
inline float CoatChance(const SurfaceHit& hit, const SurfaceAnswer& answer,
                        const LayerLanes& layers, bool base_is_rough) {
  if (!layers.coat_is_rough) return 0.0f;
  if (!base_is_rough) return 1.0f;
  float of_coat = 0.0f, of_base = 0.0f;
  for (int lane = hit.lanes.front(); lane < kMaxLanes; ++lane) {
    if (!hit.lanes.test(lane)) continue;
    of_coat += layers.coat[lane] * layers.coat_view[lane];
    of_base += answer.lobes[0].share[lane];
  }
  const float all = of_coat + of_base;
  // Neither is without a chance: at other angles what reflects little here may reflect more.
  return all > 0.0f ? std::clamp(of_coat / all, 0.1f, 0.9f) : 0.5f;
}

}  // namespace HWY_NAMESPACE
}  // namespace abbe
HWY_AFTER_NAMESPACE();

#endif  // ABBE_INTEGRATE_SURFACE_LAYERS_INL_H_
