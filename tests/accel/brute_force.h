/// The judge of the accelerator: every primitive against every ray in double precision.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "abbe/accel/kd/tree.h"

namespace abbe::test {

/// A small world that owns what ShapeSpans looks at.
struct World {
  std::vector<Vec3f> positions;
  std::vector<Triangle> triangles;
  std::vector<Ellipsoid> ellipsoids;
  std::vector<ConvexPolyhedron> polyhedra;
  std::vector<Plane> planes;
  std::vector<VisibilityMask> masks;

  ShapeSpans spans() const { return {positions, triangles, ellipsoids, polyhedra, planes, masks}; }
  void add_triangle(const Vec3f& a, const Vec3f& b, const Vec3f& c);
  /// A sphere of the given radii along x, y, z.
  void add_ellipsoid(const Vec3d& center, const Vec3d& radii);
  /// An axis-aligned box made of half-spaces.
  void add_box_solid(const Vec3d& low, const Vec3d& high);
};

/// Empty if `hit` is a right answer for the ray, else what is wrong with it. A triangle whose edge
/// passes the ray within the rounding error of the float test may be hit or missed.
std::string check_closest(const World& world, const Ray& ray, VisibilityMask mask, const Hit& hit);

/// The same for an answer of any_hits.
std::string check_any(const World& world, const Ray& ray, VisibilityMask mask, bool is_occluded);

/// A packet of up to 16 rays; the remaining lanes are inactive.
RayPacket make_packet(std::span<const Ray> rays);
Hit lane_of(const HitPacket& hits, int lane);

/// Same primitive, distance and position, bit by bit.
bool is_same(const Hit& a, const Hit& b);
std::string text_of(const Ray& ray);
std::string text_of(const Hit& hit);

/// Puts the rays through every form of query, compares the forms with each other and the answers
/// with brute force (of at most `judged` rays), and reports the first few differences as failures.
void expect_right_answers(const World& world, const KdTree& tree, std::span<const Ray> rays,
                          VisibilityMask mask = kAllBits, std::size_t judged = 400);

}  // namespace abbe::test
