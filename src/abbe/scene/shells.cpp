#include "abbe/scene/shells.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <tuple>

#include "abbe/math/polygon.h"
#include "abbe/math/ray.h"

namespace abbe {
namespace {

/// An edge of a triangle; `forward` where it runs from the lower corner to the higher.
struct Edge {
  std::uint32_t low, high, triangle;
  bool forward;
};

struct Shell {
  std::vector<std::uint32_t> triangles;  ///< Of the welded mesh.
  bool is_closed = true;
  double volume_m3 = 0.0;  ///< Negative where it faces inwards; 0 where rounding hides it.
  Box3f bounds;
};

class Shells {
 public:
  explicit Shells(const Mesh& mesh) : welded_(weld(mesh)) {
    find();
    for (Shell& shell : all_) measure(shell);
  }

  const WeldedMesh& welded() const { return welded_; }
  const std::vector<Shell>& all() const { return all_; }

  bool is_cavity(const Shell& shell) const {
    std::size_t around = 0;
    for (const Shell& other : all_) {
      if (&other != &shell && other.is_closed && holds(other, shell)) ++around;
    }
    return around % 2 == 1;
  }

 private:
  Vec3d corner(std::uint32_t triangle, std::size_t k) const {
    return Vec3d(welded_.corners[welded_.triangles[triangle][k]]);
  }

  void find() {
    std::vector<Edge> edges;
    for (std::uint32_t i = 0; i < welded_.triangles.size(); ++i) {
      for (std::size_t k = 0; k < 3; ++k) {
        const std::uint32_t a = welded_.triangles[i][k];
        const std::uint32_t b = welded_.triangles[i][(k + 1) % 3];
        edges.push_back({std::min(a, b), std::max(a, b), i, a < b});
      }
    }
    std::sort(edges.begin(), edges.end(), [](const Edge& a, const Edge& b) {
      return std::tie(a.low, a.high, a.triangle) < std::tie(b.low, b.high, b.triangle);
    });
    std::vector<std::uint32_t> parent(welded_.triangles.size());
    std::iota(parent.begin(), parent.end(), 0u);
    const auto root = [&](std::uint32_t i) {
      while (parent[i] != i) i = parent[i] = parent[parent[i]];
      return i;
    };
    std::vector<std::uint32_t> at_open_edges;
    for (std::size_t first = 0; first < edges.size();) {
      int balance = 0;
      std::size_t i = first;
      for (; i < edges.size() && edges[i].low == edges[first].low &&
             edges[i].high == edges[first].high;
           ++i) {
        balance += edges[i].forward ? 1 : -1;
        const std::uint32_t a = root(edges[first].triangle);
        const std::uint32_t b = root(edges[i].triangle);
        parent[std::max(a, b)] = std::min(a, b);
      }
      if (balance != 0) at_open_edges.push_back(edges[first].triangle);
      first = i;
    }
    std::map<std::uint32_t, std::size_t> number;
    for (std::uint32_t i = 0; i < parent.size(); ++i) {
      const auto [entry, is_new] = number.try_emplace(root(i), all_.size());
      if (is_new) all_.emplace_back();
      all_[entry->second].triangles.push_back(i);
    }
    for (const std::uint32_t triangle : at_open_edges) {
      all_[number[root(triangle)]].is_closed = false;
    }
  }

  void measure(Shell& shell) const {
    const Vec3d origin = corner(shell.triangles.front(), 0);
    double sum = 0.0, of_sizes = 0.0;
    for (const std::uint32_t t : shell.triangles) {
      const Vec3d a = corner(t, 0) - origin;
      const double six_volumes =
          glm::dot(a, glm::cross(corner(t, 1) - origin, corner(t, 2) - origin));
      sum += six_volumes;
      of_sizes += std::abs(six_volumes);
      for (std::size_t k = 0; k < 3; ++k) {
        shell.bounds.extend(welded_.corners[welded_.triangles[t][k]]);
      }
    }
    // A sheet with two sides holds what rounding of its corners makes of nothing.
    if (std::abs(sum) > 1e-5 * of_sizes) shell.volume_m3 = sum / 6.0;
  }

  // How often a shell goes round a place: ±1 inside, 0 outside, halves on a face.
  double turns_about(const Shell& shell, const Vec3d& place) const {
    double turns = 0.0;
    for (const std::uint32_t t : shell.triangles) {
      turns += turns_about_origin(corner(t, 0) - place, corner(t, 1) - place, corner(t, 2) - place);
    }
    return turns;
  }

  // By a few places of the inner one: all of them inside, or on faces that both have.
  bool holds(const Shell& outer, const Shell& inner) const {
    constexpr std::size_t kPlaces = 16;
    if (glm::any(glm::lessThan(inner.bounds.low, outer.bounds.low)) ||
        glm::any(glm::greaterThan(inner.bounds.high, outer.bounds.high))) {
      return false;
    }
    bool is_any_inside = false;
    const std::size_t count = std::min(kPlaces, inner.triangles.size());
    for (std::size_t i = 0; i < count; ++i) {
      const std::uint32_t t = inner.triangles[i * inner.triangles.size() / count];
      const double turns =
          std::abs(turns_about(outer, (corner(t, 0) + corner(t, 1) + corner(t, 2)) / 3.0));
      if (turns < 0.25) return false;
      is_any_inside |= turns > 0.75;
    }
    return is_any_inside;
  }

  WeldedMesh welded_;
  std::vector<Shell> all_;
};

// Turns normals that are on the inner side of a triangle which was turned, and with each its
// tangent, whose bitangent stays.
void turn_normals(Mesh& mesh, std::uint32_t triangle, std::vector<bool>& is_done) {
  const auto& t = mesh.triangles[triangle];
  const Vec3d a(mesh.positions[t[0]]);
  const Vec3d outward =
      glm::cross(Vec3d(mesh.positions[t[1]]) - a, Vec3d(mesh.positions[t[2]]) - a);
  for (const std::uint32_t vertex : t) {
    if (is_done[vertex]) continue;
    is_done[vertex] = true;
    if (glm::dot(outward, Vec3d(mesh.normals[vertex])) >= 0.0) continue;
    mesh.normals[vertex] = -mesh.normals[vertex];
    if (!mesh.tangents.empty()) mesh.tangents[vertex].w = -mesh.tangents[vertex].w;
  }
}

}  // namespace

WeldedMesh weld(const Mesh& mesh) {
  WeldedMesh welded;
  std::map<std::tuple<float, float, float>, std::uint32_t> known;
  std::vector<std::uint32_t> number;
  number.reserve(mesh.positions.size());
  for (const Vec3f& position : mesh.positions) {
    // Adding 0 makes −0 and 0 the same place.
    const auto [entry, is_new] =
        known.try_emplace({position.x + 0.0f, position.y + 0.0f, position.z + 0.0f},
                          static_cast<std::uint32_t>(welded.corners.size()));
    if (is_new) welded.corners.push_back(position);
    number.push_back(entry->second);
  }
  for (std::uint32_t i = 0; i < mesh.triangles.size(); ++i) {
    const auto& t = mesh.triangles[i];
    const std::array<std::uint32_t, 3> corners{number[t[0]], number[t[1]], number[t[2]]};
    if (corners[0] == corners[1] || corners[1] == corners[2] || corners[2] == corners[0]) continue;
    welded.triangles.push_back(corners);
    welded.sources.push_back(i);
  }
  return welded;
}

ShellCount turn_shells_outward(Mesh& mesh) {
  const Shells shells(mesh);
  ShellCount count;
  std::vector<bool> has_normal_turned(mesh.normals.size(), false);
  for (const Shell& shell : shells.all()) {
    if (!shell.is_closed) continue;
    ++count.closed;
    if (shell.volume_m3 == 0.0 || (shell.volume_m3 < 0.0) == shells.is_cavity(shell)) continue;
    ++count.turned;
    for (const std::uint32_t t : shell.triangles) {
      const std::uint32_t source = shells.welded().sources[t];
      std::swap(mesh.triangles[source][1], mesh.triangles[source][2]);
      if (!mesh.normals.empty()) turn_normals(mesh, source, has_normal_turned);
    }
  }
  return count;
}

}  // namespace abbe
