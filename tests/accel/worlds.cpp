#include "accel/worlds.h"

#include <array>
#include <map>
#include <utility>

namespace abbe::test {

float Random::uniform(float low, float high) {
  return std::uniform_real_distribution<float>(low, high)(engine_);
}

std::size_t Random::below(std::size_t count) {
  return std::uniform_int_distribution<std::size_t>(0, count - 1)(engine_);
}

Vec3f Random::in_cube(float half) {
  const float x = uniform(-half, half), y = uniform(-half, half), z = uniform(-half, half);
  return {x, y, z};
}

Vec3f Random::direction() {
  while (true) {
    const Vec3f v = in_cube(1.0f);
    const float length = glm::length(v);
    if (length > 0.05f && length < 1.0f) return v / length;
  }
}

World random_triangles(Random& random, int count, float size) {
  World world;
  for (int i = 0; i < count; ++i) {
    const Vec3f center = random.in_cube(1.0f);
    const Vec3f a = center + random.in_cube(size);
    const Vec3f b = center + random.in_cube(size);
    world.add_triangle(a, b, center + random.in_cube(size));
  }
  return world;
}

World closed_sphere(int levels, const Vec3f& center, float radius, float roughness) {
  const double g = 0.5 + 0.5 * std::sqrt(5.0);
  std::vector<Vec3d> corners = {{-1, g, 0}, {1, g, 0}, {-1, -g, 0}, {1, -g, 0},
                                {0, -1, g}, {0, 1, g}, {0, -1, -g}, {0, 1, -g},
                                {g, 0, -1}, {g, 0, 1}, {-g, 0, -1}, {-g, 0, 1}};
  std::vector<Triangle> triangles = {{0, 11, 5}, {0, 5, 1},  {0, 1, 7},   {0, 7, 10}, {0, 10, 11},
                                     {1, 5, 9},  {5, 11, 4}, {11, 10, 2}, {10, 7, 6}, {7, 1, 8},
                                     {3, 9, 4},  {3, 4, 2},  {3, 2, 6},   {3, 6, 8},  {3, 8, 9},
                                     {4, 9, 5},  {2, 4, 11}, {6, 2, 10},  {8, 6, 7},  {9, 8, 1}};
  for (Vec3d& corner : corners) corner = glm::normalize(corner);
  for (int level = 0; level < levels; ++level) {
    std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> middles;
    const auto middle = [&](std::uint32_t a, std::uint32_t b) {
      const auto [place, is_new] =
          middles.try_emplace(std::minmax(a, b), static_cast<std::uint32_t>(corners.size()));
      if (is_new) corners.push_back(glm::normalize(corners[a] + corners[b]));
      return place->second;
    };
    std::vector<Triangle> finer;
    for (const auto& [a, b, c] : triangles) {
      const std::uint32_t ab = middle(a, b), bc = middle(b, c), ca = middle(c, a);
      finer.insert(finer.end(), {{a, ab, ca}, {ab, b, bc}, {ca, bc, c}, {ab, bc, ca}});
    }
    triangles = std::move(finer);
  }
  Random random(3);
  World world;
  world.triangles = std::move(triangles);
  for (const Vec3d& corner : corners) {
    const double r = static_cast<double>(radius * (1.0f + random.uniform(-roughness, roughness)));
    world.positions.emplace_back(Vec3d(center) + r * corner);
  }
  return world;
}

std::vector<Ray> random_rays(Random& random, int count, float half) {
  std::vector<Ray> rays;
  for (int i = 0; i < count; i += 16) {
    const Vec3f origin = random.in_cube(half);
    const Vec3f direction = random.direction();
    const int kind = i / 16 % 4;
    const float t_max = i / 64 % 2 == 0 ? kInfinity : random.uniform(0.1f, 1.5f) * half;
    for (int lane = 0; lane < 16 && i + lane < count; ++lane) {
      Ray ray{origin, t_max, direction};
      if (kind == 0) ray.origin = random.in_cube(half);
      if (kind == 3) ray.origin += random.in_cube(0.01f * half);
      if (kind < 2) ray.direction = random.direction();
      if (kind >= 2) ray.direction = glm::normalize(direction + random.in_cube(0.01f));
      rays.push_back(ray);
    }
  }
  return rays;
}

std::vector<Ray> rays_at_edges(Random& random, const World& world, const Vec3f& origin,
                               float spread, int count) {
  std::vector<Ray> rays;
  Vec3f from = origin;
  for (int i = 0; i < count; ++i) {
    if (i % 16 == 0) from = origin + random.in_cube(spread);
    const Triangle& triangle = world.triangles[random.below(world.triangles.size())];
    const Vec3f a = world.positions[triangle[0]];
    const Vec3f b = world.positions[triangle[1]];
    const float s = i % 2 == 0 ? 0.0f : random.uniform(0.0f, 1.0f);
    rays.push_back({from, kInfinity, (a + s * (b - a)) - from});
  }
  return rays;
}

void make_directions_awkward(Random& random, std::vector<Ray>& rays) {
  constexpr std::array<float, 6> kTiny = {0.0f, -0.0f, 1e-42f, -1e-42f, 1e-30f, -1e-20f};
  for (std::size_t i = 0; i < rays.size(); ++i) {
    Vec3f& d = rays[i].direction;
    const int zeros = 1 + static_cast<int>(random.below(2));
    const int first = static_cast<int>(random.below(3));
    for (int z = 0; z < zeros; ++z) d[(first + z) % 3] = kTiny[random.below(kTiny.size())];
    const int kept = (first + zeros) % 3;
    if (std::abs(d[kept]) < 0.1f) d[kept] = d[kept] < 0.0f ? -1.0f : 1.0f;
    if (i % 5 == 0) d *= random.uniform(0.001f, 1000.0f);
  }
}

}  // namespace abbe::test
