/// Ellipsoids and convex polyhedra as leaves hold them, and rays against them in double precision.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "abbe/accel/query.h"
#include "abbe/accel/shapes.h"
#include "abbe/math/ray.h"

namespace abbe {

/// The solids of a world as queries read them, by their numbers among all primitives.
struct SolidView {
  const Ellipsoid* ellipsoids = nullptr;
  const ConvexPolyhedron* polyhedra = nullptr;
  const Plane* planes = nullptr;
  const std::uint8_t* isolated = nullptr;  ///< As find_isolated_solids() has it.
  std::uint32_t triangle_count = 0;        ///< The number of the first ellipsoid.
  std::uint32_t first_polyhedron = 0;

  bool is_ellipsoid(std::uint32_t primitive) const { return primitive < first_polyhedron; }
  const Ellipsoid& ellipsoid(std::uint32_t primitive) const {
    return ellipsoids[primitive - triangle_count];
  }
  const ConvexPolyhedron& polyhedron(std::uint32_t primitive) const {
    return polyhedra[primitive - first_polyhedron];
  }
  std::span<const Plane> planes_of(std::uint32_t primitive) const {
    const ConvexPolyhedron& solid = polyhedron(primitive);
    return {planes + solid.first_plane, solid.plane_count};
  }
  const Box3f& bounds_of(std::uint32_t primitive) const {
    return is_ellipsoid(primitive) ? ellipsoid(primitive).bounds : polyhedron(primitive).bounds;
  }
  /// Whether the primitive is a solid that stands alone. Any number is allowed, kNoPrimitive too.
  bool is_isolated(std::uint32_t primitive) const {
    return primitive != kNoPrimitive && primitive >= triangle_count &&
           isolated[primitive - triangle_count] != 0;
  }
};

/// Copies of the solids of a world.
class SolidStore {
 public:
  SolidStore() = default;
  explicit SolidStore(const ShapeSpans& shapes);

  /// Valid as long as the store is neither moved nor destroyed.
  SolidView view() const;
  std::size_t bytes() const;

 private:
  std::vector<Ellipsoid> ellipsoids_;
  std::vector<ConvexPolyhedron> polyhedra_;
  std::vector<Plane> planes_;
  std::vector<std::uint8_t> isolated_;
  std::uint32_t triangle_count_ = 0;
};

/// Where the line of a ray enters and leaves a solid.
struct SolidCrossings {
  double enter = 0.0, leave = 0.0;
  /// Polyhedra: the planes that are met, counted from the first.
  std::uint32_t enter_face = 0, leave_face = 0;
};

/// Where a ray's line meets an ellipsoid, at t of any sign and beyond the ray's end, too.
/// Source: Haines et al., Precision improvements for ray/sphere intersection, Ray Tracing Gems 7.
std::optional<SolidCrossings> intersect_ellipsoid(const Ray& ray, const Ellipsoid& ellipsoid);

/// The same for a polyhedron given by its planes: the line enters the last of the half-spaces
/// ahead and leaves the first. Nothing where it lies behind the ray's origin.
std::optional<SolidCrossings> intersect_polyhedron(const Ray& ray, std::span<const Plane> planes);

}  // namespace abbe
