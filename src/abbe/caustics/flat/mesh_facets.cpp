#include "abbe/caustics/flat/mesh_facets.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>
#include <set>
#include <utility>

#include "abbe/math/polygon.h"
#include "abbe/scene/shells.h"

namespace abbe {
namespace {

// Larger meshes are no flat bodies anyway.
constexpr std::size_t kFewTriangles = std::size_t{1} << 15;
constexpr std::size_t kNone = std::numeric_limits<std::size_t>::max();

// How far rounding may have moved a corner: its coordinates are numbers of single precision, half a
// last digit off, or a few halves where a writer computed them in that; placing is in double.
double rounding_m(const Vec3f& position, const Mat4d& to_world) {
  constexpr double kRoundings = 4.0;
  Vec3d moved_by(0.0);
  for (int c = 0; c < 3; ++c) {
    moved_by += glm::abs(Vec3d(to_world[c])) * std::abs(static_cast<double>(position[c]));
  }
  return kRoundings * (0x1p-24 * glm::length(moved_by) + 0x1p-53 * glm::length(Vec3d(to_world[3])));
}

double length_around(const std::vector<Vec3d>& polygon) {
  double length_m = glm::distance(polygon.back(), polygon.front());
  for (std::size_t i = 1; i < polygon.size(); ++i) {
    length_m += glm::distance(polygon[i - 1], polygon[i]);
  }
  return length_m;
}

// A convex polygon without the corners that rounding alone makes stand out.
std::vector<Vec3d> without_bumps(std::vector<Vec3d> polygon, double rounding_m) {
  for (std::size_t i = 0; i < polygon.size() && polygon.size() > 3;) {
    const Vec3d& before = polygon[(i + polygon.size() - 1) % polygon.size()];
    const Vec3d across = polygon[(i + 1) % polygon.size()] - before;
    const double twice_area = glm::length(glm::cross(across, polygon[i] - before));
    if (twice_area > rounding_m * glm::length(across)) {
      ++i;
    } else {
      polygon.erase(polygon.begin() + static_cast<std::ptrdiff_t>(i));
    }
  }
  return polygon;
}

}  // namespace

MeshFacets::MeshFacets(const Mesh& mesh, const Mat4d& to_world) : mesh_(mesh) {
  WeldedMesh welded = weld(mesh);
  for (const Vec3f& corner : welded.corners) {
    corners_.emplace_back(to_world * Vec4d(Vec3d(corner), 1.0));
    rounding_m_.push_back(rounding_m(corner, to_world));
  }
  triangles_ = std::move(welded.triangles);
  if (triangles_.size() <= kFewTriangles && !is_closed()) {
    join_close_corners();
    drop_doubles();
  }
  if (glm::determinant(Mat3d(to_world)) >= 0.0) return;
  for (auto& t : triangles_) std::swap(t[1], t[2]);
}

// Writers that place each face by itself leave corners that differ by roundings: they are one.
void MeshFacets::join_close_corners() {
  std::vector<std::uint32_t> order(corners_.size());
  std::iota(order.begin(), order.end(), 0u);
  std::sort(order.begin(), order.end(),
            [&](std::uint32_t a, std::uint32_t b) { return corners_[a].x < corners_[b].x; });
  std::vector<std::uint32_t> joined(corners_.size());
  for (std::size_t i = 0; i < order.size(); ++i) {
    const std::uint32_t own = order[i];
    joined[own] = own;
    for (std::size_t j = i; j-- > 0;) {
      const double slack_m = rounding_m_[own] + rounding_m_[order[j]];
      if (corners_[own].x - corners_[order[j]].x > slack_m) break;
      if (glm::distance(corners_[own], corners_[order[j]]) <= slack_m)
        joined[own] = joined[order[j]];
    }
  }
  std::erase_if(triangles_, [&](std::array<std::uint32_t, 3>& t) {
    for (std::uint32_t& corner : t) corner = joined[corner];
    return t[0] == t[1] || t[1] == t[2] || t[2] == t[0];
  });
}

// A triangle that is there twice is there.
void MeshFacets::drop_doubles() {
  std::set<std::array<std::uint32_t, 3>> known;
  std::erase_if(triangles_, [&](std::array<std::uint32_t, 3> t) {
    std::rotate(t.begin(), std::min_element(t.begin(), t.end()), t.end());
    return !known.insert(t).second;
  });
}

bool MeshFacets::is_flat() const {
  if (mesh_.normals.empty()) return true;
  for (const auto& t : mesh_.triangles) {
    const Vec3d a(mesh_.positions[t[0]]);
    const Vec3d normal =
        glm::cross(Vec3d(mesh_.positions[t[1]]) - a, Vec3d(mesh_.positions[t[2]]) - a);
    const double length = glm::length(normal);
    if (!(length > 0.0)) continue;
    for (const std::uint32_t corner : t) {
      const Vec3d shading(mesh_.normals[corner]);
      const double shading_length = glm::length(shading);
      if (!(shading_length > 0.0)) continue;
      // Exporters write normals in single precision or less.
      if (glm::dot(normal, shading) < (1.0 - 1e-4) * length * shading_length) return false;
    }
  }
  return true;
}

bool MeshFacets::is_closed() const {
  std::map<std::pair<std::uint32_t, std::uint32_t>, int> balance;
  for (const auto& t : triangles_) {
    for (std::size_t i = 0; i < 3; ++i) {
      const std::uint32_t a = t[i];
      const std::uint32_t b = t[(i + 1) % 3];
      balance[{std::min(a, b), std::max(a, b)}] += a < b ? 1 : 100000;
    }
  }
  return std::all_of(balance.begin(), balance.end(),
                     [](const auto& edge) { return edge.second == 100001; });
}

std::vector<Facet> MeshFacets::facets() const {
  std::vector<Facet> facets;
  for (const std::vector<std::size_t>& members : groups()) add_group(members, facets);
  return facets;
}

Vec3d MeshFacets::area_of_triangle(std::size_t triangle) const {
  const auto& t = triangles_[triangle];
  return glm::cross(corners_[t[1]] - corners_[t[0]], corners_[t[2]] - corners_[t[0]]);
}

// Across each edge of each triangle; kNone where there is none. Where more than two meet at an
// edge, they are paired as they come.
std::vector<std::array<std::size_t, 3>> MeshFacets::neighbours() const {
  std::vector<std::array<std::size_t, 3>> across(triangles_.size(), {kNone, kNone, kNone});
  std::map<std::pair<std::uint32_t, std::uint32_t>, std::pair<std::size_t, std::size_t>> open;
  for (std::size_t i = 0; i < triangles_.size(); ++i) {
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t a = triangles_[i][k];
      const std::uint32_t b = triangles_[i][(k + 1) % 3];
      const auto [entry, is_new] =
          open.try_emplace({std::min(a, b), std::max(a, b)}, std::pair(i, k));
      if (is_new) continue;
      const auto [other, other_edge] = entry->second;
      across[i][k] = other;
      across[other][other_edge] = i;
      open.erase(entry);
    }
  }
  return across;
}

// Grows each group from its largest triangle, which knows its plane best; groups are in the order
// of their first triangles.
std::vector<std::vector<std::size_t>> MeshFacets::groups() const {
  const std::vector<std::array<std::size_t, 3>> across = neighbours();
  std::vector<double> area(triangles_.size());
  for (std::size_t i = 0; i < area.size(); ++i) area[i] = glm::length(area_of_triangle(i));
  std::vector<std::size_t> seeds(triangles_.size());
  std::iota(seeds.begin(), seeds.end(), std::size_t{0});
  std::stable_sort(seeds.begin(), seeds.end(),
                   [&](std::size_t a, std::size_t b) { return area[a] > area[b]; });
  std::vector<bool> is_taken(triangles_.size(), false);
  std::vector<std::vector<std::size_t>> groups;
  for (const std::size_t seed : seeds) {
    if (is_taken[seed] || !(area[seed] > 0.0)) continue;
    is_taken[seed] = true;
    std::vector<std::size_t> members{seed};
    Layer layer = layer_of(members);
    for (std::size_t next = 0; next < members.size(); ++next) {
      for (const std::size_t other : across[members[next]]) {
        if (other == kNone || is_taken[other]) continue;
        is_taken[other] = take(other, members, layer);
      }
    }
    std::sort(members.begin(), members.end());
    groups.push_back(std::move(members));
  }
  std::sort(groups.begin(), groups.end());
  return groups;
}

// Across the sum of the areas: what rounding does to the corners averages out in it.
MeshFacets::Layer MeshFacets::layer_of(const std::vector<std::size_t>& members) const {
  Vec3d area(0.0);
  for (const std::size_t i : members) area += area_of_triangle(i);
  const double length = glm::length(area);
  Layer layer;
  layer.normal = length > 0.0 ? area / length : Vec3d(0.0);
  layer.low = std::numeric_limits<double>::infinity();
  layer.high = -layer.low;
  for (const std::size_t i : members) extend(layer, i);
  return layer;
}

void MeshFacets::extend(Layer& layer, std::size_t triangle) const {
  for (const std::uint32_t corner : triangles_[triangle]) {
    const double height = glm::dot(layer.normal, corners_[corner] - corners_.front());
    layer.low = std::min(layer.low, height);
    layer.high = std::max(layer.high, height);
    layer.rounding_m = std::max(layer.rounding_m, rounding_m_[corner]);
  }
}

// Adds a triangle to a group if the layer about all of them is thin: as it lies, or as they
// together would have it.
bool MeshFacets::take(std::size_t triangle, std::vector<std::size_t>& members, Layer& layer) const {
  if (glm::dot(area_of_triangle(triangle), layer.normal) < 0.0) return false;
  members.push_back(triangle);
  Layer wider = layer;
  extend(wider, triangle);
  if (!wider.is_thin()) wider = layer_of(members);
  if (!wider.is_thin()) {
    members.pop_back();
    return false;
  }
  layer = wider;
  return true;
}

void MeshFacets::add_group(const std::vector<std::size_t>& members,
                           std::vector<Facet>& facets) const {
  double total_area = 0.0;
  double rounding_m = 0.0;
  Vec3d sum(0.0);
  std::vector<Vec3d> points;
  for (const std::size_t i : members) {
    const Vec3d twice = area_of_triangle(i);
    sum += twice;
    total_area += 0.5 * glm::length(twice);
    for (const std::uint32_t corner : triangles_[i]) {
      points.push_back(corners_[corner]);
      rounding_m = std::max(rounding_m, rounding_m_[corner]);
    }
  }
  if (!(total_area > 0.0)) return;
  const Vec3d normal = glm::normalize(sum);
  std::vector<Vec3d> hull = convex_hull(points, normal);
  double distance = 0.0;
  for (const Vec3d& point : points) distance += glm::dot(normal, point);
  distance /= static_cast<double>(points.size());
  const auto add = [&](std::vector<Vec3d> corners) {
    Facet facet{.normal = normal,
                .distance = distance,
                .corners = std::move(corners),
                .rounding_m = rounding_m};
    facets.push_back(std::move(facet));
  };
  // As large as its hull, but for what rounding does to its edges: the union is convex.
  if (hull.size() >= 3 &&
      area_of(hull) <= total_area * (1.0 + 1e-6) + rounding_m * length_around(hull)) {
    add(without_bumps(std::move(hull), rounding_m));
    return;
  }
  for (const std::size_t i : members) {
    const auto& t = triangles_[i];
    add({corners_[t[0]], corners_[t[1]], corners_[t[2]]});
  }
}

}  // namespace abbe
