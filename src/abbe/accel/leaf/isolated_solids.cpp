#include "abbe/accel/leaf/isolated_solids.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

namespace abbe {
namespace {

// More pairs than this are not looked at: the search costs less than a hundredth of a build.
constexpr std::size_t kMaxPairs = 20'000'000;

// Closer than this share of its size to a solid is touching it.
constexpr double kClearance = 1e-5;

bool overlap(const Box3f& a, const Box3f& b) {
  return glm::all(glm::lessThanEqual(a.low, b.high)) && glm::all(glm::lessThanEqual(b.low, a.high));
}

Box3f bounds_of(const std::array<Vec3d, 3>& corners) {
  const Vec3d low = glm::min(corners[0], glm::min(corners[1], corners[2]));
  const Vec3d high = glm::max(corners[0], glm::max(corners[1], corners[2]));
  return {Vec3f(low), Vec3f(high)};
}

// Distance from the origin to a triangle.
// Source: Ericson, Real-Time Collision Detection, 2005, 5.1.5.
double distance_to(const std::array<Vec3d, 3>& t) {
  const Vec3d ab = t[1] - t[0], ac = t[2] - t[0];
  const double d1 = -glm::dot(ab, t[0]), d2 = -glm::dot(ac, t[0]);
  if (d1 <= 0.0 && d2 <= 0.0) return glm::length(t[0]);
  const double d3 = -glm::dot(ab, t[1]), d4 = -glm::dot(ac, t[1]);
  if (d3 >= 0.0 && d4 <= d3) return glm::length(t[1]);
  const double vc = d1 * d4 - d3 * d2;
  if (vc <= 0.0 && d1 >= 0.0 && d3 <= 0.0) return glm::length(t[0] + d1 / (d1 - d3) * ab);
  const double d5 = -glm::dot(ab, t[2]), d6 = -glm::dot(ac, t[2]);
  if (d6 >= 0.0 && d5 <= d6) return glm::length(t[2]);
  const double vb = d5 * d2 - d1 * d6;
  if (vb <= 0.0 && d2 >= 0.0 && d6 <= 0.0) return glm::length(t[0] + d2 / (d2 - d6) * ac);
  const double va = d3 * d6 - d5 * d4;
  if (va <= 0.0 && d4 >= d3 && d5 >= d6) {
    return glm::length(t[1] + (d4 - d3) / ((d4 - d3) + (d5 - d6)) * (t[2] - t[1]));
  }
  const double sum = va + vb + vc;
  return glm::length(t[0] + vb / sum * ab + vc / sum * ac);
}

// A convex set of points is outside a polyhedron if it is beyond one of its planes.
template <class Points>
bool is_beyond_a_plane(const ShapeSpans& shapes, const ConvexPolyhedron& body, double clearance_m,
                       const Points& points) {
  const auto planes = shapes.planes.subspan(body.first_plane, body.plane_count);
  return std::any_of(planes.begin(), planes.end(), [&](const Plane& plane) {
    return std::all_of(points.begin(), points.end(), [&](const Vec3d& p) {
      return glm::dot(plane.normal, p) > plane.distance + clearance_m;
    });
  });
}

std::array<Vec3d, 8> corners_of(const Box3f& box) {
  std::array<Vec3d, 8> corners;
  for (std::size_t i = 0; i < 8; ++i) {
    corners[i] = {(i & 1u) != 0 ? box.high.x : box.low.x, (i & 2u) != 0 ? box.high.y : box.low.y,
                  (i & 4u) != 0 ? box.high.z : box.low.z};
  }
  return corners;
}

// A box is outside an ellipsoid if the ball about it is, in the space where that is a unit sphere.
bool is_outside(const Ellipsoid& body, const Box3f& box) {
  const Vec3d center = 0.5 * (Vec3d(box.low) + Vec3d(box.high));
  const Vec3d half = Vec3d(box.high) - center;
  const Vec3d place = body.world_to_unit_linear * center + body.world_to_unit_offset;
  Vec3d reach(0.0);
  for (int axis = 0; axis < 3; ++axis) {
    reach += glm::abs(body.world_to_unit_linear[axis]) * half[axis];
  }
  return glm::length(place) - glm::length(reach) > 1.0 + kClearance;
}

bool is_isolated(const ShapeSpans& shapes, std::size_t solid) {
  const std::size_t ellipsoids = shapes.ellipsoids.size();
  const Ellipsoid* ellipsoid = solid < ellipsoids ? &shapes.ellipsoids[solid] : nullptr;
  const ConvexPolyhedron* polyhedron =
      ellipsoid == nullptr ? &shapes.polyhedra[solid - ellipsoids] : nullptr;
  const Box3f own = ellipsoid != nullptr ? ellipsoid->bounds : polyhedron->bounds;
  const float margin_m = static_cast<float>(kClearance) * glm::length(own.high - own.low);
  const Box3f near{own.low - margin_m, own.high + margin_m};
  const auto is_apart_from_box = [&](const Box3f& box) {
    if (!overlap(near, box)) return true;
    if (ellipsoid != nullptr) return is_outside(*ellipsoid, box);
    return is_beyond_a_plane(shapes, *polyhedron, static_cast<double>(margin_m), corners_of(box));
  };
  for (const Triangle& triangle : shapes.triangles) {
    std::array<Vec3d, 3> corners{Vec3d(shapes.positions[triangle[0]]),
                                 Vec3d(shapes.positions[triangle[1]]),
                                 Vec3d(shapes.positions[triangle[2]])};
    if (!overlap(near, bounds_of(corners))) continue;
    if (polyhedron != nullptr) {
      if (!is_beyond_a_plane(shapes, *polyhedron, static_cast<double>(margin_m), corners)) {
        return false;
      }
      continue;
    }
    for (Vec3d& p : corners)
      p = ellipsoid->world_to_unit_linear * p + ellipsoid->world_to_unit_offset;
    if (!(distance_to(corners) > 1.0 + kClearance)) return false;
  }
  for (std::size_t other = 0; other < ellipsoids + shapes.polyhedra.size(); ++other) {
    if (other == solid) continue;
    const Box3f& box = other < ellipsoids ? shapes.ellipsoids[other].bounds
                                          : shapes.polyhedra[other - ellipsoids].bounds;
    if (!is_apart_from_box(box)) return false;
  }
  return true;
}

}  // namespace

std::vector<std::uint8_t> find_isolated_solids(const ShapeSpans& shapes) {
  const std::size_t solids = shapes.ellipsoids.size() + shapes.polyhedra.size();
  std::vector<std::uint8_t> isolated(solids, 0);
  if (solids * shapes.primitive_count() > kMaxPairs) return isolated;
  for (std::size_t solid = 0; solid < solids; ++solid) {
    isolated[solid] = is_isolated(shapes, solid) ? 1 : 0;
  }
  return isolated;
}

}  // namespace abbe
