#include "abbe/accel/touching.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <numeric>
#include <tuple>
#include <utility>

#include "abbe/accel/box_tree.h"

namespace abbe {
namespace {

float largest(const Box3f& box) {
  const Vec3f v = glm::max(glm::abs(box.low), glm::abs(box.high));
  return std::max({v.x, v.y, v.z});
}

// Half of what a box is wide along a direction.
double half_along(const Box3f& box, const Vec3d& direction) {
  return glm::dot(0.5 * Vec3d(box.size()), glm::abs(direction));
}

// Whether the surface of a primitive may meet a box: those that wrap around it, or lie aslant
// beside it, do not.
bool may_meet(const Ellipsoid& ellipsoid, const Box3f& box) {
  const Mat3d& to_unit = ellipsoid.world_to_unit_linear;
  const Vec3d half = 0.5 * Vec3d(box.size());
  const Vec3d center = to_unit * Vec3d(box.center()) + ellipsoid.world_to_unit_offset;
  double farthest = 0.0;
  for (int corner = 0; corner < 8; ++corner) {
    const Vec3d side((corner & 1) != 0 ? 1.0 : -1.0, (corner & 2) != 0 ? 1.0 : -1.0,
                     (corner & 4) != 0 ? 1.0 : -1.0);
    farthest = std::max(farthest, glm::length(center + to_unit * (side * half)));
  }
  if (farthest < 1.0) return false;
  const double distance = glm::length(center);
  return !(distance > 0.0) ||
         distance - half_along(box, glm::transpose(to_unit) * (center / distance)) <= 1.0;
}

bool may_meet(std::span<const Plane> planes, const Box3f& box) {
  bool is_inside = true;
  for (const Plane& plane : planes) {
    const double height = glm::dot(plane.normal, Vec3d(box.center())) - plane.distance;
    const double half = half_along(box, plane.normal);
    if (height > half) return false;
    is_inside &= height < -half;
  }
  return !is_inside;
}

bool may_meet(const std::array<Vec3d, 3>& corners, const Box3f& box) {
  const Vec3d normal = glm::cross(corners[1] - corners[0], corners[2] - corners[0]);
  const double height = glm::dot(normal, Vec3d(box.center()) - corners[0]);
  return std::abs(height) <= half_along(box, normal);
}

/// Primitives by the bodies that they are part of.
class Bodies {
 public:
  Bodies(const ShapeSpans& shapes, std::span<const std::uint32_t> surface_of,
         std::span<const std::uint8_t> matters)
      : shapes_(shapes),
        body_of_(surface_of.begin(), surface_of.end()),
        first_that_matters_(static_cast<std::uint32_t>(matters.size())) {
    join_vertices(surface_of, matters);
    // Bodies are numbered behind surfaces, which stand for themselves where they do not matter.
    std::vector<std::uint32_t> number_of(parent_.size(), 0);
    for (std::size_t i = 0; i < body_of_.size(); ++i) {
      if (matters[surface_of[i]] == 0) continue;
      std::uint32_t number = 0;
      std::uint32_t& of_piece =
          i < shapes.triangles.size() ? number_of[root_of(shapes.triangles[i][0])] : number;
      if (of_piece == 0) {
        of_piece = first_that_matters_ + static_cast<std::uint32_t>(bounds_.size());
        bounds_.emplace_back();
      }
      body_of_[i] = of_piece;
      bounds_[of_piece - first_that_matters_].extend(bounds_of(i));
    }
  }

  Box3f bounds_of(std::size_t primitive) const {
    Box3f box;
    if (primitive < shapes_.triangles.size()) {
      for (const std::uint32_t corner : shapes_.triangles[primitive]) {
        box.extend(shapes_.positions[corner]);
      }
      return box;
    }
    primitive -= shapes_.triangles.size();
    return primitive < shapes_.ellipsoids.size()
               ? shapes_.ellipsoids[primitive].bounds
               : shapes_.polyhedra[primitive - shapes_.ellipsoids.size()].bounds;
  }
  /// Whether the surface of a primitive may come into a box.
  bool may_come_into(std::size_t primitive, const Box3f& box) const {
    if (primitive < shapes_.triangles.size()) {
      const Triangle& triangle = shapes_.triangles[primitive];
      const auto corner = [&](std::size_t i) { return Vec3d(shapes_.positions[triangle[i]]); };
      return may_meet({corner(0), corner(1), corner(2)}, box);
    }
    primitive -= shapes_.triangles.size();
    if (primitive < shapes_.ellipsoids.size()) return may_meet(shapes_.ellipsoids[primitive], box);
    const ConvexPolyhedron& solid = shapes_.polyhedra[primitive - shapes_.ellipsoids.size()];
    return may_meet(shapes_.planes.subspan(solid.first_plane, solid.plane_count), box);
  }
  /// Of the bodies that matter.
  const std::vector<Box3f>& bounds() const { return bounds_; }
  bool is_of(std::size_t primitive, std::uint32_t body) const {
    return body_of_[primitive] == first_that_matters_ + body;
  }
  /// The primitives of each body that matters.
  std::vector<std::vector<std::uint32_t>> primitives() const {
    std::vector<std::vector<std::uint32_t>> lists(bounds_.size());
    for (std::size_t i = 0; i < body_of_.size(); ++i) {
      if (body_of_[i] < first_that_matters_) continue;
      lists[body_of_[i] - first_that_matters_].push_back(static_cast<std::uint32_t>(i));
    }
    return lists;
  }

 private:
  std::uint32_t root_of(std::uint32_t i) {
    while (parent_[i] != i) i = parent_[i] = parent_[parent_[i]];
    return i;
  }

  // Joins the vertices of triangles, and those of a surface that have the same position.
  void join_vertices(std::span<const std::uint32_t> surface_of,
                     std::span<const std::uint8_t> matters) {
    parent_.resize(shapes_.positions.size());
    std::iota(parent_.begin(), parent_.end(), 0u);
    const std::size_t count = shapes_.triangles.size();
    std::vector<std::uint32_t> corners;
    for (std::size_t begin = 0, end = 0; begin < count; begin = end) {
      for (end = begin; end < count && surface_of[end] == surface_of[begin];) ++end;
      if (matters[surface_of[begin]] == 0) continue;
      corners.clear();
      for (const Triangle& triangle : shapes_.triangles.subspan(begin, end - begin)) {
        for (const std::uint32_t corner : triangle) {
          parent_[root_of(corner)] = root_of(triangle[0]);
        }
      }
      for (const Triangle& triangle : shapes_.triangles.subspan(begin, end - begin)) {
        corners.insert(corners.end(), triangle.begin(), triangle.end());
      }
      const auto is_joined = [&](std::uint32_t c) { return root_of(c) == root_of(corners[0]); };
      if (std::all_of(corners.begin(), corners.end(), is_joined)) continue;
      const auto place = [&](std::uint32_t corner) {
        const Vec3f& p = shapes_.positions[corner];
        return std::tuple(p.x, p.y, p.z);
      };
      std::sort(corners.begin(), corners.end(),
                [&](std::uint32_t a, std::uint32_t b) { return place(a) < place(b); });
      for (std::size_t i = 1; i < corners.size(); ++i) {
        if (place(corners[i - 1]) != place(corners[i])) continue;
        parent_[root_of(corners[i])] = root_of(corners[i - 1]);
      }
    }
  }

  const ShapeSpans& shapes_;
  std::vector<std::uint32_t> body_of_;  ///< Per primitive.
  std::uint32_t first_that_matters_;
  std::vector<std::uint32_t> parent_;  ///< Per vertex, of the same piece.
  std::vector<Box3f> bounds_;
};

}  // namespace

std::vector<Touching> find_touching(const ShapeSpans& shapes,
                                    std::span<const std::uint32_t> primitive_surface,
                                    std::span<const std::uint8_t> matters, float margin_m) {
  if (std::none_of(matters.begin(), matters.end(), [](std::uint8_t m) { return m != 0; })) {
    return {};
  }
  const Bodies bodies(shapes, primitive_surface, matters);
  // Primitives that come near a body that is not theirs, by bodies.
  std::vector<std::vector<std::uint32_t>> near(bodies.bounds().size());
  const auto grown = [&](const Box3f& box) {
    return Box3f{box.low - margin_m, box.high + margin_m};
  };
  BoxTree of_bodies;
  of_bodies.build(bodies.bounds());
  const std::size_t count = shapes.primitive_count();
  for (std::size_t i = 0; i < count; ++i) {
    of_bodies.for_each_overlapping(grown(bodies.bounds_of(i)), [&](std::uint32_t body) {
      if (!bodies.is_of(i, body)) near[body].push_back(static_cast<std::uint32_t>(i));
    });
  }
  // Of those, the ones that come near a primitive of that body.
  std::vector<Touching> touching(count);
  bool is_any = false;
  std::vector<Box3f> boxes;
  BoxTree others;
  const std::vector<std::vector<std::uint32_t>> own = bodies.primitives();
  for (std::size_t body = 0; body < near.size(); ++body) {
    if (near[body].empty()) continue;
    boxes.clear();
    for (const std::uint32_t primitive : near[body]) boxes.push_back(bodies.bounds_of(primitive));
    others.build(boxes);
    for (const std::uint32_t primitive : own[body]) {
      others.for_each_overlapping(grown(bodies.bounds_of(primitive)), [&](std::uint32_t number) {
        const std::uint32_t other = near[body][number];
        const Box3f here = grown(bodies.bounds_of(primitive));
        const Box3f there = grown(boxes[number]);
        if (!bodies.may_come_into(other, here) || !bodies.may_come_into(primitive, there)) return;
        const float size_m = std::max(largest(bodies.bounds_of(primitive)), largest(boxes[number]));
        for (const std::uint32_t one : {primitive, other}) {
          Touching& found = touching[one];
          found.size_m = std::max(found.size_m, size_m);
          found.zone.extend({glm::max(here.low, there.low), glm::min(here.high, there.high)});
        }
        is_any = true;
      });
    }
  }
  if (!is_any) touching.clear();
  return touching;
}

}  // namespace abbe
