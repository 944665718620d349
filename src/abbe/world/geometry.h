/// What a scene is made of, placed in the world and flattened into arrays.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "abbe/accel/query.h"
#include "abbe/accel/shapes.h"
#include "abbe/base/notes.h"
#include "abbe/math/vec.h"
#include "abbe/scene/scene.h"

namespace abbe {

/// One placed mesh or exact shape. Attribute offsets are relative to the first vertex: the normal
/// of global vertex i is normals[i − first_vertex + normals_offset].
struct Surface {
  std::uint32_t material = 0;
  std::uint32_t object = 0;  ///< Number of the instance, for id channels.
  std::uint32_t first_vertex = 0;
  std::optional<std::uint32_t> normals_offset, tangents_offset, colors_offset;
  std::array<std::optional<std::uint32_t>, 2> uv_offset{};
  bool ends_light = false;  ///< Its primitives have kExactGlassBit.
};

/// Placed meshes and exact shapes. Primitives are numbered triangles first, then ellipsoids, then
/// polyhedra.
/// Units: metres, in the world.
struct Geometry {
  Vec3d origin_m{
      0.0};  ///< Of the scene: what is here at p, the scene's author placed at origin + p.
  std::vector<Surface> surfaces;
  std::vector<std::uint32_t> primitive_surface;  ///< Per primitive.
  std::vector<std::uint32_t> surface_solid;  ///< The primitive of an exact shape, or kNoPrimitive.

  std::vector<Vec3f> positions;
  std::vector<Triangle> triangles;
  std::vector<Vec3f> normals;
  std::vector<Vec4f> tangents;
  std::vector<Vec2f> uv;
  std::vector<Vec4f> colors_rec709;
  std::vector<Ellipsoid> ellipsoids;
  std::vector<Mat3d> ellipsoid_to_world;  ///< Inverse of each one's world_to_unit_linear.
  std::vector<ConvexPolyhedron> polyhedra;
  std::vector<Plane> planes;

  /// What an accelerator is built over; `masks` one per primitive.
  ShapeSpans shapes(std::span<const VisibilityMask> masks) const;
  std::size_t bytes() const;
  Box3f bounds_of(std::size_t primitive) const;
};

/// Places the instances of a scene, one surface each. Degenerate and non-finite triangles that
/// arise from an instance's transform are dropped with a warning.
/// Errors: input Error that names an instance whose transform flattens a shape, or whose planes
///         bound no solid.
Geometry flatten(const Scene& scene, Notes& notes);

}  // namespace abbe
