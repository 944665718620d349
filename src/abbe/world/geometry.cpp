#include "abbe/world/geometry.h"

#include <fmt/format.h>

#include <cmath>
#include <limits>
#include <map>
#include <string>
#include <utility>

#include "abbe/base/error.h"
#include "abbe/scene/convex.h"
#include "abbe/world/sharing.h"

namespace abbe {
namespace {

Box3f outward_bounds(const Vec3d& low, const Vec3d& high) {
  Box3f box;
  for (int axis = 0; axis < 3; ++axis) {
    box.low[axis] = std::nextafter(static_cast<float>(low[axis]), -kInfinity);
    box.high[axis] = std::nextafter(static_cast<float>(high[axis]), kInfinity);
  }
  return box;
}

bool is_finite(const Vec3f& v) {
  return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
}

bool has_area(const Vec3f& a, const Vec3f& b, const Vec3f& c) {
  const Vec3d normal = glm::cross(Vec3d(b) - Vec3d(a), Vec3d(c) - Vec3d(a));
  return glm::dot(normal, normal) > 0.0;
}

/// Builds the flat arrays, surface by surface. The surfaces of each kind of primitive are collected
/// apart and joined at the end.
class Flattener {
 public:
  Flattener(const Scene& scene, Geometry& geometry) : scene_(scene), geometry_(geometry) {}

  // The data of a shared mesh, and the surface of its instances but for their number.
  void add_shared(const SharedMesh& shared) {
    const Mesh& mesh = scene_.meshes[shared.mesh];
    Surface surface;
    add_vertices(surface, mesh, [&](const Vec3f& p) { return Vec3f(Vec3d(p) - shared.center); });
    geometry_.normals.insert(geometry_.normals.end(), mesh.normals.begin(), mesh.normals.end());
    geometry_.tangents.insert(geometry_.tangents.end(), mesh.tangents.begin(), mesh.tangents.end());
    TriangleRange range;
    range.first = static_cast<std::uint32_t>(geometry_.mesh_triangles.size());
    for (const auto& corner : mesh.triangles) {
      const Triangle triangle = global(corner, surface, shared.is_mirrored);
      if (!is_sound(triangle)) {
        ++dropped_;
        continue;
      }
      geometry_.mesh_triangles.push_back(triangle);
    }
    range.count = static_cast<std::uint32_t>(geometry_.mesh_triangles.size()) - range.first;
    const auto number = static_cast<std::uint32_t>(geometry_.meshes.size());
    geometry_.meshes.push_back(range);
    if (range.count == 0) return;
    for (const std::uint32_t instance : shared.instances) {
      const Mat4d& to_world = scene_.instances[instance].to_world;
      MeshPlace place;
      place.mesh = number;
      place.linear = Mat3d(to_world);
      place.offset_m = Vec3d(to_world * Vec4d(shared.center, 1.0));
      geometry_.places.push_back(place);
      geometry_.place_normals.push_back(glm::transpose(glm::inverse(place.linear)));
      geometry_.place_surface.push_back(instance);
      shared_surfaces_[instance] = surface;
    }
  }

  void add(std::uint32_t object, const Instance& instance) {
    if (const auto shared = shared_surfaces_.find(object); shared != shared_surfaces_.end()) {
      geometry_.surfaces.push_back(shared->second);
      geometry_.surfaces.back().object = object;
      return;
    }
    Surface surface;
    surface.object = object;
    if (const auto* mesh = std::get_if<std::uint32_t>(&instance.what)) {
      add_mesh(surface, scene_.meshes[*mesh], instance.to_world);
    } else {
      add_shape(surface, std::get<Shape>(instance.what), instance);
    }
  }

  void finish() {
    std::vector<std::uint32_t>& all = geometry_.primitive_surface;
    all = std::move(triangle_surface_);
    all.insert(all.end(), ellipsoid_surface_.begin(), ellipsoid_surface_.end());
    all.insert(all.end(), polyhedron_surface_.begin(), polyhedron_surface_.end());
    geometry_.surface_solid.assign(geometry_.surfaces.size(), kNoPrimitive);
    for (std::size_t i = geometry_.triangles.size(); i < all.size(); ++i) {
      geometry_.surface_solid[all[i]] = static_cast<std::uint32_t>(i);
    }
    geometry_.numbers = PlacedNumbers(geometry_.meshes, geometry_.places, all.size());
  }

  std::size_t dropped_triangles() const { return dropped_; }

 private:
  // What does not depend on the place, and positions; room for normals and tangents.
  template <class Move>
  void add_vertices(Surface& surface, const Mesh& mesh, const Move& move) {
    surface.material = mesh.material;
    surface.first_vertex = static_cast<std::uint32_t>(geometry_.positions.size());
    for (const Vec3f& position : mesh.positions) geometry_.positions.push_back(move(position));
    if (!mesh.normals.empty()) {
      surface.normals_offset = static_cast<std::uint32_t>(geometry_.normals.size());
    }
    if (!mesh.tangents.empty()) {
      surface.tangents_offset = static_cast<std::uint32_t>(geometry_.tangents.size());
    }
    for (std::size_t set = 0; set < surface.uv_offset.size(); ++set) {
      if (mesh.uv[set].empty()) continue;
      surface.uv_offset[set] = static_cast<std::uint32_t>(geometry_.uv.size());
      geometry_.uv.insert(geometry_.uv.end(), mesh.uv[set].begin(), mesh.uv[set].end());
    }
    if (!mesh.colors_rec709.empty()) {
      surface.colors_offset = static_cast<std::uint32_t>(geometry_.colors_rec709.size());
      geometry_.colors_rec709.insert(geometry_.colors_rec709.end(), mesh.colors_rec709.begin(),
                                     mesh.colors_rec709.end());
    }
  }

  // A mirror image turns the winding round; outside has to stay outside.
  static Triangle global(const Triangle& corner, const Surface& surface, bool mirrored) {
    Triangle triangle{corner[0] + surface.first_vertex, corner[1] + surface.first_vertex,
                      corner[2] + surface.first_vertex};
    if (mirrored) std::swap(triangle[1], triangle[2]);
    return triangle;
  }

  bool is_sound(const Triangle& triangle) const {
    const Vec3f& a = geometry_.positions[triangle[0]];
    const Vec3f& b = geometry_.positions[triangle[1]];
    const Vec3f& c = geometry_.positions[triangle[2]];
    return is_finite(a) && is_finite(b) && is_finite(c) && has_area(a, b, c);
  }

  void add_mesh(Surface surface, const Mesh& mesh, const Mat4d& to_world) {
    const Mat3d linear(to_world);
    const Mat3d for_normals = glm::transpose(glm::inverse(linear));
    const bool mirrored = glm::determinant(linear) < 0.0;
    add_vertices(surface, mesh, [&](const Vec3f& position) {
      return Vec3f(Vec3d(to_world * Vec4d(Vec3d(position), 1.0)));
    });
    for (const Vec3f& normal : mesh.normals) {
      geometry_.normals.push_back(moved_normal(for_normals, normal));
    }
    for (const Vec4f& tangent : mesh.tangents) {
      geometry_.tangents.push_back(moved_tangent(linear, mirrored, tangent));
    }
    const auto number = static_cast<std::uint32_t>(geometry_.surfaces.size());
    for (const auto& corner : mesh.triangles) {
      const Triangle triangle = global(corner, surface, mirrored);
      if (!is_sound(triangle)) {
        ++dropped_;
        continue;
      }
      geometry_.triangles.push_back(triangle);
      triangle_surface_.push_back(number);
    }
    geometry_.surfaces.push_back(surface);
  }

  void add_shape(Surface surface, const Shape& shape, const Instance& instance) {
    surface.material = shape.material;
    const Mat3d linear(instance.to_world);
    const Vec3d offset(instance.to_world[3]);
    const std::string where = instance.name.empty() ? shape.name : instance.name;
    if (!(std::abs(glm::determinant(linear)) > 0.0)) {
      throw_input_error(where, "a transform that flattens a shape", "one that can be inverted");
    }
    const auto number = static_cast<std::uint32_t>(geometry_.surfaces.size());
    if (const auto* sphere = std::get_if<SphereShape>(&shape.geometry)) {
      const Mat3d unit_to_world = linear * sphere->radius_m;
      Ellipsoid ellipsoid;
      ellipsoid.world_to_unit_linear = glm::inverse(unit_to_world);
      ellipsoid.world_to_unit_offset = -(ellipsoid.world_to_unit_linear * offset);
      // The half extent along an axis is the length of that row of the map.
      const Mat3d rows = glm::transpose(unit_to_world);
      const Vec3d half(glm::length(rows[0]), glm::length(rows[1]), glm::length(rows[2]));
      ellipsoid.bounds = outward_bounds(offset - half, offset + half);
      geometry_.ellipsoids.push_back(ellipsoid);
      geometry_.ellipsoid_to_world.push_back(unit_to_world);
      ellipsoid_surface_.push_back(number);
    } else {
      add_polyhedron(std::get<ConvexShape>(shape.geometry), instance.to_world, where);
      polyhedron_surface_.push_back(number);
    }
    geometry_.surfaces.push_back(surface);
  }

  void add_polyhedron(const ConvexShape& shape, const Mat4d& to_world, const std::string& where) {
    const std::vector<Vec3d> corners = corners_of(shape);
    if (corners.size() < 4 || !is_bounded(shape)) {
      throw_input_error(where, "planes that bound no solid",
                        "planes whose half-spaces n·x <= d share a finite volume");
    }
    Vec3d low(std::numeric_limits<double>::infinity());
    Vec3d high(-std::numeric_limits<double>::infinity());
    for (const Vec3d& corner : corners) {
      const Vec3d placed(to_world * Vec4d(corner, 1.0));
      low = glm::min(low, placed);
      high = glm::max(high, placed);
    }
    ConvexPolyhedron polyhedron;
    polyhedron.first_plane = static_cast<std::uint32_t>(geometry_.planes.size());
    polyhedron.bounds = outward_bounds(low, high);
    const Mat3d for_normals = glm::transpose(glm::inverse(Mat3d(to_world)));
    for (const Vec4d& source : shape.planes) {
      const Vec3d normal = for_normals * Vec3d(source);
      const double length = glm::length(normal);
      if (!(length > 0.0)) continue;
      Plane plane;
      plane.normal = normal / length;
      plane.distance = (source.w + glm::dot(normal, Vec3d(to_world[3]))) / length;
      geometry_.planes.push_back(plane);
    }
    polyhedron.plane_count =
        static_cast<std::uint32_t>(geometry_.planes.size()) - polyhedron.first_plane;
    geometry_.polyhedra.push_back(polyhedron);
  }

  const Scene& scene_;
  Geometry& geometry_;
  std::map<std::uint32_t, Surface> shared_surfaces_;  // By instance.
  std::vector<std::uint32_t> triangle_surface_, ellipsoid_surface_, polyhedron_surface_;
  std::size_t dropped_ = 0;
};

}  // namespace

Vec3f moved_normal(const Mat3d& for_normals, const Vec3f& normal) {
  const Vec3d moved = for_normals * Vec3d(normal);
  const double length = glm::length(moved);
  return std::isfinite(length) && length > 0.0 ? Vec3f(moved / length) : Vec3f(0.0f);
}

Vec4f moved_tangent(const Mat3d& linear, bool mirrored, const Vec4f& tangent) {
  const Vec3f moved(linear * Vec3d(Vec3f(tangent)));
  return {moved, mirrored ? -tangent.w : tangent.w};
}

std::array<Vec3d, 3> Geometry::corners_of(std::uint32_t primitive) const {
  const LocatedTriangle triangle = located(primitive);
  std::array<Vec3d, 3> corners;
  for (std::size_t i = 0; i < 3; ++i) {
    corners[i] = Vec3d(positions[triangle.corners[i]]);
    if (!triangle.place) continue;
    const MeshPlace& place = places[*triangle.place];
    corners[i] = place.linear * corners[i] + place.offset_m;
  }
  return corners;
}

Geometry flatten(const Scene& scene, Notes& notes, const SharingRule& rule,
                 std::span<const std::uint8_t> ends_light) {
  Geometry geometry;
  geometry.origin_m = scene.origin_m;
  Flattener flattener(scene, geometry);
  for (const SharedMesh& shared : find_shared_meshes(scene, rule, ends_light, notes)) {
    flattener.add_shared(shared);
  }
  for (std::size_t i = 0; i < scene.instances.size(); ++i) {
    flattener.add(static_cast<std::uint32_t>(i), scene.instances[i]);
  }
  flattener.finish();
  if (flattener.dropped_triangles() > 0) {
    notes.warn(scene.name,
               fmt::format("dropped {} triangles that are degenerate or not finite once "
                           "placed in the scene",
                           flattener.dropped_triangles()));
  }
  return geometry;
}

ShapeSpans Geometry::shapes(std::span<const VisibilityMask> masks,
                            std::span<const std::uint8_t> front_only) const {
  return {.positions = positions,
          .triangles = triangles,
          .ellipsoids = ellipsoids,
          .polyhedra = polyhedra,
          .planes = planes,
          .masks = masks,
          .front_only = front_only,
          .mesh_triangles = mesh_triangles,
          .meshes = meshes,
          .places = places};
}

Box3f Geometry::bounds_of(std::size_t primitive) const {
  if (primitive < triangles.size()) {
    Box3f box;
    for (const std::uint32_t corner : triangles[primitive]) box.extend(positions[corner]);
    return box;
  }
  primitive -= triangles.size();
  return primitive < ellipsoids.size() ? ellipsoids[primitive].bounds
                                       : polyhedra[primitive - ellipsoids.size()].bounds;
}

std::size_t Geometry::bytes() const {
  const auto bytes = [](const auto& v) { return v.capacity() * sizeof(v[0]); };
  return bytes(positions) + bytes(triangles) + bytes(normals) + bytes(tangents) + bytes(uv) +
         bytes(colors_rec709) + bytes(ellipsoids) + bytes(ellipsoid_to_world) + bytes(polyhedra) +
         bytes(planes) + bytes(primitive_surface) + bytes(surfaces) + bytes(mesh_triangles) +
         bytes(places) + bytes(place_surface) + bytes(place_normals);
}

}  // namespace abbe
