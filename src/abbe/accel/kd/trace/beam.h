/// A ray with all its rounding errors around it, as the traversal sees it.
#pragma once

#include <algorithm>
#include <cmath>

#include "abbe/accel/kd/layout.h"
#include "abbe/math/ray.h"

namespace abbe {

/// The region that a ray and its rounding errors stay in: along each axis
/// low_origin + t·low_direction ≤ x(t) ≤ high_origin + t·high_direction for t ≥ 0.
/// What lies below a plane s can only be met where the lower bound is below s, what lies above it
/// where the upper bound is above s. Each is a half-line in t, found with one product: it ends at
/// (s − origin)·reciprocal when the reciprocal of the lower bound is positive or that of the upper
/// bound negative, else it begins there.
///
/// The triangle test finds hits up to 3 ulp of the distance beside the triangle, so a cell counts
/// as met when the ray passes it by 8 ulp of the largest distance in the scene. This replaces
/// bounds that are expanded at build, and holds for origins far outside the scene too.
struct alignas(32) Beam {
  float origin[8];      ///< Lower bound: 0 to 2 for x, y, z; upper bound: 4 to 6.
  float reciprocal[8];  ///< Of the direction, laid out alike.
  float t_near = 0.0f;
  float t_far = 0.0f;  ///< Below t_near when the ray misses the bounds.
};

inline constexpr float kBeamSlack = 0x1p-21f;

/// Numbers from low to high.
struct Interval {
  float low, high;
};

/// One axis of a beam: origins and directions within bounds; `reach` is the largest distance along
/// any axis from an origin to the scene, `longest` the largest direction component.
inline void set_beam_axis(Beam& beam, int axis, const Interval& origin, const Interval& direction,
                          float reach, float longest) {
  // A component this small moves the ray by less than the slack; it must only not be zero.
  const float tiny = std::max(longest * 1e-18f, 1e-37f);
  auto [low, high] = direction;
  if (std::abs(low) < tiny) low = -tiny;
  if (std::abs(high) < tiny) high = tiny;
  const float ulp = 0x1p-23f * std::max(std::abs(origin.low), std::abs(origin.high));
  const float width = std::max(reach * kBeamSlack, ulp);
  beam.origin[axis] = origin.low - width;
  beam.origin[4 + axis] = origin.high + width;
  beam.reciprocal[axis] = (1.0f / low) * (low > 0.0f ? 1.0f + kBeamSlack : 1.0f - kBeamSlack);
  beam.reciprocal[4 + axis] = (1.0f / high) * (high < 0.0f ? 1.0f + kBeamSlack : 1.0f - kBeamSlack);
}

/// Limits the beam to the bounds of the scene and to (0, t_max].
inline void clip_beam(Beam& beam, const Box3f& bounds, float t_max) {
  beam.t_near = 0.0f;
  beam.t_far = t_max;
  for (int k = 0; k < 3; ++k) {
    const float below = (bounds.high[k] - beam.origin[k]) * beam.reciprocal[k];
    const float above = (bounds.low[k] - beam.origin[4 + k]) * beam.reciprocal[4 + k];
    if (beam.reciprocal[k] > 0.0f) {
      beam.t_far = std::min(beam.t_far, below);
    } else {
      beam.t_near = std::max(beam.t_near, below);
    }
    if (beam.reciprocal[4 + k] > 0.0f) {
      beam.t_near = std::max(beam.t_near, above);
    } else {
      beam.t_far = std::min(beam.t_far, above);
    }
  }
}

/// The largest distance along an axis from a point to a corner of the box.
inline float reach_of(const Box3f& bounds, const Vec3f& point) {
  float reach = 0.0f;
  for (int k = 0; k < 3; ++k) {
    reach =
        std::max({reach, std::abs(bounds.low[k] - point[k]), std::abs(bounds.high[k] - point[k])});
  }
  return reach;
}

inline Beam make_beam(const Ray& ray, const Box3f& bounds) {
  Beam beam;
  const float reach = reach_of(bounds, ray.origin);
  const float longest =
      std::max({std::abs(ray.direction.x), std::abs(ray.direction.y), std::abs(ray.direction.z)});
  for (int k = 0; k < 3; ++k) {
    set_beam_axis(beam, k, {ray.origin[k], ray.origin[k]}, {ray.direction[k], ray.direction[k]},
                  reach, longest);
  }
  clip_beam(beam, bounds, ray.t_max);
  return beam;
}

}  // namespace abbe
