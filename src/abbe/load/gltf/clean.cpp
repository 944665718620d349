#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "abbe/load/gltf/meshes.h"

namespace abbe::gltf {
namespace {

// Squares of squared lengths stay within single precision.
constexpr float kLargestCoordinate_m = 1e9f;
// From here on single-precision texture coordinates have no fraction left.
constexpr float kLargestUv = 8388608.0f;
// Squared edges below this underflow in single precision.
constexpr double kShortestEdge_m = 1e-18;

bool is_usable(const Vec3f& p) {
  // The comparison is false for NaN.
  return std::abs(p.x) <= kLargestCoordinate_m && std::abs(p.y) <= kLargestCoordinate_m &&
         std::abs(p.z) <= kLargestCoordinate_m;
}

bool is_degenerate(const Vec3f& a, const Vec3f& b, const Vec3f& c) {
  const Vec3d e1 = Vec3d(b) - Vec3d(a);
  const Vec3d e2 = Vec3d(c) - Vec3d(a);
  const Vec3d normal = glm::cross(e1, e2);
  if (normal == Vec3d(0.0)) return true;
  const double longest = std::sqrt(std::max(glm::dot(e1, e1), glm::dot(e2, e2)));
  return longest < kShortestEdge_m;
}

template <typename T>
void keep_vertices(std::vector<T>& values, const std::vector<std::uint32_t>& kept) {
  if (values.empty()) return;
  std::vector<T> result;
  result.reserve(kept.size());
  for (const std::uint32_t vertex : kept) result.push_back(values[vertex]);
  values = std::move(result);
}

// Vertices that no triangle uses would widen bounds and cost memory.
void drop_unused_vertices(Mesh& mesh) {
  constexpr std::uint32_t kUnused = std::numeric_limits<std::uint32_t>::max();
  std::vector<std::uint32_t> renumbered(mesh.positions.size(), kUnused);
  for (const auto& triangle : mesh.triangles) {
    for (const std::uint32_t vertex : triangle) renumbered[vertex] = 0;
  }
  if (std::find(renumbered.begin(), renumbered.end(), kUnused) == renumbered.end()) return;
  std::vector<std::uint32_t> kept;
  for (std::size_t i = 0; i < renumbered.size(); ++i) {
    if (renumbered[i] == kUnused) continue;
    renumbered[i] = static_cast<std::uint32_t>(kept.size());
    kept.push_back(static_cast<std::uint32_t>(i));
  }
  for (auto& triangle : mesh.triangles) {
    for (std::uint32_t& vertex : triangle) vertex = renumbered[vertex];
  }
  keep_vertices(mesh.positions, kept);
  keep_vertices(mesh.normals, kept);
  keep_vertices(mesh.tangents, kept);
  keep_vertices(mesh.uv[0], kept);
  keep_vertices(mesh.uv[1], kept);
  keep_vertices(mesh.colors_rec709, kept);
}

void clean_triangles(Mesh& mesh, const std::string& where, Notes& notes) {
  std::size_t unusable = 0;
  std::size_t degenerate = 0;
  const auto is_bad = [&](const std::array<std::uint32_t, 3>& triangle) {
    const Vec3f& a = mesh.positions[triangle[0]];
    const Vec3f& b = mesh.positions[triangle[1]];
    const Vec3f& c = mesh.positions[triangle[2]];
    if (!is_usable(a) || !is_usable(b) || !is_usable(c)) return ++unusable, true;
    if (is_degenerate(a, b, c)) return ++degenerate, true;
    return false;
  };
  mesh.triangles.erase(std::remove_if(mesh.triangles.begin(), mesh.triangles.end(), is_bad),
                       mesh.triangles.end());
  if (unusable > 0) {
    notes.warn(where, fmt::format("{} triangles with a corner that is not finite or beyond {:g} m "
                                  "are dropped",
                                  unusable, kLargestCoordinate_m));
  }
  if (degenerate > 0) {
    notes.warn(where, fmt::format("{} degenerate triangles are dropped", degenerate));
  }
}

// The normals of the triangles around each vertex, weighted by area.
std::vector<Vec3d> geometric_normals(const Mesh& mesh) {
  std::vector<Vec3d> sums(mesh.positions.size(), Vec3d(0.0));
  for (const auto& triangle : mesh.triangles) {
    const Vec3d a(mesh.positions[triangle[0]]);
    const Vec3d normal =
        glm::cross(Vec3d(mesh.positions[triangle[1]]) - a, Vec3d(mesh.positions[triangle[2]]) - a);
    for (const std::uint32_t vertex : triangle) sums[vertex] += normal;
  }
  return sums;
}

void clean_normals(Mesh& mesh, const std::string& where, Notes& notes) {
  std::vector<std::size_t> bad;
  for (std::size_t i = 0; i < mesh.normals.size(); ++i) {
    Vec3d normal(mesh.normals[i]);
    const double length = glm::length(normal);
    if (length > 1e-20 && std::isfinite(length)) {
      mesh.normals[i] = Vec3f(normal / length);
    } else {
      bad.push_back(i);
    }
  }
  if (bad.empty()) return;
  notes.warn(where, fmt::format("{} normals are zero or not finite; replaced by those of the "
                                "triangles around",
                                bad.size()));
  if (bad.size() == mesh.normals.size()) {
    mesh.normals.clear();
    return;
  }
  const std::vector<Vec3d> sums = geometric_normals(mesh);
  for (const std::size_t i : bad) {
    const double length = glm::length(sums[i]);
    mesh.normals[i] = length > 0.0 ? Vec3f(sums[i] / length) : Vec3f(0.0f, 1.0f, 0.0f);
  }
}

void clean_tangents(Mesh& mesh, const std::string& where, Notes& notes) {
  std::size_t bad = 0;
  for (Vec4f& tangent : mesh.tangents) {
    const double length = glm::length(Vec3d(tangent));
    if (!(length > 1e-20) || !std::isfinite(length) || !std::isfinite(tangent.w)) {
      ++bad;
      continue;
    }
    tangent = Vec4f(Vec3f(Vec3d(tangent) / length), tangent.w < 0.0f ? -1.0f : 1.0f);
  }
  if (bad == 0) return;
  // A part of them would leave seams: the renderer derives all from the texture coordinates.
  notes.warn(where, fmt::format("{} tangents are zero or not finite; all are ignored", bad));
  mesh.tangents.clear();
}

void clean_uv(std::vector<Vec2f>& uv, int set, const std::string& where, Notes& notes) {
  std::size_t bad = 0;
  for (Vec2f& coordinate : uv) {
    if (std::abs(coordinate.x) <= kLargestUv && std::abs(coordinate.y) <= kLargestUv) continue;
    coordinate = Vec2f(0.0f);
    ++bad;
  }
  if (bad > 0) {
    notes.warn(where,
               fmt::format("{} of TEXCOORD_{} are not finite or too large; set to 0", bad, set));
  }
}

void clean_colors(Mesh& mesh, const std::string& where, Notes& notes) {
  std::size_t bad = 0;
  for (Vec4f& color : mesh.colors_rec709) {
    bool changed = false;
    for (int c = 0; c < 4; ++c) {
      if (color[c] >= 0.0f && color[c] <= 1.0f) continue;
      color[c] = color[c] > 1.0f ? 1.0f : 0.0f;
      changed = true;
    }
    bad += changed ? 1 : 0;
  }
  if (bad > 0) notes.warn(where, fmt::format("{} of COLOR_0 are limited to 0 to 1", bad));
}

}  // namespace

void clean(Mesh& mesh, const std::string& where, Notes& notes) {
  clean_triangles(mesh, where, notes);
  if (mesh.triangles.empty()) return;
  drop_unused_vertices(mesh);
  clean_normals(mesh, where, notes);
  clean_tangents(mesh, where, notes);
  clean_uv(mesh.uv[0], 0, where, notes);
  clean_uv(mesh.uv[1], 1, where, notes);
  clean_colors(mesh, where, notes);
}

}  // namespace abbe::gltf
