#include "abbe/report/figures/cross_section.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "abbe/base/constants.h"

namespace abbe {
namespace {

using Polyline = std::vector<Vec3d>;

std::optional<Polyline> cut_triangle(const std::array<Vec3d, 3>& corners, const Vec3d& normal,
                                     double distance_m) {
  std::array<double, 3> heights{};
  for (std::size_t i = 0; i < 3; ++i) heights[i] = glm::dot(normal, corners[i]) - distance_m;
  Polyline cut;
  for (std::size_t i = 0; i < 3; ++i) {
    const std::size_t j = (i + 1) % 3;
    // A corner in the plane counts as above it, so that it belongs to two edges or none.
    if ((heights[i] >= 0.0) == (heights[j] >= 0.0)) continue;
    const double share = heights[i] / (heights[i] - heights[j]);
    cut.push_back(corners[i] + share * (corners[j] - corners[i]));
  }
  if (cut.size() != 2) return std::nullopt;
  return cut;
}

// Each face's line in the plane, cut off at the other faces.
void cut_polyhedron(const World& world, const ConvexPolyhedron& body, const Vec3d& normal,
                    double distance_m, std::vector<Polyline>& cuts) {
  const std::span<const Plane> planes(world.geometry.planes.data() + body.first_plane,
                                      body.plane_count);
  for (const Plane& face : planes) {
    const Vec3d along = glm::cross(face.normal, normal);
    const double length2 = glm::dot(along, along);
    if (length2 < 1e-20) continue;
    const Vec3d start =
        (face.distance * glm::cross(normal, along) + distance_m * glm::cross(along, face.normal)) /
        length2;
    double begin = -1e30, end = 1e30;
    for (const Plane& other : planes) {
      if (&other == &face) continue;
      const double slope = glm::dot(other.normal, along);
      const double room = other.distance - glm::dot(other.normal, start);
      if (std::abs(slope) < 1e-12) {
        if (room < 0.0) end = begin;
      } else if (slope > 0.0) {
        end = std::min(end, room / slope);
      } else {
        begin = std::max(begin, room / slope);
      }
    }
    if (begin < end && begin > -1e30 && end < 1e30) {
      cuts.push_back({start + begin * along, start + end * along});
    }
  }
}

// In the space where the body is the unit sphere the cut is a circle.
void cut_ellipsoid(const Ellipsoid& body, const Vec3d& normal, double distance_m,
                   std::vector<Polyline>& cuts) {
  const Mat3d to_world = glm::inverse(body.world_to_unit_linear);
  const Vec3d center = -(to_world * body.world_to_unit_offset);
  const Vec3d unit_normal = glm::transpose(to_world) * normal;
  const double length = glm::length(unit_normal);
  const Vec3d axis = unit_normal / length;
  const double height = (distance_m - glm::dot(normal, center)) / length;
  if (std::abs(height) >= 1.0) return;
  const double radius = std::sqrt(1.0 - height * height);
  const Vec3d u =
      glm::normalize(glm::cross(axis, std::abs(axis.x) < 0.8 ? Vec3d(1, 0, 0) : Vec3d(0, 1, 0)));
  const Vec3d v = glm::cross(axis, u);
  constexpr int kSides = 128;
  Polyline circle;
  for (int i = 0; i <= kSides; ++i) {
    const double angle = 2.0 * kPi * i / kSides;
    circle.push_back(
        center + to_world * (height * axis + radius * (std::cos(angle) * u + std::sin(angle) * v)));
  }
  cuts.push_back(std::move(circle));
}

}  // namespace

std::vector<std::vector<Vec3d>> cross_section(const World& world,
                                              std::span<const std::uint32_t> surfaces,
                                              const Vec3d& normal, double distance_m) {
  std::vector<std::uint8_t> wanted(world.geometry.surfaces.size(), 0);
  for (const std::uint32_t surface : surfaces) wanted[surface] = 1;
  std::vector<Polyline> cuts;
  const std::size_t triangles = world.geometry.triangles.size();
  const std::size_t ellipsoids = world.geometry.ellipsoids.size();
  const auto add_triangle = [&](std::uint32_t primitive) {
    const std::array<Vec3d, 3> corners = world.geometry.corners_of(primitive);
    if (auto cut = cut_triangle(corners, normal, distance_m)) cuts.push_back(std::move(*cut));
  };
  for (std::size_t i = 0; i < world.geometry.primitive_surface.size(); ++i) {
    if (wanted[world.geometry.primitive_surface[i]] == 0) continue;
    if (i < triangles) {
      add_triangle(static_cast<std::uint32_t>(i));
    } else if (i < triangles + ellipsoids) {
      cut_ellipsoid(world.geometry.ellipsoids[i - triangles], normal, distance_m, cuts);
    } else {
      cut_polyhedron(world, world.geometry.polyhedra[i - triangles - ellipsoids], normal,
                     distance_m, cuts);
    }
  }
  auto next = static_cast<std::uint32_t>(world.geometry.primitive_surface.size());
  for (std::size_t i = 0; i < world.geometry.places.size(); ++i) {
    const std::uint32_t first = next;
    next += world.geometry.meshes[world.geometry.places[i].mesh].count;
    if (wanted[world.geometry.place_surface[i]] == 0) continue;
    for (std::uint32_t triangle = first; triangle < next; ++triangle) add_triangle(triangle);
  }
  return cuts;
}

}  // namespace abbe
