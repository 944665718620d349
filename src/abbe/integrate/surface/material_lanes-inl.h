/// Materials spread over the lanes of a fan. Highway code, compiled once per instruction set.

#if defined(ABBE_INTEGRATE_SURFACE_MATERIAL_LANES_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef ABBE_INTEGRATE_SURFACE_MATERIAL_LANES_INL_H_
#undef ABBE_INTEGRATE_SURFACE_MATERIAL_LANES_INL_H_
#else
#define ABBE_INTEGRATE_SURFACE_MATERIAL_LANES_INL_H_
#endif

#include <span>

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

}  // namespace HWY_NAMESPACE
}  // namespace abbe
HWY_AFTER_NAMESPACE();

#endif  // ABBE_INTEGRATE_SURFACE_MATERIAL_LANES_INL_H_
