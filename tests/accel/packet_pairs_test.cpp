// Packets that follow each other and go nearly the same way are traced two by two: the answers must
// be those of each alone, whichever of them find together.
#include <gtest/gtest.h>

#include <cmath>

#include "accel/judge.h"
#include "accel/worlds.h"

namespace abbe::test {
namespace {

// A camera's rays in tiles of 4 × 4, tile after tile of a row.
std::vector<Ray> view_from(const Vec3f& eye, const Vec3f& target, float half_tangent, int tiles) {
  const Vec3f forward = glm::normalize(target - eye);
  const Vec3f right = glm::normalize(glm::cross(forward, Vec3f(0.1f, 1.0f, 0.2f)));
  const Vec3f up = glm::cross(right, forward);
  const auto at = [&](int tile, int pixel) {
    const float place =
        (static_cast<float>(4 * tile + pixel) + 0.5f) / static_cast<float>(4 * tiles);
    return (2.0f * place - 1.0f) * half_tangent;
  };
  std::vector<Ray> rays;
  for (int tile = 0; tile < tiles * tiles; ++tile) {
    for (int i = 0; i < 16; ++i) {
      const Vec3f direction =
          forward + at(tile % tiles, i % 4) * right + at(tile / tiles, i / 4) * up;
      rays.push_back({eye, kInfinity, glm::normalize(direction)});
    }
  }
  return rays;
}

World mesh_and_solids(int levels) {
  World world = closed_sphere(levels, Vec3f(0.0f), 1.0f, 0.02f);
  world.add_ellipsoid({1.3, 0.2, 0.0}, {0.2, 0.3, 0.2});
  world.add_box_solid({-1.5, -0.4, -0.3}, {-1.1, 0.1, 0.3});
  return world;
}

class PacketPairs : public EveryAccelerator {
 protected:
  // Of the mesh: 81 920 triangles, and 1 280 for brute force.
  static int levels() { return GetParam() == "brute" ? 3 : 6; }
};
ABBE_FOR_EVERY_ACCELERATOR(PacketPairs);

TEST_P(PacketPairs, neighbours_of_a_view_agree_with_the_judge) {
  const World world = mesh_and_solids(levels());
  const auto accelerator = build(world);
  expect_right_answers(world, *accelerator, view_from({0.4f, 0.9f, 3.0f}, Vec3f(0.0f), 0.5f, 17));
  expect_right_answers(world, *accelerator,
                       view_from({0.1f, 0.0f, 0.2f}, {0.0f, 1.0f, 0.3f}, 0.8f, 17));
  std::vector<Ray> ends = view_from({0.4f, 0.9f, 3.0f}, Vec3f(0.0f), 0.05f, 17);
  for (std::size_t i = 0; i < ends.size(); ++i) ends[i].t_max = i % 3 == 0 ? 2.0f : 2.3f;
  expect_right_answers(world, *accelerator, ends);
}

TEST_P(PacketPairs, neighbours_among_few_shapes_agree_with_the_judge) {
  Random random(29);
  World world = random_triangles(random, 40, 0.8f);
  world.add_ellipsoid({0.3, 0.2, 0.0}, {0.4, 0.3, 0.2});
  world.add_box_solid({-0.9, -0.4, -0.3}, {-0.5, 0.1, 0.3});
  const auto accelerator = build(world);
  expect_right_answers(world, *accelerator, view_from({0.0f, 0.1f, 4.0f}, Vec3f(0.0f), 0.4f, 16));
}

TEST_P(PacketPairs, rays_of_different_origins_agree_with_the_judge) {
  const World world = mesh_and_solids(levels());
  const auto accelerator = build(world);
  Random random(31);
  std::vector<Ray> rays = view_from({0.4f, 0.9f, 3.0f}, Vec3f(0.0f), 0.02f, 16);
  for (std::size_t i = 0; i < rays.size(); ++i) {
    // Each packet from a point of its own, then each ray.
    if (i < rays.size() / 2) {
      rays[i].origin.x += 0.002f * static_cast<float>(i / 16 % 16);
    } else {
      rays[i].origin += random.in_cube(0.01f);
    }
  }
  expect_right_answers(world, *accelerator, rays);
}

// More packets than may wait for those that pair.
TEST_P(PacketPairs, many_packets_without_a_pair_agree_with_the_judge) {
  Random random(43);
  const World world = random_triangles(random, 2000, 0.2f);
  const auto accelerator = build(world);
  std::vector<Ray> rays = view_from({0.0f, 0.1f, 4.0f}, Vec3f(0.0f), 0.1f, 16);
  const std::vector<Ray> unrelated = random_rays(random, 16 * 1500);
  rays.insert(rays.begin() + 16 * 100, unrelated.begin(), unrelated.end());
  expect_right_answers(world, *accelerator, rays);
}

// Rays in the gaps between needles that run along with them cost more than any packet may.
TEST_P(PacketPairs, packets_that_run_out_of_their_budget_agree_with_the_judge) {
  Random random(37);
  World world;
  for (int i = 0; i < 20000; ++i) {
    const Vec3f start(random.uniform(-0.2f, 0.2f), random.uniform(-0.2f, 0.2f),
                      random.uniform(-2, -1));
    const Vec3f end =
        start + Vec3f(random.uniform(-0.01f, 0.01f), random.uniform(-0.01f, 0.01f), 3.0f);
    world.add_triangle(start, end, end + Vec3f(1e-4f, 0.0f, 0.0f));
  }
  const auto accelerator = build(world);
  std::vector<Ray> rays = view_from({0.0f, 0.0f, 30.0f}, Vec3f(0.0f), 0.006f, 4);
  expect_right_answers(world, *accelerator, rays, kAllBits, 100);
}

TEST_P(PacketPairs, inactive_lanes_and_packets_change_nothing) {
  const World world = mesh_and_solids(levels());
  const auto accelerator = build(world);
  const std::vector<Ray> rays = view_from({0.4f, 0.9f, 3.0f}, Vec3f(0.0f), 0.3f, 17);
  std::vector<Hit> alone(rays.size());
  accelerator->closest_hits(rays, kAllBits, alone);
  Random random(41);
  std::vector<RayPacket> packets;
  for (std::size_t i = 0; i < rays.size(); i += 16) {
    RayPacket packet = make_packet(std::span(rays).subspan(i, 16));
    if (random.below(3) != 0) packet.active = static_cast<std::uint32_t>(random.below(65536));
    if (random.below(8) == 0) packet.active = 0;
    for (int lane = 0; lane < kPacketLanes; ++lane) {
      if ((packet.active >> lane & 1u) == 0) packet.direction_x[lane] = std::nanf("");
    }
    packets.push_back(packet);
  }
  std::vector<HitPacket> hits(packets.size());
  std::vector<std::uint32_t> occluded(packets.size());
  accelerator->closest_hits(packets, kAllBits, hits);
  accelerator->any_hits(packets, kAllBits, occluded);
  for (std::size_t i = 0; i < rays.size(); ++i) {
    const std::size_t p = i / 16;
    const int lane = static_cast<int>(i % 16);
    const bool is_active = (packets[p].active >> lane & 1u) != 0;
    EXPECT_TRUE(is_same(lane_of(hits[p], lane), is_active ? alone[i] : Hit{}));
    EXPECT_EQ((occluded[p] >> lane & 1u) != 0, is_active && alone[i].is_hit());
  }
}

}  // namespace
}  // namespace abbe::test
