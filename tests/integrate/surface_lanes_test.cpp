// The vector code of integrate/surface_lanes-inl.h on every instruction set of this machine: each
// lane gets the bits that surface_point() gives a ray alone.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <span>
#include <vector>

#include "abbe/integrate/surface/point.h"
#include "abbe/math/random.h"
#include "support/scene_builder.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "integrate/surface_lanes_test.cpp"
#include <hwy/foreach_target.h>
// After foreach_target.h, as Highway asks.
#include <hwy/highway.h>

#include "abbe/integrate/surface/point_lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace abbe {
namespace HWY_NAMESPACE {
namespace {

// Geometry of all hits, sixteen rays at a time.
void Fill(const World& world, const std::vector<Ray>& rays, const std::vector<Hit>& hits,
          std::vector<SurfacePoint>& results) {
  const hn::CappedTag<float, 16> d;
  for (std::size_t begin = 0; begin < rays.size(); begin += 16) {
    HitLanes lanes;
    LaneMask left;
    for (int lane = 0; lane < 16; ++lane) {
      const Ray& ray = rays[begin + static_cast<std::size_t>(lane)];
      const Hit& hit = hits[begin + static_cast<std::size_t>(lane)];
      lanes.origin.set(lane, ray.origin);
      lanes.direction.set(lane, ray.direction);
      lanes.t[lane] = hit.t;
      lanes.u[lane] = hit.u;
      lanes.v[lane] = hit.v;
      lanes.primitive[lane] = hit.primitive;
      if (hit.is_hit()) left.set(lane);
    }
    SurfaceLanes out;
    while (left.any()) {
      left = left - FillSurfaceLanes(d, 16, world, lanes, left, left.front(), out);
    }
    for (int lane = 0; lane < 16; ++lane) {
      SurfacePoint& point = results.emplace_back();
      point.position = out.position.get(lane);
      point.normal = out.outward.get(lane);
      point.shading_normal = out.shading_normal.get(lane);
      point.offset_m = out.offset_m[lane];
    }
  }
}

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace abbe
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace abbe {
namespace {

HWY_EXPORT(Fill);

// Rays from one point into all directions, and what they meet.
struct Shot {
  explicit Shot(const Scene& scene) : world(test::make_world(scene, test::small_settings())) {
    for (std::uint32_t i = 0; i < 4096; ++i) {
      const Vec2f u = random_2d({7, i}, kCameraPath, Purpose::Lens);
      const float z = 1.0f - 2.0f * u.x;
      const float r = std::sqrt(std::max(1.0f - z * z, 0.0f));
      const float phi = 6.2831853f * u.y;
      rays.push_back(
          {Vec3f(0.1f, 0.2f, 0.3f), kInfinity, Vec3f(r * std::cos(phi), r * std::sin(phi), z)});
    }
    hits.resize(rays.size());
    world.accelerator->closest_hits(std::span<const Ray>(rays), kAllBits, std::span<Hit>(hits));
  }
  World world;
  std::vector<Ray> rays;
  std::vector<Hit> hits;
};

void expect_same_bits(const Shot& shot) {
  std::vector<SurfacePoint> results;
  HWY_DYNAMIC_DISPATCH(Fill)(shot.world, shot.rays, shot.hits, results);
  std::size_t compared = 0;
  for (std::size_t i = 0; i < shot.rays.size(); ++i) {
    if (!shot.hits[i].is_hit()) continue;
    const SurfacePoint alone =
        surface_point(shot.world, shot.rays[i].origin, shot.rays[i].direction, shot.hits[i]);
    ++compared;
    EXPECT_EQ(results[i].position, alone.position) << i;
    EXPECT_EQ(results[i].normal, alone.normal) << i;
    EXPECT_EQ(results[i].shading_normal, alone.shading_normal) << i;
    EXPECT_EQ(results[i].offset_m, alone.offset_m) << i;
  }
  EXPECT_GT(compared, 1000u);
}

TEST(SurfaceLanesTest, lanes_on_ellipsoids_and_polyhedra_get_the_bits_of_a_ray_alone) {
  Scene scene;
  const std::uint32_t glass = test::add(scene, test::glass("glass/schott/SF10"));
  test::add_sphere(scene, glass, {3, 0, 0}, 2.0);
  test::add_sphere(scene, glass, {-3, 1, 0}, 1.5);
  test::add_box(scene, glass, {1, 1, 1}, test::translation({0, 4, 0}));
  test::add_prism(scene, glass, 60.0, 2.0, test::translation({0, -3, 1}));
  expect_same_bits(Shot(scene));
}

TEST(SurfaceLanesTest, lanes_on_triangles_with_smooth_normals_get_the_bits_of_a_ray_alone) {
  Scene scene;
  const std::uint32_t glass = test::add(scene, test::glass("glass/schott/SF10"));
  test::add_box_mesh(scene, glass, {4, 3, 5}, test::rotation({1, 2, 3}, 33.0));
  for (Mesh& mesh : scene.meshes) {
    if (mesh.positions.empty()) continue;
    mesh.normals.clear();
    for (const Vec3f& p : mesh.positions) mesh.normals.push_back(glm::normalize(p));
  }
  expect_same_bits(Shot(scene));
}

}  // namespace
}  // namespace abbe
#endif  // HWY_ONCE
