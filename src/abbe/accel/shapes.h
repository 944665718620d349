/// What an accelerator is built over: spans of triangles, ellipsoids and convex polyhedra.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "abbe/math/ray.h"
#include "abbe/math/vec.h"

namespace abbe {

/// Indices of three positions, counter-clockwise seen from outside.
using Triangle = std::array<std::uint32_t, 3>;

/// The image of the unit sphere under an affine map.
struct Ellipsoid {
  /// Affine inverse of that map: columns x, y, z, translation. World point p is on the surface
  /// where |linear·p + offset| = 1.
  Mat3d world_to_unit_linear{1.0};
  Vec3d world_to_unit_offset{0.0};
  Box3f bounds;  ///< World bounds, rounded outwards.
};

/// The half-space normal·x ≤ distance.
struct Plane {
  Vec3d normal{0.0, 0.0, 1.0};  ///< Unit length, pointing out of the solid.
  double distance = 0.0;        ///< Metres.
};

/// A bounded intersection of half-spaces: planes [first_plane, first_plane + plane_count).
struct ConvexPolyhedron {
  std::uint32_t first_plane = 0;
  std::uint32_t plane_count = 0;
  Box3f bounds;  ///< World bounds, rounded outwards.
};

/// Which rays see a primitive: a ray and a primitive meet only if their masks share a bit.
using VisibilityMask = std::uint8_t;
inline constexpr VisibilityMask kOpaqueBit = 1;       ///< Stops light.
inline constexpr VisibilityMask kTransparentBit = 2;  ///< Light may pass: glass, alpha.
inline constexpr VisibilityMask kAllBits = 0xff;

/// What a query sees: primitives that share a bit with it, and of triangles that are there from the
/// front only (ShapeSpans::front_only), with neither of the bits below, both sides.
using QueryMask = std::uint16_t;
/// Those that a ray comes to from behind are not there: for rays of the eye, and for light where
/// rays go its way.
inline constexpr QueryMask kCullBack = 0x100;
/// Those that a ray comes to from the front are not there: for light that comes towards where a ray
/// begins, so that what stands between two places does not depend on which one is asked from.
inline constexpr QueryMask kCullFront = 0x200;

/// Triangles [first, first + count).
struct TriangleRange {
  std::uint32_t first = 0;
  std::uint32_t count = 0;
};

/// One of the places of a mesh that stands at several: world = linear·p + offset_m. Its triangles
/// are all alike to rays.
/// Domain: `linear` can be inverted. A mirror image turns the winding round: a mesh that is to keep
///         its outside is one of its own there, with the second and third corner swapped.
struct MeshPlace {
  std::uint32_t mesh = 0;
  VisibilityMask mask = kAllBits;
  bool front_only = false;  ///< As ShapeSpans::front_only, for all its triangles.
  Mat3d linear{1.0};
  Vec3d offset_m{0.0};
};

/// All primitives of a world. A primitive's number counts triangles first, then ellipsoids, then
/// polyhedra, then the triangles of placed meshes, place by place. The spans are read during the
/// build only.
struct ShapeSpans {
  std::span<const Vec3f> positions = {};
  std::span<const Triangle> triangles = {};
  std::span<const Ellipsoid> ellipsoids = {};
  std::span<const ConvexPolyhedron> polyhedra = {};
  std::span<const Plane> planes = {};
  /// One per primitive but those of placed meshes; empty means kAllBits for all.
  std::span<const VisibilityMask> masks = {};
  /// One per triangle: not 0 for those that are there only for what comes to them from the front,
  /// the half-space that the normal points into. Empty: none is.
  std::span<const std::uint8_t> front_only = {};

  /// Meshes that stand at several places: ranges of triangles over `positions`, which are in mesh
  /// space here.
  std::span<const Triangle> mesh_triangles = {};
  std::span<const TriangleRange> meshes = {};
  std::span<const MeshPlace> places = {};  ///< Sorted by mesh.

  std::span<const Triangle> triangles_of(const TriangleRange& mesh) const {
    return mesh_triangles.subspan(mesh.first, mesh.count);
  }
  /// Without placed meshes.
  std::size_t primitive_count() const {
    return triangles.size() + ellipsoids.size() + polyhedra.size();
  }
};

}  // namespace abbe
