/// The judge of the accelerator: every primitive against every ray in double precision.
#pragma once

#include <gtest/gtest.h>

#include <memory>
#include <span>
#include <string>
#include <vector>

#include "abbe/accel/accelerator.h"

namespace abbe::test {

/// A small world that owns what ShapeSpans looks at.
struct World {
  std::vector<Vec3f> positions;
  std::vector<Triangle> triangles;
  std::vector<Ellipsoid> ellipsoids;
  std::vector<ConvexPolyhedron> polyhedra;
  std::vector<Plane> planes;
  std::vector<VisibilityMask> masks;
  std::vector<std::uint8_t> front_only;

  ShapeSpans spans() const {
    return {positions, triangles, ellipsoids, polyhedra, planes, masks, front_only};
  }
  void add_triangle(const Vec3f& a, const Vec3f& b, const Vec3f& c);
  /// A sphere of the given radii along x, y, z.
  void add_ellipsoid(const Vec3d& center, const Vec3d& radii);
  /// An axis-aligned box made of half-spaces.
  void add_box_solid(const Vec3d& low, const Vec3d& high);
};

/// Empty if `hit` is a right answer for the ray, else what is wrong with it. A triangle whose edge
/// passes the ray within the rounding error of the float test may be hit or missed.
std::string check_closest(const World& world, const Ray& ray, QueryMask mask, const Hit& hit);

/// The same for an answer of any_hits.
std::string check_any(const World& world, const Ray& ray, QueryMask mask, bool is_occluded);

/// The same for a list of all_hits.
std::string check_all(const World& world, const Ray& ray, QueryMask mask, VisibilityMask stops,
                      std::span<const Hit> hits);

/// A packet of up to 16 rays; the remaining lanes are inactive.
RayPacket make_packet(std::span<const Ray> rays);
Hit lane_of(const HitPacket& hits, int lane);

/// Same primitive, distance and position, bit by bit.
bool is_same(const Hit& a, const Hit& b);
std::string text_of(const Ray& ray);
std::string text_of(const Hit& hit);

/// Puts the rays through every form of query, compares the forms with each other and the answers
/// with the judge's (of at most `judged` rays), and reports the first few differences as failures.
void expect_right_answers(const World& world, const Accelerator& accelerator,
                          std::span<const Ray> rays, QueryMask mask = kAllBits,
                          std::size_t judged = 400);

/// The same for lists of all hits that end where a primitive shares a bit with `stops`.
void expect_right_lists(const World& world, const Accelerator& accelerator,
                        std::span<const Ray> rays, QueryMask mask, VisibilityMask stops,
                        std::size_t judged = 400);

/// Tests that every accelerator has to pass; the parameter is its name.
class EveryAccelerator : public testing::TestWithParam<std::string> {
 protected:
  static std::unique_ptr<const Accelerator> build(const World& world) {
    return build_accelerator(GetParam(), world.spans());
  }
  /// What takes a search a moment would take brute force minutes: some of so many are enough there.
  static int fewer(int count) { return GetParam() == "brute" ? count / 500 : count; }
};

/// Runs the cases of a fixture that is an EveryAccelerator for each.
#define ABBE_FOR_EVERY_ACCELERATOR(Fixture)                                       \
  INSTANTIATE_TEST_SUITE_P(Each, Fixture, testing::ValuesIn(accelerator_names()), \
                           [](const auto& name) { return name.param; })

}  // namespace abbe::test
