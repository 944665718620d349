/// The geometry of a hit: place, normals, coordinates, and how far to step off the surface.
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <optional>

#include "abbe/accel/query.h"
#include "abbe/math/vec.h"
#include "abbe/world/world.h"

namespace abbe {

/// A place on a surface.
struct SurfacePoint {
  Vec3f position{0.0f};
  Vec3f normal{0.0f};          ///< Geometric, unit length, pointing out of the solid.
  Vec3f shading_normal{0.0f};  ///< Interpolated or mapped, unit length, on the side of `normal`.
  /// Bound, along the normal, on the rounding errors of the position, of a point this far off it,
  /// and of testing this surface again from there: new rays start at position ± offset·normal.
  float offset_m = 0.0f;
  // Of a material that needs_frame(), on the side of `normal`.
  Vec3f coat_normal{0.0f};  ///< Of its clearcoat.
  Vec3f tangent{0.0f};      ///< Along the surface; the zero vector where nothing says where to.
  Vec3f bitangent{0.0f};    ///< Where texture coordinates grow upwards.
  Vec2f uv[2] = {Vec2f(0.0f), Vec2f(0.0f)};
  Vec4f color_rec709{1.0f};
  float uv_per_m[2] = {0.0f, 0.0f};  ///< Width in uv of one metre on the surface.
  std::uint32_t surface = 0;
};

/// Bound on the relative error of n roundings to float.
/// Source: Higham, Accuracy and Stability of Numerical Algorithms, 2nd ed., 3.1.
constexpr float rounding_bound(int n) {
  const float unit = static_cast<float>(n) * (std::numeric_limits<float>::epsilon() * 0.5f);
  return unit / (1.0f - unit);
}

/// What all points of a triangle share.
struct TriangleFrame {
  Triangle corners{};
  Vec3f a{0.0f}, b{0.0f}, c{0.0f};  ///< Positions of the corners.
  Vec3f normal{0.0f};               ///< Geometric, unit length.
  float twice_area = 0.0f;          ///< m².
  std::uint32_t surface = 0;
  std::array<Vec3f, 3> normals{};  ///< Of the corners, if the surface has any.
  /// What a mesh that shares its data adds to the step off its surface: rays are rounded in its
  /// space when they test the triangle.
  float added_offset_m = 0.0f;
  std::optional<std::uint32_t> place;  ///< Of a shared mesh, into Geometry::places.
};
TriangleFrame triangle_frame(const World& world, std::uint32_t primitive);

/// Whether points of a surface differ in more than place and interpolated normal: coordinates for
/// textures, vertex colours, normal maps.
inline bool has_attributes(const World& world, const Surface& surface) {
  const SurfaceMaterial& material = world.materials[surface.material];
  return material.is_textured() || material.normal_texture || surface.colors_offset ||
         material.needs_frame();
}

/// The place of a hit. Positions come from barycentric weights or from the shape itself, not from
/// origin + t·direction, and carry a bound on their error.
/// Domain: hit.is_hit().
/// Source: Pharr, Jakob & Humphreys, Physically Based Rendering, 3rd ed., 3.9.
SurfacePoint surface_point(const World& world, const Vec3f& origin, const Vec3f& direction,
                           const Hit& hit);

/// The same for a hit on a triangle whose frame is at hand.
SurfacePoint triangle_point(const World& world, const TriangleFrame& frame, const Hit& hit);

/// THE step off a surface, to the side that `direction` points to: where a new ray starts.
/// Units:  offset_m as SurfacePoint has it, along the unit normal `outward`.
inline Vec3f off_surface(const Vec3f& position, const Vec3f& outward, float offset_m,
                         const Vec3f& direction) {
  const float side = glm::dot(direction, outward) < 0.0f ? -1.0f : 1.0f;
  return position + (side * offset_m) * outward;
}
inline Vec3f off_surface(const SurfacePoint& point, const Vec3f& direction) {
  return off_surface(point.position, point.normal, point.offset_m, direction);
}

}  // namespace abbe
