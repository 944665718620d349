/// Geometry and rays that break accelerators: the catalogue of known traps.
#include <gtest/gtest.h>

#include "accel/judge.h"
#include "accel/worlds.h"

namespace abbe::test {
namespace {

#ifdef ABBE_SANITIZED
constexpr int kRayScale = 20;  // Sanitized code is about twenty times slower.
#else
constexpr int kRayScale = 1;
#endif

// A room of axis-aligned squares with a grid of them inside: every corner lies in split planes.
World box_room(int cells) {
  World world;
  const auto quad = [&](const Vec3f& corner, const Vec3f& u, const Vec3f& v) {
    world.add_triangle(corner, corner + u, corner + u + v);
    world.add_triangle(corner, corner + u + v, corner + v);
  };
  const float step = 1.0f / static_cast<float>(cells);
  for (int axis = 0; axis < 3; ++axis) {
    Vec3f u(0.0f), v(0.0f), w(0.0f);
    u[(axis + 1) % 3] = step;
    v[(axis + 2) % 3] = step;
    w[axis] = 1.0f;
    for (int i = 0; i < cells; ++i) {
      for (int j = 0; j < cells; ++j) {
        const Vec3f corner = static_cast<float>(i) * u + static_cast<float>(j) * v;
        for (const float height : {0.0f, 0.25f, 1.0f}) quad(corner + height * w, u, v);
      }
    }
  }
  return world;
}

// Whether each ray of a closed mesh, from inside, meets it: alone and in packets.
void expect_no_miss(const World& world, const Accelerator& accelerator, const Vec3f& origin,
                    float spread, int count) {
  Random random(17);
  const std::vector<Ray> rays = rays_at_edges(random, world, origin, spread, count);
  std::vector<Hit> hits(rays.size());
  accelerator.closest_hits(rays, kAllBits, hits);
  std::vector<RayPacket> packets;
  for (std::size_t i = 0; i + 16 <= rays.size(); i += 16) {
    packets.push_back(make_packet(std::span(rays).subspan(i, 16)));
  }
  std::vector<HitPacket> packet_hits(packets.size());
  std::vector<std::uint32_t> occluded(packets.size());
  accelerator.closest_hits(packets, kAllBits, packet_hits);
  accelerator.any_hits(packets, kAllBits, occluded);
  std::size_t misses = 0, packet_misses = 0, any_misses = 0, differences = 0;
  for (std::size_t i = 0; i < packets.size() * 16; ++i) {
    const Hit in_packet = lane_of(packet_hits[i / 16], static_cast<int>(i % 16));
    misses += hits[i].is_hit() ? 0 : 1;
    packet_misses += in_packet.is_hit() ? 0 : 1;
    any_misses += (occluded[i / 16] >> (i % 16) & 1u) != 0 ? 0 : 1;
    differences += is_same(hits[i], in_packet) ? 0 : 1;
  }
  EXPECT_EQ(misses, 0u);
  EXPECT_EQ(packet_misses, 0u);
  EXPECT_EQ(any_misses, 0u);
  EXPECT_EQ(differences, 0u);
}

class Watertight : public EveryAccelerator {};
class Adversarial : public EveryAccelerator {};
ABBE_FOR_EVERY_ACCELERATOR(Watertight);
ABBE_FOR_EVERY_ACCELERATOR(Adversarial);

TEST_P(Watertight, a_million_rays_at_edges_and_corners_meet_a_closed_mesh) {
  const World world = closed_sphere(5, Vec3f(0.1f, -0.2f, 0.3f), 1.0f, 0.05f);
  expect_no_miss(world, *build(world), Vec3f(0.1f, -0.2f, 0.3f), 0.4f, fewer(1000000 / kRayScale));
}

TEST_P(Watertight, a_million_rays_ten_kilometres_from_the_origin_meet_a_closed_mesh) {
  const Vec3f center(10000.0f, -10000.0f, 10000.0f);
  const World world = closed_sphere(4, center, 10.0f, 0.02f);
  expect_no_miss(world, *build(world), center, 3.0f, fewer(1000000 / kRayScale));
}

TEST_P(Watertight, rays_from_far_outside_meet_the_silhouette_side_of_a_closed_mesh) {
  // Corners that face the ray's origin are met, by that triangle or one before it.
  const World world = closed_sphere(4, Vec3f(0.0f), 1.0f, 0.0f);
  const Vec3f origin(3000.0f, 2000.0f, 1000.0f);
  const auto accelerator = build(world);
  std::vector<Ray> rays;
  for (const Vec3f& corner : world.positions) {
    if (glm::dot(corner, glm::normalize(origin)) > 0.3f) {
      rays.push_back({origin, kInfinity, corner - origin});
    }
  }
  std::vector<Hit> hits(rays.size());
  accelerator->closest_hits(rays, kAllBits, hits);
  for (const Hit& hit : hits) EXPECT_TRUE(hit.is_hit());
}

TEST_P(Adversarial, rays_at_edges_and_corners_agree_with_the_judge) {
  const World world = closed_sphere(3, Vec3f(0.0f), 1.0f, 0.1f);
  const auto accelerator = build(world);
  Random random(19);
  expect_right_answers(world, *accelerator, rays_at_edges(random, world, Vec3f(0.0f), 0.3f, 4000));
  expect_right_answers(world, *accelerator,
                       rays_at_edges(random, world, Vec3f(0.0f, 4.0f, 0.0f), 2.0f, 4000));
}

TEST_P(Adversarial, rays_in_and_along_planes_agree_with_the_judge) {
  const World world = box_room(8);
  const auto accelerator = build(world);
  Random random(23);
  std::vector<Ray> rays = random_rays(random, 4000, 1.2f);
  make_directions_awkward(random, rays);
  for (Ray& ray : rays) {
    // Onto the grid, so that rays run inside walls and along edges.
    for (int k = 0; k < 3; ++k) ray.origin[k] = std::round(ray.origin[k] * 16.0f) / 16.0f;
  }
  expect_right_answers(world, *accelerator, rays, kAllBits, 4000);
}

TEST_P(Adversarial, zero_and_denormal_directions_agree_with_the_judge) {
  Random random(29);
  World world = random_triangles(random, 1000, 0.3f);
  for (int i = 0; i < 10; ++i) world.add_ellipsoid(Vec3d(random.in_cube(1.0f)), Vec3d(0.2));
  for (int i = 0; i < 10; ++i) {
    const Vec3d low(random.in_cube(1.0f));
    world.add_box_solid(low, low + Vec3d(0.2));
  }
  std::vector<Ray> rays = random_rays(random, 4000);
  make_directions_awkward(random, rays);
  expect_right_answers(world, *build(world), rays, kAllBits, 1000);
}

TEST_P(Adversarial, huge_and_tiny_worlds_agree_with_the_judge) {
  for (const float scale : {1e-9f, 1e9f}) {
    SCOPED_TRACE(testing::Message() << "scale " << scale);
    Random random(31);
    World world = random_triangles(random, 500, 0.3f);
    for (Vec3f& p : world.positions) p *= scale;
    std::vector<Ray> rays = random_rays(random, 2000);
    for (Ray& ray : rays) {
      ray.origin *= scale;
      ray.t_max *= scale;
    }
    expect_right_answers(world, *build(world), rays);
  }
}

TEST_P(Adversarial, corner_shared_by_a_hundred_triangles_agrees_with_the_judge) {
  World world;
  constexpr int kValence = 100;
  const auto rim = [](int i) {
    const float angle =
        2.0f * static_cast<float>(kPi) * static_cast<float>(i % kValence) / kValence;
    return Vec3f(std::cos(angle), std::sin(angle), 0.3f);
  };
  for (int i = 0; i < kValence; ++i) world.add_triangle(Vec3f(0.0f), rim(i), rim(i + 1));
  const auto accelerator = build(world);
  Random random(37);
  expect_right_answers(world, *accelerator, random_rays(random, 2000), kAllBits, 2000);
  std::vector<Ray> rays;
  for (int i = 0; i < 1000; ++i) {
    const Vec3f origin = random.in_cube(0.5f) + Vec3f(0.0f, 0.0f, 2.0f);
    rays.push_back({origin, kInfinity, -origin});
  }
  std::vector<Hit> hits(rays.size());
  accelerator->closest_hits(rays, kAllBits, hits);
  for (const Hit& hit : hits) EXPECT_TRUE(hit.is_hit());
}

TEST_P(Adversarial, long_needles_agree_with_the_judge) {
  World world;
  Random random(41);
  constexpr int kCount = 20000;
  for (int i = 0; i < kCount; ++i) {
    const Vec3f a = random.in_cube(1.0f), b = random.in_cube(1.0f);
    world.add_triangle(a, b, b + random.in_cube(1e-4f));
  }
  expect_right_answers(world, *build(world), random_rays(random, 1600 / kRayScale), kAllBits, 50);
  // 40 bytes a part, at most a million of them or four a triangle, and half-filled blocks.
  EXPECT_LT(build(world)->bytes(), std::size_t{1 << 20} * 80);
}

TEST_P(Adversarial, identical_triangles_build_in_linear_time_and_the_first_wins) {
  World world;
  for (int i = 0; i < 200000; ++i) {
    world.triangles.push_back({0, 1, 2});
  }
  world.positions = {{0, 0, 0}, {1, 0.1f, 0.2f}, {0.1f, 1, -0.3f}};
  const auto accelerator = build(world);
  EXPECT_LT(accelerator->bytes(), std::size_t{200000} * 60);
  const std::vector<Ray> rays(16, Ray{{0.3f, 0.3f, 5.0f}, kInfinity, {0.0f, 0.0f, -1.0f}});
  std::vector<Hit> hits(16);
  accelerator->closest_hits(rays, kAllBits, hits);
  for (const Hit& hit : hits) EXPECT_EQ(hit.primitive, 0u);
}

TEST_P(Adversarial, coplanar_triangles_build_and_agree_with_the_judge) {
  World world;
  constexpr int kSide = 354;  // 250 632 triangles.
  for (int y = 0; y <= kSide; ++y) {
    for (int x = 0; x <= kSide; ++x) world.positions.emplace_back(x, 0.5f, y);
  }
  for (int y = 0; y < kSide; ++y) {
    for (int x = 0; x < kSide; ++x) {
      const auto corner = static_cast<std::uint32_t>(y * (kSide + 1) + x);
      world.triangles.push_back({corner, corner + 1, corner + kSide + 2});
      world.triangles.push_back({corner, corner + kSide + 2, corner + kSide + 1});
    }
  }
  const auto accelerator = build(world);
  EXPECT_LT(accelerator->bytes(), world.triangles.size() * 100);
  Random random(43);
  std::vector<Ray> rays;
  for (int i = 0; i < 2000; ++i) {
    const Vec3f target(random.uniform(1.0f, kSide - 1.0f), 0.5f,
                       random.uniform(1.0f, kSide - 1.0f));
    const Vec3f origin =
        target + Vec3f(random.uniform(-9.0f, 9.0f), 7.0f, random.uniform(-9.0f, 9.0f));
    rays.push_back({origin, kInfinity, target - origin});
  }
  std::vector<Hit> hits(rays.size());
  accelerator->closest_hits(rays, kAllBits, hits);
  for (const Hit& hit : hits) {
    ASSERT_TRUE(hit.is_hit());
    EXPECT_NEAR(hit.t, 1.0f, 1e-5f);  // The target lies at t = 1, 300 m from the mesh's corner.
  }
  expect_right_answers(world, *accelerator, std::span(rays).first(64), kAllBits, 16);
}

TEST_P(Adversarial, origin_on_a_primitive_agrees_with_the_judge) {
  World world = closed_sphere(2, Vec3f(0.0f), 1.0f, 0.0f);
  world.add_ellipsoid(Vec3d(0.0), Vec3d(0.5));
  world.add_box_solid(Vec3d(-0.25), Vec3d(0.25));
  const auto accelerator = build(world);
  Random random(47);
  std::vector<Ray> rays;
  for (int i = 0; i < 2000; ++i) {
    Ray ray{random.direction(), kInfinity, random.direction()};
    if (i % 3 == 0) ray.origin *= 0.5f;
    if (i % 3 == 1)
      ray.origin = {0.25f, random.uniform(-0.25f, 0.25f), random.uniform(-0.25f, 0.25f)};
    if (i % 3 == 2) ray.origin = world.positions[random.below(world.positions.size())];
    rays.push_back(ray);
  }
  expect_right_answers(world, *accelerator, rays, kAllBits, 2000);
}

}  // namespace
}  // namespace abbe::test
