/// Materials spread over the lanes of a fan. Highway code, compiled once per instruction set.

#if defined(ABBE_INTEGRATE_MATERIAL_LANES_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef ABBE_INTEGRATE_MATERIAL_LANES_INL_H_
#undef ABBE_INTEGRATE_MATERIAL_LANES_INL_H_
#else
#define ABBE_INTEGRATE_MATERIAL_LANES_INL_H_
#endif

#include <span>

#include "integrate/buffers.h"
#include "integrate/integrator.h"
#include "integrate/material_sample.h"
#include "integrate/shade-inl.h"

HWY_BEFORE_NAMESPACE();
namespace abbe {
namespace HWY_NAMESPACE {

/// Spreads a colour over the lanes.
template <class D>
void FillColor(D d, const World& world, const ColorSample& color, const float* row, int set,
               LaneArray& out) {
  const int stride = world.lanes.lane_stride();
  if (color.uses_lookup && color.lookup_is_rgb) {
    for (int lane = 0; lane < stride; ++lane) out[lane] = lane_value(world, color, row, set, lane);
    return;
  }
  const float* abscissa = world.row(world.uplift_abscissa, set);
  for (int i = 0; i < stride; i += static_cast<int>(hn::Lanes(d))) {
    auto value = color.uses_row ? hn::LoadU(d, row + i) : hn::Set(d, 1.0f);
    if (color.uses_lookup && world.lanes.uplift() == Uplift::MallettYuksel) {
      auto sum = hn::Zero(d);
      for (std::size_t c = 0; c < 3; ++c) {
        const float* curve = world.row(world.uplift_basis[c], set);
        sum = hn::Add(
            sum, hn::Mul(hn::Set(d, color.lookup[static_cast<int>(c)]), hn::LoadU(d, curve + i)));
      }
      value = hn::Mul(value, sum);
    } else if (color.uses_lookup) {
      value = hn::Mul(value, SigmoidValue(d, hn::Set(d, color.lookup.x), hn::Set(d, color.lookup.y),
                                          hn::Set(d, color.lookup.z), hn::LoadU(d, abscissa + i)));
    }
    hn::Store(value, d, out.v + i);
  }
}

/// The material where a group of lanes met it: a value per lane in `at`, of which the points are
/// `points`.
template <class D>
void FillMaterial(D d, const World& world, const CameraSample& sample, const Fan& fan,
                  const LaneMask& lanes, const SurfaceMaterial& material, float path_length_m,
                  std::span<const SurfacePoint> points, Interaction& at) {
  const int stride = world.lanes.lane_stride();
  const float footprint_m = sample.footprint_m + sample.footprint_per_m * path_length_m;
  const bool varies = material.is_textured() ||
                      world.surfaces[points[lanes.front()].surface].colors_offset.has_value();
  const int step = static_cast<int>(hn::Lanes(d));
  const int set = sample.set;
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
    FillColor(d, world, here.base_color, base_row, set, at.base_color);
    if (!material.emission) {
      Splat(d, stride, 0.0f, at.emission);
    } else {
      FillColor(d, world, here.emission, emission_row, set, at.emission);
      if (!here.emission.uses_row && !world.lanes.is_rgb(Cause::Lamps)) {
        const float* d65 = world.row(world.d65, set);
        for (int i = 0; i < stride; i += step) {
          hn::Store(hn::Mul(hn::Load(d, at.emission.v + i),
                            hn::Mul(hn::Set(d, here.emission_scale), hn::LoadU(d, d65 + i))),
                    d, at.emission.v + i);
        }
      }
    }
    return;
  }
  const float* d65 = world.row(world.d65, set);
  for (int lane = 0; lane < stride; ++lane) {
    const bool member = lane < world.lanes.lane_count() && lanes.test(lane);
    const MaterialSample here =
        material_sample(world, material, points[member ? lane : lanes.front()], footprint_m);
    at.metallic[lane] = here.metallic;
    at.roughness[lane] = here.roughness;
    at.transmission[lane] = here.metallic < 1.0f ? here.transmission : 0.0f;
    at.alpha[lane] = here.alpha;
    at.film_factor[lane] = here.film_factor;
    at.film_thickness_nm[lane] = here.film_thickness_nm;
    at.base_color[lane] = lane_value(world, here.base_color, base_row, set, lane);
    at.emission[lane] = 0.0f;
    if (!material.emission) continue;
    at.emission[lane] = lane_value(world, here.emission, emission_row, set, lane);
    if (!here.emission.uses_row && !world.lanes.is_rgb(Cause::Lamps)) {
      at.emission[lane] *= here.emission_scale * d65[lane];
    }
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace abbe
HWY_AFTER_NAMESPACE();

#endif  // ABBE_INTEGRATE_MATERIAL_LANES_INL_H_
