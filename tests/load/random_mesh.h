// A mesh of chance for tests of compressed ones.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <random>
#include <vector>

#include "abbe/math/vec.h"
#include "abbe/scene/scene.h"

namespace abbe {

/// A bent grid with holes, whose vertices are all used.
struct RandomMesh {
  explicit RandomMesh(std::uint32_t seed, std::uint32_t side = 24) {
    std::mt19937 chance(seed);
    std::uniform_real_distribution<float> real(-1.0f, 1.0f);
    for (std::uint32_t y = 0; y <= side; ++y) {
      for (std::uint32_t x = 0; x <= side; ++x) {
        positions.emplace_back(static_cast<float>(x) + 0.3f * real(chance),
                               static_cast<float>(y) + 0.3f * real(chance), 2.0f * real(chance));
        normals.push_back(glm::normalize(Vec3f(real(chance), real(chance), 1.5f + real(chance))));
        uv.emplace_back(0.5f * real(chance) + 0.5f, 0.5f * real(chance) + 0.5f);
      }
    }
    for (std::uint32_t y = 0; y < side; ++y) {
      for (std::uint32_t x = 0; x < side; ++x) {
        const std::uint32_t a = y * (side + 1) + x, b = a + 1, c = a + side + 1, d = c + 1;
        indices.insert(indices.end(), {a, b, d});
        // Holes that touch nowhere: no vertex joins two fans of triangles.
        const bool may_lack = x % 3 == 1 && y % 3 == 1;
        if (!may_lack || chance() % 2 == 0) indices.insert(indices.end(), {a, d, c});
      }
    }
  }

  std::vector<Vec3f> positions, normals;
  std::vector<Vec2f> uv;
  std::vector<std::uint32_t> indices;
};

/// The values of vectors one after another.
template <int N>
std::vector<float> flat(const std::vector<glm::vec<N, float>>& vectors) {
  std::vector<float> values;
  for (const auto& v : vectors) {
    for (int c = 0; c < N; ++c) values.push_back(v[c]);
  }
  return values;
}

/// Triangles by the numbers of their corners' positions, normals and texture coordinates, each
/// turned to begin with the least, in order: what is equal shows the same.
inline std::vector<std::array<float, 24>> shown(const Mesh& mesh) {
  std::vector<std::array<float, 24>> all;
  for (const auto& triangle : mesh.triangles) {
    std::array<std::array<float, 8>, 3> corners;
    for (std::size_t c = 0; c < 3; ++c) {
      const std::uint32_t v = triangle[c];
      const Vec3f p = mesh.positions[v];
      const Vec3f n = mesh.normals.empty() ? Vec3f(0.0f) : mesh.normals[v];
      const Vec2f t = mesh.uv[0].empty() ? Vec2f(0.0f) : mesh.uv[0][v];
      corners[c] = {p.x, p.y, p.z, n.x, n.y, n.z, t.x, t.y};
    }
    std::rotate(corners.begin(), std::min_element(corners.begin(), corners.end()), corners.end());
    std::array<float, 24> row;
    for (std::size_t i = 0; i < 24; ++i) row[i] = corners[i / 8][i % 8];
    all.push_back(row);
  }
  std::sort(all.begin(), all.end());
  return all;
}

}  // namespace abbe
