#include "abbe/world/geometry.h"

#include <fmt/format.h>

#include <cmath>
#include <limits>
#include <string>
#include <utility>

#include "abbe/base/error.h"
#include "abbe/scene/convex.h"

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

  void add(std::uint32_t object, const Instance& instance) {
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
  }

  std::size_t dropped_triangles() const { return dropped_; }

 private:
  void add_mesh(Surface surface, const Mesh& mesh, const Mat4d& to_world) {
    surface.material = mesh.material;
    surface.first_vertex = static_cast<std::uint32_t>(geometry_.positions.size());
    const Mat3d linear(to_world);
    const Mat3d for_normals = glm::transpose(glm::inverse(linear));
    const bool mirrored = glm::determinant(linear) < 0.0;
    for (const Vec3f& position : mesh.positions) {
      geometry_.positions.emplace_back(Vec3d(to_world * Vec4d(Vec3d(position), 1.0)));
    }
    if (!mesh.normals.empty()) {
      surface.normals_offset = static_cast<std::uint32_t>(geometry_.normals.size());
      for (const Vec3f& normal : mesh.normals) {
        const Vec3d moved = for_normals * Vec3d(normal);
        const double length = glm::length(moved);
        // A useless normal becomes zero: shading then uses the triangle's own.
        geometry_.normals.push_back(std::isfinite(length) && length > 0.0 ? Vec3f(moved / length)
                                                                          : Vec3f(0.0f));
      }
    }
    if (!mesh.tangents.empty()) {
      surface.tangents_offset = static_cast<std::uint32_t>(geometry_.tangents.size());
      for (const Vec4f& tangent : mesh.tangents) {
        const Vec3f moved(linear * Vec3d(Vec3f(tangent)));
        geometry_.tangents.emplace_back(moved, mirrored ? -tangent.w : tangent.w);
      }
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
    const auto number = static_cast<std::uint32_t>(geometry_.surfaces.size());
    for (const auto& corner : mesh.triangles) {
      Triangle triangle{corner[0] + surface.first_vertex, corner[1] + surface.first_vertex,
                        corner[2] + surface.first_vertex};
      // A mirror image turns the winding round; outside has to stay outside.
      if (mirrored) std::swap(triangle[1], triangle[2]);
      const Vec3f& a = geometry_.positions[triangle[0]];
      const Vec3f& b = geometry_.positions[triangle[1]];
      const Vec3f& c = geometry_.positions[triangle[2]];
      if (!is_finite(a) || !is_finite(b) || !is_finite(c) || !has_area(a, b, c)) {
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
  std::vector<std::uint32_t> triangle_surface_, ellipsoid_surface_, polyhedron_surface_;
  std::size_t dropped_ = 0;
};

}  // namespace

Geometry flatten(const Scene& scene, Notes& notes) {
  Geometry geometry;
  geometry.origin_m = scene.origin_m;
  Flattener flattener(scene, geometry);
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

ShapeSpans Geometry::shapes(std::span<const VisibilityMask> masks) const {
  return {.positions = positions,
          .triangles = triangles,
          .ellipsoids = ellipsoids,
          .polyhedra = polyhedra,
          .planes = planes,
          .masks = masks};
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
         bytes(planes) + bytes(primitive_surface) + bytes(surfaces);
}

}  // namespace abbe
