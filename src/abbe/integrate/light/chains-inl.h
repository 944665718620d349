/// Light that reaches places on chains of flat facets (world/chains.h), for all lanes at once.
/// Highway code, compiled once per instruction set.

#if defined(ABBE_INTEGRATE_LIGHT_CHAINS_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef ABBE_INTEGRATE_LIGHT_CHAINS_INL_H_
#undef ABBE_INTEGRATE_LIGHT_CHAINS_INL_H_
#else
#define ABBE_INTEGRATE_LIGHT_CHAINS_INL_H_
#endif

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "abbe/integrate/light/light_geometry.h"
#include "abbe/integrate/light/lit_pixel-inl.h"
#include "abbe/math/lanes-inl.h"
#include "abbe/optics/fresnel-inl.h"
#include "abbe/world/world.h"

HWY_BEFORE_NAMESPACE();
namespace abbe {
namespace HWY_NAMESPACE {

/// Where light on a chain met its facets, relative to the chain's origin, and a distance that
/// covers the rounding errors of these places.
struct ChainWay {
  LaneArray3 places[kMostChainSteps];
  LaneArray slack_m;
};

/// Whether a ball about `center` may get light from a chain; a quick no.
inline bool may_light(const Chain& chain, const Vec3f& center, float radius_m) {
  const Vec3f v = center - chain.bound_center;
  const float along = glm::dot(v, chain.bound_axis);
  const float reach = chain.bound_radius_m + radius_m;
  if (along < -reach) return false;
  // The cone's tip is a ball: at a distance its cross section has grown by that distance's share.
  const float across2 = glm::dot(v, v) - along * along;
  const float widest = reach * (1.0f + chain.bound_tan) + std::max(along, 0.0f) * chain.bound_tan;
  return across2 <= widest * widest;
}

/// Parallel light on a chain: fills directions to the light, distances to the last facet, and the
/// irradiance across them, 0 in lanes that are not lit. Returns whether any lane is. The light is
/// the mean over a pixel about each place, each plane of the lit prism taken along the side that it
/// cuts more squarely. The geometry is that of the lit place nearest to each, so that what stands
/// in the way is asked where the samples are.
template <class D>
HWY_INLINE bool LightOnChain(D d, const World& world, const Chain& chain, int set,
                             const LaneArray3& positions, const PixelOnSurface& pixel,
                             LightGeometry& geometry, ChainWay& way) {
  const auto zero = hn::Zero(d);
  const int stride = world.lanes.lane_stride();
  const std::size_t step_count = chain.steps.size();
  const float* rows = world.chain_rows.data() + chain.rows +
                      static_cast<std::size_t>(set) * chain.array_count() * stride;
  const float* sides = rows + (1 + 3 * step_count) * stride;
  const WorldLight& light = world.lights[chain.light];
  const float* light_row = world.row(light.row, set);
  const auto load_vector = [&](const float* arrays, int i) {
    return Vec3Of<D>{hn::LoadU(d, arrays + i), hn::LoadU(d, arrays + stride + i),
                     hn::LoadU(d, arrays + 2 * stride + i)};
  };
  const auto one = hn::Set(d, 1.0f);
  const auto side_x = Set3(d, pixel.sides[0]);
  const auto side_y = Set3(d, pixel.sides[1]);
  const Vec3f to_pixel = pixel.shift - chain.origin;
  bool any = false;
  for (int i = 0; i < stride; i += static_cast<int>(hn::Lanes(d))) {
    auto place = Combine3(d, one, Load3(d, positions, i), one, Set3(d, to_pixel));
    const auto weight = hn::LoadU(d, rows + i);
    auto lit = hn::Gt(weight, zero);
    LitPart<D> part_x(d, pixel), part_y(d, pixel);
    for (int side = 0; side < chain.side_count && !hn::AllFalse(d, lit); ++side) {
      const float* plane = sides + static_cast<std::size_t>(side) * 4 * stride;
      const auto normal = load_vector(plane, i);
      const auto height = hn::Add(Dot3(d, normal, place), hn::LoadU(d, plane + 3 * stride + i));
      if (pixel.is_point()) {
        lit = hn::And(lit, hn::Ge(height, zero));
        continue;
      }
      const auto rise_x = Dot3(d, normal, side_x);
      const auto rise_y = Dot3(d, normal, side_y);
      const auto is_flat = hn::Eq(hn::Max(hn::Abs(rise_x), hn::Abs(rise_y)), zero);
      const auto by_x = hn::Ge(hn::Abs(rise_x), hn::Abs(rise_y));
      part_x.clip(d, hn::AndNot(is_flat, by_x), height, rise_x);
      part_y.clip(d, hn::Not(by_x), height, rise_y);
      lit = hn::And(lit, hn::Or(hn::AndNot(is_flat, hn::And(part_x.is_there(), part_y.is_there())),
                                hn::And(is_flat, hn::Ge(height, zero))));
    }
    if (hn::AllFalse(d, lit)) {
      hn::Store(zero, d, geometry.irradiance.v + i);
      Store3(d, Set3(d, Vec3f(0.0f, 0.0f, 1.0f)), geometry.direction, i);
      hn::Store(zero, d, geometry.distance_m.v + i);
      continue;
    }
    any = true;
    auto irradiance = hn::Mul(weight, hn::LoadU(d, light_row + i));
    if (!pixel.is_point()) {
      const auto share = hn::Mul(part_x.share(d, pixel), part_y.share(d, pixel));
      irradiance = hn::Mul(irradiance, share);
      place = Combine3(d, one, place, part_x.nearest(d, pixel.offset_px.x), side_x);
      place = Combine3(d, one, place, part_y.nearest(d, pixel.offset_px.y), side_y);
    }
    auto size = hn::Add(hn::Abs(place.x), hn::Add(hn::Abs(place.y), hn::Abs(place.z)));
    auto fog_way = zero;
    for (std::size_t s = step_count; s-- > 0;) {
      const ChainStep& step = chain.steps[s];
      const auto direction = load_vector(rows + (1 + 3 * s) * stride, i);
      const auto normal = Set3(d, step.normal);
      const auto height = hn::Sub(Dot3(d, normal, place), hn::Set(d, step.distance_m));
      const auto length = hn::Max(hn::Div(height, Dot3(d, normal, direction)), zero);
      place = Combine3(d, one, place, hn::Neg(length), direction);
      Store3(d, place, way.places[s], i);
      if (s + 1 == step_count) {
        const Vec3Of<D> to_light{hn::Neg(direction.x), hn::Neg(direction.y), hn::Neg(direction.z)};
        Store3(d, to_light, geometry.direction, i);
        hn::Store(length, d, geometry.distance_m.v + i);
        size = hn::Add(size, length);
      }
      const SurfaceMaterial& material = world.materials[step.material];
      const bool inside =
          step.event == ChainEvent::Enter || step.event == ChainEvent::ReflectInside;
      // Where something may stand on the way inside, the query for that absorbs, too.
      const bool is_asked = s + 1 == step_count || chain.steps[s + 1].is_checked;
      if (inside && !is_asked && material.absorption_per_m) {
        const auto absorption = hn::LoadU(d, world.row(*material.absorption_per_m, set) + i);
        irradiance = hn::Mul(irradiance, ExpNegative(d, hn::Mul(absorption, length)));
      }
      if (!inside) fog_way = hn::Add(fog_way, length);
    }
    if (world.fog) {
      if (light.is_beam) {
        const Vec3f from_light = chain.origin - light.position;
        const auto along = hn::Add(Dot3(d, place, Set3(d, light.direction)),
                                   hn::Set(d, glm::dot(from_light, light.direction)));
        fog_way = hn::Add(fog_way, hn::Max(along, zero));
      }
      const auto depth = hn::Mul(fog_way, hn::Set(d, world.fog->extinction_per_m));
      irradiance = hn::Mul(irradiance, ExpNegative(d, depth));
    }
    hn::Store(hn::IfThenElseZero(lit, irradiance), d, geometry.irradiance.v + i);
    // A few roundings of numbers as large as the way and the place in the world.
    const float far =
        std::max({std::abs(chain.origin.x), std::abs(chain.origin.y), std::abs(chain.origin.z)});
    const auto scale = hn::Add(size, hn::Set(d, far));
    hn::Store(hn::Mul(scale, hn::Set(d, 2e-6f)), d, way.slack_m.v + i);
  }
  return any;
}

}  // namespace HWY_NAMESPACE
}  // namespace abbe
HWY_AFTER_NAMESPACE();

#endif  // ABBE_INTEGRATE_LIGHT_CHAINS_INL_H_
