/// Light that reaches places on chains of flat facets (world/chains.h), for all lanes at once.
/// Highway code, compiled once per instruction set.

#if defined(ABBE_INTEGRATE_CHAINS_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef ABBE_INTEGRATE_CHAINS_INL_H_
#undef ABBE_INTEGRATE_CHAINS_INL_H_
#else
#define ABBE_INTEGRATE_CHAINS_INL_H_
#endif

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "integrate/lanes-inl.h"
#include "integrate/shading.h"
#include "optics/fresnel-inl.h"
#include "world/world.h"

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
/// irradiance across them, 0 in lanes that are not lit. Returns whether any lane is.
template <class D>
HWY_INLINE bool LightOnChain(D d, const World& world, const Chain& chain, int set,
                             const LaneArray3& positions, LightGeometry& geometry, ChainWay& way) {
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
  const auto minus_one = hn::Set(d, -1.0f);
  const auto one = hn::Set(d, 1.0f);
  bool any = false;
  for (int i = 0; i < stride; i += static_cast<int>(hn::Lanes(d))) {
    auto place = Combine3(d, one, Load3(d, positions, i), minus_one, Set3(d, chain.origin));
    const auto weight = hn::LoadU(d, rows + i);
    auto lit = hn::Gt(weight, zero);
    for (int side = 0; side < chain.side_count && !hn::AllFalse(d, lit); ++side) {
      const float* plane = sides + static_cast<std::size_t>(side) * 4 * stride;
      const auto height =
          hn::Add(Dot3(d, load_vector(plane, i), place), hn::LoadU(d, plane + 3 * stride + i));
      lit = hn::And(lit, hn::Ge(height, zero));
    }
    if (hn::AllFalse(d, lit)) {
      hn::Store(zero, d, geometry.irradiance.v + i);
      Store3(d, Set3(d, Vec3f(0.0f, 0.0f, 1.0f)), geometry.direction, i);
      hn::Store(zero, d, geometry.distance_m.v + i);
      continue;
    }
    any = true;
    auto irradiance = hn::Mul(weight, hn::LoadU(d, light_row + i));
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

#endif  // ABBE_INTEGRATE_CHAINS_INL_H_
