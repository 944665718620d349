/// Materials spread over the lanes of a fan. Highway code, compiled once per instruction set.

#if defined(ABBE_INTEGRATE_SURFACE_MATERIAL_LANES_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef ABBE_INTEGRATE_SURFACE_MATERIAL_LANES_INL_H_
#undef ABBE_INTEGRATE_SURFACE_MATERIAL_LANES_INL_H_
#else
#define ABBE_INTEGRATE_SURFACE_MATERIAL_LANES_INL_H_
#endif

#include <algorithm>
#include <cmath>
#include <span>

#include "abbe/integrate/surface/answer-inl.h"
#include "abbe/integrate/surface/answer.h"
#include "abbe/integrate/surface/material_sample.h"
#include "abbe/math/lanes-inl.h"
#include "abbe/optics/fresnel-inl.h"

HWY_BEFORE_NAMESPACE();
namespace abbe {
namespace HWY_NAMESPACE {

/// Spreads a colour over the lanes: `color` says how, of_lanes(c, i) gives the coefficient c of its
/// lookup for the lanes from i on.
template <class D, class OfLanes>
HWY_INLINE void FillColor(D d, const World& world, const ColorSample& color,
                          const OfLanes& of_lanes, const float* row, int set, LaneArray& out) {
  const int stride = world.lanes.lane_stride();
  const int step = static_cast<int>(hn::Lanes(d));
  const float* abscissa = world.row(world.uplift_abscissa, set);
  for (int i = 0; i < stride; i += step) {
    auto value = color.uses_row ? hn::LoadU(d, row + i) : hn::Set(d, 1.0f);
    if (color.uses_lookup && color.lookup_is_rgb) {
      LaneArray channel[3];
      for (int c = 0; c < 3; ++c) hn::Store(of_lanes(c, i), d, channel[c].v);
      LaneArray of_lane;
      for (int k = 0; k < step; ++k) of_lane[k] = channel[world.lanes.channel_of(i + k)][k];
      value = hn::Mul(value, hn::Load(d, of_lane.v));
    } else if (color.uses_lookup && world.lanes.uplift() == Uplift::MallettYuksel) {
      auto sum = hn::Zero(d);
      for (int c = 0; c < 3; ++c) {
        const float* curve = world.row(world.uplift_basis[static_cast<std::size_t>(c)], set);
        sum = hn::Add(sum, hn::Mul(of_lanes(c, i), hn::LoadU(d, curve + i)));
      }
      value = hn::Mul(value, sum);
    } else if (color.uses_lookup) {
      value = hn::Mul(value, SigmoidValue(d, of_lanes(0, i), of_lanes(1, i), of_lanes(2, i),
                                          hn::LoadU(d, abscissa + i)));
    }
    hn::Store(value, d, out.v + i);
  }
}

/// The same colour for all lanes.
template <class D>
void FillColor(D d, const World& world, const ColorSample& color, const float* row, int set,
               LaneArray& out) {
  const Vec3f lookup = color.uses_lookup ? looked_up(world, color) : Vec3f(0.0f);
  FillColor(
      d, world, color, [&](int c, int) HWY_ATTR { return hn::Set(d, lookup[c]); }, row, set, out);
}

/// A colour that differs from lane to lane in its lookup.
template <class D>
void FillColor(D d, const World& world, std::span<const ColorSample> colors, const float* row,
               int set, LaneArray& out) {
  LaneArray3 lookups{};
  Vec3f lookup(0.0f);
  const int count = colors[0].uses_lookup ? world.lanes.lane_stride() : 0;
  for (int lane = 0; lane < count; ++lane) {
    // Neighbouring lanes often see the same colour.
    if (lane == 0 || colors[lane].lookup_rec709 != colors[lane - 1].lookup_rec709) {
      lookup = looked_up(world, colors[lane]);
    }
    lookups.set(lane, lookup);
  }
  const float* const coefficients[3] = {lookups.x.v, lookups.y.v, lookups.z.v};
  FillColor(
      d, world, colors[0], [&](int c, int i) HWY_ATTR { return hn::Load(d, coefficients[c] + i); },
      row, set, out);
}

/// Turns reflectances into the spectra of lamps: times a luminance in cd/m² and D65.
template <class D>
void ScaleEmission(D d, const World& world, const LaneArray& scale, int set, LaneArray& emission) {
  const float* d65 = world.row(world.d65, set);
  for (int i = 0; i < world.lanes.lane_stride(); i += static_cast<int>(hn::Lanes(d))) {
    hn::Store(hn::Mul(hn::Load(d, emission.v + i),
                      hn::Mul(hn::Load(d, scale.v + i), hn::LoadU(d, d65 + i))),
              d, emission.v + i);
  }
}

/// The same emission in all lanes, or one that differs from lane to lane: `colors` has one entry or
/// one per lane, and so has `scales_cd_m2`, the luminances of emissions that are looked up alone.
template <class D>
void FillEmission(D d, const World& world, const SurfaceMaterial& material,
                  std::span<const ColorSample> colors, const LaneArray& scales_cd_m2, int set,
                  LaneArray& emission) {
  if (!material.emission) return Splat(d, world.lanes.lane_stride(), 0.0f, emission);
  const float* row = world.row(*material.emission, set);
  if (colors.size() == 1) {
    FillColor(d, world, colors[0], row, set, emission);
  } else {
    FillColor(d, world, colors, row, set, emission);
  }
  if (!colors[0].uses_row && !world.lanes.is_rgb(Cause::Lamps)) {
    ScaleEmission(d, world, scales_cd_m2, set, emission);
  }
}

/// The material of a surface that is the same where all lanes met it.
template <class D>
void FillUniform(D d, const World& world, const SurfaceMaterial& material,
                 const MaterialSample& here, int set, bool wants_base_color, MaterialLanes& at) {
  const int stride = world.lanes.lane_stride();
  Splat(d, stride, here.metallic, at.metallic);
  Splat(d, stride, here.roughness, at.roughness);
  Splat(d, stride, here.metallic < 1.0f ? here.transmission : 0.0f, at.transmission);
  Splat(d, stride, here.alpha, at.alpha);
  if (material.film) {
    Splat(d, stride, here.film_factor, at.film_factor);
    Splat(d, stride, here.film_thickness_nm, at.film_thickness_nm);
  }
  if (wants_base_color) {
    FillColor(d, world, here.base_color, world.row(material.base_color, set), set, at.base_color);
  }
  LaneArray scale;
  if (material.emission && !here.emission.uses_row) Splat(d, stride, here.emission_scale, scale);
  FillEmission(d, world, material, std::span(&here.emission, 1), scale, set, at.emission);
}

/// The material of a surface whose colours differ from lane to lane. Lanes that are not of the hit
/// take its first one's.
template <class D>
void FillVarying(D d, const World& world, const SurfaceHit& hit, float footprint_m, int set,
                 bool wants_base_color, MaterialLanes& at) {
  const SurfaceMaterial& material = material_of(world, hit);
  const int stride = world.lanes.lane_stride();
  const MaterialSample leading =
      material_sample(world, material, hit.point(hit.lanes.front()), footprint_m);
  ColorSample base[kMaxLanes], emission[kMaxLanes];
  LaneArray emission_scale{};
  for (int lane = 0; lane < stride; ++lane) {
    const bool member = lane < world.lanes.lane_count() && hit.lanes.test(lane);
    const MaterialSample here =
        member ? material_sample(world, material, hit.point(lane), footprint_m) : leading;
    at.metallic[lane] = here.metallic;
    at.roughness[lane] = here.roughness;
    at.transmission[lane] = here.metallic < 1.0f ? here.transmission : 0.0f;
    at.alpha[lane] = here.alpha;
    at.film_factor[lane] = here.film_factor;
    at.film_thickness_nm[lane] = here.film_thickness_nm;
    base[lane] = here.base_color;
    emission[lane] = here.emission;
    emission_scale[lane] = here.emission_scale;
  }
  if (wants_base_color) {
    FillColor(d, world, std::span<const ColorSample>(base), world.row(material.base_color, set),
              set, at.base_color);
  }
  FillEmission(d, world, material, std::span<const ColorSample>(emission), emission_scale, set,
               at.emission);
}

/// The material where a group of lanes met it. Without a base colour, which takes as long as all
/// the rest, the surface is black.
/// Units: footprint_m is the width of the beam there.
template <class D>
MaterialLanes MaterialAt(D d, const World& world, const SurfaceHit& hit, float footprint_m, int set,
                         bool wants_base_color) {
  const SurfaceMaterial& material = material_of(world, hit);
  const bool has_colors = world.geometry.surfaces[hit.surface].colors_offset.has_value();
  MaterialLanes at;
  if (!wants_base_color) Splat(d, world.lanes.lane_stride(), 0.0f, at.base_color);
  if (hit.points_differ && (material.is_textured() || has_colors)) {
    FillVarying(d, world, hit, footprint_m, set, wants_base_color, at);
  } else {
    const MaterialSample here =
        material_sample(world, material, hit.point(hit.lanes.front()), footprint_m);
    FillUniform(d, world, material, here, set, wants_base_color, at);
  }
  return at;
}

/// Colours of one place for all lanes, or of one place a lane.
template <class D>
void FillColors(D d, const World& world, std::span<const ColorSample> colors, const ColorUse& use,
                int set, LaneArray& out) {
  const float* row = world.row(use.row, set);
  if (colors.size() == 1) {
    FillColor(d, world, colors[0], row, set, out);
  } else {
    FillColor(d, world, colors, row, set, out);
  }
  for (int lane = 0; lane < world.lanes.lane_stride(); ++lane) out[lane] *= use.scale;
}

/// The directions that a material with anisotropy has in a lane, and the roughness along them.
template <class D>
void FillDirections(D, const SurfaceHit& hit, int lane, const LayerSample& here, float roughness,
                    LayerLanes& layers) {
  const SurfacePoint& point = hit.point(lane);
  const Vec3f normal = hit.normal.get(lane);
  const float rough = std::max(roughness, kSmoothRoughness);
  const float alpha = rough * rough;
  layers.alpha_t[lane] = layers.alpha_b[lane] = alpha;
  const Vec3f along = here.direction.x * point.tangent + here.direction.y * point.bitangent;
  const Vec3f flat = along - glm::dot(along, normal) * normal;
  const float length2 = glm::dot(flat, flat);
  if (length2 > 1e-12f) {
    layers.tangent.set(lane, flat / std::sqrt(length2));
    layers.alpha_t[lane] = alpha + here.anisotropy * here.anisotropy * (1.0f - alpha);
  } else {
    layers.tangent.set(lane, Basis(normal).tangent);
  }
  layers.bitangent.set(lane, glm::cross(normal, layers.tangent.get(lane)));
}

/// The layers of a material where a group of lanes met it, but for what depends on the view.
/// Domain: the material has layers; `at` is filled.
template <class D>
void FillLayers(D d, const World& world, const SurfaceHit& hit, float footprint_m, int set,
                const MaterialLanes& at, LayerLanes& layers) {
  const SurfaceMaterial& material = material_of(world, hit);
  const SurfaceLayers& source = *material.layers;
  const int stride = world.lanes.lane_stride();
  const int leader = hit.lanes.front();
  const LayerSample leading = layer_sample(world, material, hit.point(leader), footprint_m);
  const bool varying = hit.points_differ && source.is_textured();
  ColorSample sheen[kMaxLanes], specular[kMaxLanes], through[kMaxLanes];
  LaneArray3 shading, facing;
  for (int i = 0; i < stride; i += static_cast<int>(hn::Lanes(d))) {
    const auto arrival = ArrivalAt(d, hit, i);
    Store3(d, arrival.shading, shading, i);
    Store3(d, arrival.facing, facing, i);
  }
  layers.has_coat = source.coat.has_value();
  layers.has_sheen = source.sheen.has_value();
  layers.is_anisotropic = source.anisotropy.has_value();
  layers.has_specular = source.specular.has_value();
  layers.has_through = source.through.has_value();
  layers.coat_is_apart = material.coat_has_own_normal();
  layers.coat_is_rough = layers.has_coat && leading.coat_roughness >= kSmoothRoughness;
  for (int lane = 0; lane < stride; ++lane) {
    const bool member = lane < world.lanes.lane_count() && hit.lanes.test(lane);
    const int place = member ? lane : leader;
    const LayerSample here =
        varying && member ? layer_sample(world, material, hit.point(lane), footprint_m) : leading;
    if (layers.has_coat) {
      layers.coat[lane] = here.coat;
      layers.coat_roughness[lane] = here.coat_roughness;
      Vec3f normal = shading.get(place);
      if (layers.coat_is_apart) {
        const Vec3f own = hit.point(place).coat_normal;
        normal = hit.front ? own : -own;
        if (!(glm::dot(normal, hit.direction.get(place)) < 0.0f)) normal = facing.get(place);
      }
      layers.coat_normal.set(lane, normal);
    }
    layers.sheen_most[lane] = here.sheen_most;
    layers.sheen_roughness[lane] = here.sheen_roughness;
    layers.specular[lane] = here.specular;
    layers.specular_most[lane] = here.specular_most;
    layers.through[lane] = here.through;
    sheen[lane] = here.sheen;
    specular[lane] = here.specular_color;
    through[lane] = here.through_color;
    if (!layers.is_anisotropic) continue;
    if (member) {
      FillDirections(d, hit, lane, here, at.roughness[lane], layers);
    } else {
      FillDirections(d, hit, leader, here, at.roughness[leader], layers);
      layers.tangent.set(lane, layers.tangent.get(leader));
      layers.bitangent.set(lane, layers.bitangent.get(leader));
      layers.alpha_t[lane] = layers.alpha_t[leader];
      layers.alpha_b[lane] = layers.alpha_b[leader];
    }
  }
  const std::size_t count = varying ? kMaxLanes : 1;
  if (layers.has_sheen) {
    FillColors(d, world, std::span<const ColorSample>(sheen, count), source.sheen->color, set,
               layers.sheen);
    // A spectrum may pass the channels that it stands for.
    for (int lane = 0; lane < stride; ++lane) {
      layers.sheen_most[lane] = std::max(layers.sheen_most[lane], layers.sheen[lane]);
    }
  }
  if (layers.has_specular) {
    FillColors(d, world, std::span<const ColorSample>(specular, count), source.specular->color, set,
               layers.specular_color);
    for (int lane = 0; lane < stride; ++lane) {
      layers.specular_most[lane] =
          std::max(layers.specular_most[lane], layers.specular_color[lane]);
    }
  }
  if (layers.has_through) {
    FillColors(d, world, std::span<const ColorSample>(through, count), source.through->color, set,
               layers.through_color);
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace abbe
HWY_AFTER_NAMESPACE();

#endif  // ABBE_INTEGRATE_SURFACE_MATERIAL_LANES_INL_H_
