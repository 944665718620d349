#include "abbe/integrate/surface/point.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace abbe {
namespace {

Vec3f unit_or(const Vec3f& v, const Vec3f& otherwise) {
  const float length2 = glm::dot(v, v);
  return length2 > 0.0f && std::isfinite(length2) ? v / std::sqrt(length2) : otherwise;
}

float distance2(const Vec3f& a, const Vec3f& b) {
  const Vec3f d = a - b;
  return glm::dot(d, d);
}

// How a map's own axes lie in the coordinates that its transform is applied to.
class UvTurn {
 public:
  UvTurn() = default;
  explicit UvTurn(const TextureUse& use) : linear_(use.uv_linear) {}

  bool is_any() const { return linear_ != TextureUse{}.uv_linear; }
  Vec2f moved(const Vec2f& uv) const {
    return {linear_[0] * uv.x + linear_[1] * uv.y, linear_[2] * uv.x + linear_[3] * uv.y};
  }
  // Where the map's u grows, of what the coordinates' u and v grow along: a column of the inverse.
  Vec3f tangent(const Vec3f& along_u, const Vec3f& along_v) const {
    return handedness() * (linear_[3] * along_u - linear_[2] * along_v);
  }
  float handedness() const {
    return linear_[0] * linear_[3] - linear_[1] * linear_[2] < 0.0f ? -1.0f : 1.0f;
  }

 private:
  std::array<float, 4> linear_ = TextureUse{}.uv_linear;
};

void fill_triangle(const World& world, const TriangleFrame& frame, const Hit& hit,
                   SurfacePoint& point) {
  const Surface& surface = world.geometry.surfaces[frame.surface];
  const Triangle& corners = frame.corners;
  const Vec3f& a = frame.a;
  const Vec3f& b = frame.b;
  const Vec3f& c = frame.c;
  const float u = hit.u;
  const float v = hit.v;
  const float w = 1.0f - u - v;
  point.position = w * a + u * b + v * c;
  point.normal = frame.normal;
  // Seven roundings make the position, two more the point beside it; and the next test of this
  // triangle works on corners relative to the ray, with an error that grows with their distance.
  const Vec3f sums = glm::abs(w * a) + glm::abs(u * b) + glm::abs(v * c);
  const float reach = std::sqrt(std::max(
      {distance2(a, point.position), distance2(b, point.position), distance2(c, point.position)}));
  point.offset_m = rounding_bound(9) * glm::dot(sums, glm::abs(point.normal)) +
                   rounding_bound(12) * reach + frame.added_offset_m;

  const auto interpolate = [&](const auto& values, std::uint32_t offset) {
    const std::uint32_t shift = offset - surface.first_vertex;
    return w * values[corners[0] + shift] + u * values[corners[1] + shift] +
           v * values[corners[2] + shift];
  };
  for (int set = 0; set < 2; ++set) {
    if (!surface.uv_offset[set]) continue;
    const std::uint32_t shift = *surface.uv_offset[set] - surface.first_vertex;
    const Vec2f uv_a = world.geometry.uv[corners[0] + shift];
    const Vec2f uv_b = world.geometry.uv[corners[1] + shift];
    const Vec2f uv_c = world.geometry.uv[corners[2] + shift];
    point.uv[set] = w * uv_a + u * uv_b + v * uv_c;
    const Vec2f d1 = uv_b - uv_a;
    const Vec2f d2 = uv_c - uv_a;
    point.uv_per_m[set] = std::sqrt(std::abs(d1.x * d2.y - d1.y * d2.x) / frame.twice_area);
  }
  if (surface.colors_offset) {
    point.color_rec709 = interpolate(world.geometry.colors_rec709, *surface.colors_offset);
  }
  point.shading_normal = point.normal;
  if (surface.normals_offset) {
    const Vec3f normal = w * frame.normals[0] + u * frame.normals[1] + v * frame.normals[2];
    point.shading_normal = unit_or(normal, point.normal);
    // Modellers' normals decide which side is meant only for shading; the winding decides outside.
    if (glm::dot(point.shading_normal, point.normal) < 0.0f) {
      point.shading_normal = -point.shading_normal;
    }
  }

  const SurfaceMaterial& material = world.materials[surface.material];
  const bool needs_frame = material.needs_frame();
  if (!material.normal_texture && !needs_frame) return;
  // Tangents of a set of coordinates along the surface, and whether there are any; turned with a
  // map whose coordinates `turn` them.
  const auto directions = [&](std::uint32_t set, const UvTurn& turn, Vec3f& tangent,
                              Vec3f& bitangent) {
    float handedness = 1.0f;
    if (surface.tangents_offset) {
      const std::uint32_t shift = *surface.tangents_offset - surface.first_vertex;
      std::array<Vec4f, 3> tangents;
      for (std::size_t i = 0; i < 3; ++i) tangents[i] = world.geometry.tangents[corners[i] + shift];
      if (frame.place) {
        const Mat3d& linear = world.geometry.places[*frame.place].linear;
        const bool mirrored = glm::determinant(linear) < 0.0;
        for (Vec4f& of_corner : tangents) of_corner = moved_tangent(linear, mirrored, of_corner);
      }
      const Vec4f t = w * tangents[0] + u * tangents[1] + v * tangents[2];
      tangent = Vec3f(t);
      handedness = t.w < 0.0f ? -1.0f : 1.0f;
      if (turn.is_any()) {
        const Vec3f n = point.shading_normal;
        const Vec3f along = unit_or(tangent - glm::dot(tangent, n) * n, Basis(n).tangent);
        tangent = turn.tangent(along, -handedness * glm::cross(n, along));
        handedness *= turn.handedness();
      }
    } else if (surface.uv_offset[set]) {
      const std::uint32_t shift = *surface.uv_offset[set] - surface.first_vertex;
      const Vec2f d1 =
          turn.moved(world.geometry.uv[corners[1] + shift] - world.geometry.uv[corners[0] + shift]);
      const Vec2f d2 =
          turn.moved(world.geometry.uv[corners[2] + shift] - world.geometry.uv[corners[0] + shift]);
      const float determinant = d1.x * d2.y - d1.y * d2.x;
      tangent = (b - a) * d2.y - (c - a) * d1.y;
      if (determinant < 0.0f) tangent = -tangent;
      // Texture v grows downwards, the bitangent of a normal map upwards.
      handedness = determinant < 0.0f ? 1.0f : -1.0f;
    } else {
      return false;
    }
    const Vec3f n = point.shading_normal;
    tangent = unit_or(tangent - glm::dot(tangent, n) * n, Basis(n).tangent);
    bitangent = glm::cross(n, tangent) * handedness;
    return true;
  };
  const auto mapped = [&](const TextureUse& use, float scale) {
    const Vec3f n = point.shading_normal;
    Vec3f tangent, bitangent;
    if (!surface.uv_offset[use.uv_set] ||
        !directions(use.uv_set, UvTurn(use), tangent, bitangent)) {
      return n;
    }
    const Vec4f texel =
        world.textures[use.texture].value(transformed_uv(use, point.uv[use.uv_set]), 0.0f);
    const Vec3f local = (2.0f * Vec3f(texel) - 1.0f) * Vec3f(scale, scale, 1.0f);
    const Vec3f result = unit_or(local.x * tangent + local.y * bitangent + local.z * n, n);
    return glm::dot(result, point.normal) > 0.0f ? result : n;
  };
  if (needs_frame) {
    const SurfaceLayers& layers = *material.layers;
    point.coat_normal = point.shading_normal;
    if (layers.coat && layers.coat->normal_texture) {
      point.coat_normal = mapped(*layers.coat->normal_texture, layers.coat->normal_scale);
    }
    if (layers.anisotropy) {
      const auto& texture = layers.anisotropy->texture;
      // A direction of anisotropy is one of the surface, whatever its map's coordinates.
      if (!directions(texture ? texture->uv_set : 0, {}, point.tangent, point.bitangent)) {
        point.tangent = point.bitangent = Vec3f(0.0f);
      }
    }
  }
  if (material.normal_texture) {
    point.shading_normal = mapped(*material.normal_texture, material.normal_scale);
  }
}

void fill_ellipsoid(const World& world, const Vec3d& on_ray, std::size_t index,
                    SurfacePoint& point) {
  const Ellipsoid& ellipsoid = world.geometry.ellipsoids[index];
  // Move the point onto the surface: the ray parameter's error is along the ray, not across it.
  Vec3d q = ellipsoid.world_to_unit_linear * on_ray + ellipsoid.world_to_unit_offset;
  q = glm::normalize(q);
  const Vec3d exact =
      world.geometry.ellipsoid_to_world[index] * (q - ellipsoid.world_to_unit_offset);
  point.position = Vec3f(exact);
  point.normal = Vec3f(glm::normalize(glm::transpose(ellipsoid.world_to_unit_linear) * q));
  point.shading_normal = point.normal;
  point.offset_m = rounding_bound(5) * glm::dot(glm::abs(point.position), glm::abs(point.normal));
  const SurfaceMaterial& material =
      world.materials[world.geometry.surfaces[point.surface].material];
  if (!material.needs_frame()) return;
  // East and north of a ball, whose Y axis is its pole's.
  point.coat_normal = point.normal;
  const Mat3d to_world = Mat3d(world.geometry.ellipsoid_to_world[index]);
  const Vec3f east(to_world * Vec3d(q.z, 0.0, -q.x));
  point.tangent = unit_or(east, Basis(point.normal).tangent);
  point.bitangent = glm::cross(point.normal, point.tangent);
}

void fill_polyhedron(const World& world, const Vec3d& on_ray, std::size_t index, float face,
                     SurfacePoint& point) {
  const ConvexPolyhedron& polyhedron = world.geometry.polyhedra[index];
  const Plane& plane =
      world.geometry.planes[polyhedron.first_plane + static_cast<std::uint32_t>(face)];
  const Vec3d exact = on_ray - (glm::dot(plane.normal, on_ray) - plane.distance) * plane.normal;
  point.position = Vec3f(exact);
  point.normal = Vec3f(plane.normal);
  point.shading_normal = point.coat_normal = point.normal;
  point.offset_m = rounding_bound(5) * glm::dot(glm::abs(point.position), glm::abs(point.normal));
}

// Moves a frame from the space of its mesh, where `cross` is that of its sides, to its place.
void move_frame(const Geometry& geometry, const Vec3d& cross, TriangleFrame& frame) {
  const MeshPlace& place = geometry.places[*frame.place];
  const Mat3d& for_normals = geometry.place_normals[*frame.place];
  // Areas, as vectors, are moved by the matrix of cofactors.
  const Vec3d moved = glm::determinant(place.linear) * (for_normals * cross);
  const double twice_area = glm::length(moved);
  const Vec3d normal = moved / twice_area;
  frame.normal = Vec3f(normal);
  frame.twice_area = static_cast<float>(twice_area);
  for (Vec3f& of_corner : frame.normals) of_corner = moved_normal(for_normals, of_corner);
  // An error e in mesh space is one of normal·linear·e along the normal. A ray's origin is rounded
  // there, to what is near the corners; and the test errs as it does in the world.
  const Vec3d to_height = glm::transpose(place.linear) * normal;
  const Vec3f largest = glm::max(glm::abs(frame.a), glm::max(glm::abs(frame.b), glm::abs(frame.c)));
  const float longest = std::sqrt(std::max(
      {distance2(frame.a, frame.b), distance2(frame.b, frame.c), distance2(frame.c, frame.a)}));
  const float in_mesh =
      rounding_bound(2) * static_cast<float>(glm::dot(glm::abs(to_height), Vec3d(largest))) +
      rounding_bound(12) * static_cast<float>(glm::length(to_height)) * longest;
  Vec3f farthest(0.0f);
  for (Vec3f* const corner : {&frame.a, &frame.b, &frame.c}) {
    *corner = Vec3f(place.linear * Vec3d(*corner) + place.offset_m);
    farthest = glm::max(farthest, glm::abs(*corner));
  }
  // The corners are rounded here, not there.
  frame.added_offset_m = in_mesh + rounding_bound(1) * glm::dot(farthest, glm::abs(frame.normal));
}

}  // namespace

TriangleFrame triangle_frame(const World& world, std::uint32_t primitive) {
  const Geometry& geometry = world.geometry;
  const LocatedTriangle located = geometry.located(primitive);
  TriangleFrame frame;
  frame.surface = located.surface;
  frame.corners = located.corners;
  frame.place = located.place;
  const Surface& surface = geometry.surfaces[frame.surface];
  if (surface.normals_offset) {
    const std::uint32_t shift = *surface.normals_offset - surface.first_vertex;
    for (std::size_t i = 0; i < 3; ++i) {
      frame.normals[i] = geometry.normals[frame.corners[i] + shift];
    }
  }
  frame.a = geometry.positions[frame.corners[0]];
  frame.b = geometry.positions[frame.corners[1]];
  frame.c = geometry.positions[frame.corners[2]];
  // In double: thin triangles far from the origin still have a direction to face.
  const Vec3d a(frame.a);
  const Vec3d cross = glm::cross(Vec3d(frame.b) - a, Vec3d(frame.c) - a);
  if (frame.place) {
    move_frame(geometry, cross, frame);
    return frame;
  }
  const double twice_area = glm::length(cross);
  frame.normal = Vec3f(cross / twice_area);
  frame.twice_area = static_cast<float>(twice_area);
  return frame;
}

SurfacePoint triangle_point(const World& world, const TriangleFrame& frame, const Hit& hit) {
  SurfacePoint point;
  point.surface = frame.surface;
  fill_triangle(world, frame, hit, point);
  return point;
}

SurfacePoint surface_point(const World& world, const Vec3f& origin, const Vec3f& direction,
                           const Hit& hit) {
  std::size_t index = hit.primitive;
  if (world.geometry.is_triangle(hit.primitive)) {
    return triangle_point(world, triangle_frame(world, hit.primitive), hit);
  }
  SurfacePoint point;
  point.surface = world.geometry.primitive_surface[hit.primitive];
  const Vec3d on_ray = Vec3d(origin) + static_cast<double>(hit.t) * Vec3d(direction);
  index -= world.geometry.triangles.size();
  if (index < world.geometry.ellipsoids.size()) {
    fill_ellipsoid(world, on_ray, index, point);
  } else {
    fill_polyhedron(world, on_ray, index - world.geometry.ellipsoids.size(), hit.u, point);
  }
  return point;
}

}  // namespace abbe
