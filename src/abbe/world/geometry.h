/// What a scene is made of, placed in the world and flattened into arrays.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "abbe/accel/instances/numbers.h"
#include "abbe/accel/query.h"
#include "abbe/accel/shapes.h"
#include "abbe/base/notes.h"
#include "abbe/math/vec.h"
#include "abbe/scene/scene.h"
#include "abbe/world/sharing_rule.h"

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

/// Where a triangle's data lies.
struct LocatedTriangle {
  Triangle corners{};  ///< Into positions.
  std::uint32_t surface = 0;
  /// Into places: positions, normals and tangents are those of mesh space; none: of the world.
  std::optional<std::uint32_t> place;
};

/// Placed meshes and exact shapes. Primitives are numbered triangles first, then ellipsoids, then
/// polyhedra, then the triangles of meshes that stand at several places and share their data.
/// Units: metres, in the world; of shared meshes in mesh space.
struct Geometry {
  Vec3d origin_m{
      0.0};  ///< Of the scene: what is here at p, the scene's author placed at origin + p.
  std::vector<Surface> surfaces;
  std::vector<std::uint32_t> primitive_surface;  ///< Per primitive but those of shared meshes.
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

  std::vector<Triangle> mesh_triangles;  ///< Of shared meshes.
  std::vector<TriangleRange> meshes;
  std::vector<MeshPlace> places;  ///< Sorted by mesh.
  std::vector<std::uint32_t> place_surface;
  std::vector<Mat3d> place_normals;  ///< For normals: the inverse transpose of each one's map.
  PlacedNumbers numbers;             ///< Of the primitives of places.

  bool is_triangle(std::uint32_t primitive) const {
    return primitive < triangles.size() || is_shared(primitive);
  }
  bool is_shared(std::uint32_t primitive) const { return primitive >= primitive_surface.size(); }
  /// Domain: the number of a primitive.
  std::uint32_t surface_of(std::uint32_t primitive) const {
    return is_shared(primitive) ? place_surface[numbers.triangle_of(primitive).place]
                                : primitive_surface[primitive];
  }
  /// Domain: the number of a triangle.
  LocatedTriangle located(std::uint32_t primitive) const {
    if (!is_shared(primitive)) return {triangles[primitive], primitive_surface[primitive], {}};
    const PlacedNumbers::PlacedTriangle found = numbers.triangle_of(primitive);
    return {mesh_triangles[meshes[places[found.place].mesh].first + found.triangle],
            place_surface[found.place], found.place};
  }
  /// The corners of a triangle in the world, not rounded further than they are in memory.
  std::array<Vec3d, 3> corners_of(std::uint32_t primitive) const;

  /// What an accelerator is built over; `masks` one per primitive but those of shared meshes,
  /// `front_only` one per triangle but theirs.
  ShapeSpans shapes(std::span<const VisibilityMask> masks,
                    std::span<const std::uint8_t> front_only = {}) const;
  std::size_t bytes() const;
  /// Domain: a primitive of no shared mesh.
  Box3f bounds_of(std::size_t primitive) const;
};

/// Normals and tangents of a mesh at a place. A useless normal becomes zero: shading then uses the
/// triangle's own.
Vec3f moved_normal(const Mat3d& for_normals, const Vec3f& normal);
Vec4f moved_tangent(const Mat3d& linear, bool mirrored, const Vec4f& tangent);

/// Places the instances of a scene, one surface each. Degenerate and non-finite triangles that
/// arise from an instance's transform are dropped with a warning. Instances share data where the
/// rule says so, but for those that `ends_light` marks, at which exact light starts, and those that
/// may be in contact where one of the two lets light through: both are found from primitives in the
/// world.
/// Shape:  `ends_light` a value per instance, or empty.
/// Errors: input Error that names an instance whose transform flattens a shape, or whose planes
///         bound no solid; or where there are more primitives than numbers.
Geometry flatten(const Scene& scene, Notes& notes, const SharingRule& rule = {},
                 std::span<const std::uint8_t> ends_light = {});

}  // namespace abbe
