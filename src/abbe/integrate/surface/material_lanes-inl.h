/// Materials spread over the lanes of a fan. Highway code, compiled once per instruction set.

#if defined(ABBE_INTEGRATE_SURFACE_MATERIAL_LANES_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef ABBE_INTEGRATE_SURFACE_MATERIAL_LANES_INL_H_
#undef ABBE_INTEGRATE_SURFACE_MATERIAL_LANES_INL_H_
#else
#define ABBE_INTEGRATE_SURFACE_MATERIAL_LANES_INL_H_
#endif

#include <span>

#include "abbe/integrate/buffers.h"
#include "abbe/integrate/integrator.h"
#include "abbe/integrate/surface/material_sample.h"
#include "abbe/integrate/surface/shade-inl.h"

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

/// The material where a group of lanes met it: a value per lane in `at`, of which the points are
/// `points`. Without a base colour, which takes as long as all the rest, the surface is black.
template <class D>
void FillMaterial(D d, const World& world, const CameraSample& sample, const Fan& fan,
                  const LaneMask& lanes, const SurfaceMaterial& material, float path_length_m,
                  std::span<const SurfacePoint> points, bool wants_base_color, Interaction& at) {
  const int stride = world.lanes.lane_stride();
  const float footprint_m = sample.footprint_m + sample.footprint_per_m * path_length_m;
  const bool varies =
      material.is_textured() ||
      world.geometry.surfaces[points[lanes.front()].surface].colors_offset.has_value();
  const int set = sample.set;
  if (!wants_base_color) Splat(d, stride, 0.0f, at.base_color);
  const float* base_row = world.row(material.base_color, set);
  const float* emission_row = material.emission ? world.row(*material.emission, set) : nullptr;
  if (!varies || !fan.spread) {
    const int leader = fan.spread ? lanes.front() : 0;
    const MaterialSample here = material_sample(world, material, points[leader], footprint_m);
    Splat(d, stride, here.metallic, at.metallic);
    Splat(d, stride, here.roughness, at.roughness);
    Splat(d, stride, here.transmission * (here.metallic < 1.0f ? 1.0f : 0.0f), at.transmission);
    Splat(d, stride, here.alpha, at.alpha);
    if (material.film) {
      Splat(d, stride, here.film_factor, at.film_factor);
      Splat(d, stride, here.film_thickness_nm, at.film_thickness_nm);
    }
    if (wants_base_color) FillColor(d, world, here.base_color, base_row, set, at.base_color);
    if (!material.emission) {
      Splat(d, stride, 0.0f, at.emission);
    } else {
      FillColor(d, world, here.emission, emission_row, set, at.emission);
      if (!here.emission.uses_row && !world.lanes.is_rgb(Cause::Lamps)) {
        LaneArray scale;
        Splat(d, stride, here.emission_scale, scale);
        ScaleEmission(d, world, scale, set, at.emission);
      }
    }
    return;
  }
  // Other lanes take the leader's material.
  const MaterialSample leading =
      material_sample(world, material, points[lanes.front()], footprint_m);
  ColorSample base[kMaxLanes], emission[kMaxLanes];
  LaneArray emission_scale{};
  for (int lane = 0; lane < stride; ++lane) {
    const bool member = lane < world.lanes.lane_count() && lanes.test(lane);
    const MaterialSample here =
        member ? material_sample(world, material, points[lane], footprint_m) : leading;
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
  if (wants_base_color) FillColor(d, world, base, base_row, set, at.base_color);
  if (!material.emission) {
    Splat(d, stride, 0.0f, at.emission);
    return;
  }
  FillColor(d, world, emission, emission_row, set, at.emission);
  if (!leading.emission.uses_row && !world.lanes.is_rgb(Cause::Lamps)) {
    ScaleEmission(d, world, emission_scale, set, at.emission);
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace abbe
HWY_AFTER_NAMESPACE();

#endif  // ABBE_INTEGRATE_SURFACE_MATERIAL_LANES_INL_H_
