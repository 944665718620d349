#include "abbe/caustics/flat/inclusions.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <variant>

#include "abbe/math/vec.h"
#include "abbe/scene/convex.h"

namespace abbe {
namespace {

// What is as near as this share of its coordinates touches: 4 units in the last place of floats.
constexpr double kTouches = 4.0 * static_cast<double>(std::numeric_limits<float>::epsilon());
// Triangles that are looked at, of all objects for all bodies; further ones may lie anywhere.
constexpr std::size_t kMostTriangles = 30000000;

double touches_m(const Vec3d& place) {
  return kTouches * std::max({std::abs(place.x), std::abs(place.y), std::abs(place.z)});
}

/// A plane with a body behind it.
struct HullPlane {
  Vec3d normal{0.0};
  double distance = 0.0;

  bool is_behind(const Vec3d& place) const {
    return glm::dot(normal, place) <= distance + touches_m(place);
  }
  bool is_beyond(const Vec3d& place) const {
    return glm::dot(normal, place) >= distance - touches_m(place);
  }
};

std::vector<HullPlane> hull_planes_of(const std::vector<Facet>& facets) {
  std::vector<HullPlane> planes;
  for (const Facet& facet : facets) {
    const HullPlane plane{facet.normal, facet.distance};
    const bool is_outer = std::all_of(facets.begin(), facets.end(), [&](const Facet& other) {
      return std::all_of(other.corners.begin(), other.corners.end(),
                         [&](const Vec3d& corner) { return plane.is_behind(corner); });
    });
    if (is_outer) planes.push_back(plane);
  }
  return planes;
}

template <typename Places>
bool are_beyond_one(const std::vector<HullPlane>& planes, const Places& places) {
  return std::any_of(planes.begin(), planes.end(), [&](const HullPlane& plane) {
    return std::all_of(places.begin(), places.end(),
                       [&](const Vec3d& place) { return plane.is_beyond(place); });
  });
}

/// An object of a scene, placed.
class Surroundings {
 public:
  Surroundings(const Scene& scene, const Instance& instance)
      : scene_(scene), instance_(instance), box_(bounds_of(scene, instance)) {}

  const Box3d& box() const { return box_; }

  /// Whether it may reach behind all of the planes; `left` triangles are looked at for that.
  bool may_reach_behind(const std::vector<HullPlane>& planes, const Box3d& box, std::size_t& left) {
    if (const auto* mesh = std::get_if<std::uint32_t>(&instance_.what)) {
      return may_reach_behind(scene_.meshes[*mesh], planes, box, left);
    }
    const Shape& shape = std::get<Shape>(instance_.what);
    if (const auto* convex = std::get_if<ConvexShape>(&shape.geometry)) {
      std::vector<Vec3d> corners = corners_of(*convex);
      for (Vec3d& corner : corners) corner = placed(corner);
      return !are_beyond_one(planes, corners);
    }
    const double radius_m = std::get<SphereShape>(shape.geometry).radius_m;
    const Vec3d center = placed(Vec3d(0.0));
    const Mat3d to_local = glm::transpose(Mat3d(instance_.to_world));
    return std::none_of(planes.begin(), planes.end(), [&](const HullPlane& plane) {
      const double reach_m = radius_m * glm::length(to_local * plane.normal);
      return plane.is_beyond(center - reach_m * plane.normal);
    });
  }

 private:
  Vec3d placed(const Vec3d& place) const { return Vec3d(instance_.to_world * Vec4d(place, 1.0)); }

  bool may_reach_behind(const Mesh& mesh, const std::vector<HullPlane>& planes, const Box3d& box,
                        std::size_t& left) {
    if (mesh.triangles.size() > left) return true;
    left -= mesh.triangles.size();
    if (positions_.empty()) {
      for (const Vec3f& position : mesh.positions) positions_.push_back(placed(Vec3d(position)));
    }
    if (are_beyond_one(planes, positions_)) return false;
    return std::any_of(mesh.triangles.begin(), mesh.triangles.end(), [&](const auto& triangle) {
      const std::array<Vec3d, 3> corners{positions_[triangle[0]], positions_[triangle[1]],
                                         positions_[triangle[2]]};
      Box3d own;
      for (const Vec3d& corner : corners) own.extend({corner, corner});
      return !are_apart(own, box) && !are_beyond_one(planes, corners);
    });
  }

  const Scene& scene_;
  const Instance& instance_;
  const Box3d box_;
  std::vector<Vec3d> positions_;  ///< Of its mesh, once they are wanted.
};

}  // namespace

void find_inclusions(const Scene& scene, std::vector<BodyFacets>& bodies) {
  std::vector<Surroundings> all;
  all.reserve(scene.instances.size());
  for (const Instance& instance : scene.instances) all.emplace_back(scene, instance);
  std::vector<bool> is_lit(scene.instances.size(), true);
  for (const BodyFacets& body : bodies) is_lit[body.body.instance] = false;
  std::size_t left = kMostTriangles;
  for (BodyFacets& candidate : bodies) {
    FlatBody& body = candidate.body;
    if (body.is_mirror) continue;
    const Box3d& own = all[body.instance].box();
    const std::vector<HullPlane> planes = hull_planes_of(candidate.facets);
    for (std::size_t i = 0; i < all.size(); ++i) {
      if (i == body.instance || (body.has_inclusions && !is_lit[i])) continue;
      if (are_apart(all[i].box(), own) || !all[i].may_reach_behind(planes, own, left)) continue;
      body.has_inclusions = true;
      body.has_lit_inclusions |= is_lit[i];
      if (body.has_lit_inclusions) break;
    }
  }
}

}  // namespace abbe
