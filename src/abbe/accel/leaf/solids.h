/// Rays against ellipsoids and convex polyhedra, in double precision.
#pragma once

#include <optional>
#include <span>

#include "abbe/accel/shapes.h"
#include "abbe/math/ray.h"

namespace abbe {

struct SolidHit {
  double t = 0.0;
  std::uint32_t face = 0;  ///< Polyhedra: the plane that was met, counted from its first.
};

/// The first point of the surface at t in (0, t_max), from outside or from inside.
/// Source: Haines et al., Precision improvements for ray/sphere intersection, Ray Tracing Gems 7.
std::optional<SolidHit> intersect_ellipsoid(const Ray& ray, const Ellipsoid& ellipsoid);

/// The same for a polyhedron given by its planes: where the ray enters the last of the half-spaces
/// ahead, or, from inside, leaves the first.
std::optional<SolidHit> intersect_polyhedron(const Ray& ray, std::span<const Plane> planes);

}  // namespace abbe
