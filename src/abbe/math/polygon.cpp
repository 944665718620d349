#include "abbe/math/polygon.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>

#include "abbe/base/constants.h"

namespace abbe {
namespace {

struct Axes {
  Vec3d u, v;
};

Axes axes_of(const Vec3d& normal) {
  const Vec3d helper = std::abs(normal.x) < 0.6 ? Vec3d(1, 0, 0) : Vec3d(0, 1, 0);
  const Vec3d u = glm::normalize(glm::cross(helper, normal));
  return {u, glm::cross(normal, u)};
}

Vec3d centroid(const std::vector<Vec3d>& polygon) {
  Vec3d sum(0.0);
  for (const Vec3d& corner : polygon) sum += corner;
  return sum / static_cast<double>(polygon.size());
}

}  // namespace

std::vector<Vec3d> large_square(const Vec3d& normal, double distance, double half_m) {
  const auto [u, v] = axes_of(normal);
  const Vec3d c = distance * normal;
  return {c - half_m * u - half_m * v, c + half_m * u - half_m * v, c + half_m * u + half_m * v,
          c - half_m * u + half_m * v};
}

std::vector<Vec3d> clipped(const std::vector<Vec3d>& polygon, const Vec3d& normal,
                           double distance) {
  std::vector<Vec3d> kept;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Vec3d& a = polygon[i];
    const Vec3d& b = polygon[(i + 1) % polygon.size()];
    const double da = glm::dot(normal, a) - distance;
    const double db = glm::dot(normal, b) - distance;
    if (da <= 0.0) kept.push_back(a);
    if ((da < 0.0 && db > 0.0) || (da > 0.0 && db < 0.0)) {
      kept.push_back(a + (da / (da - db)) * (b - a));
    }
  }
  if (kept.size() < 3) kept.clear();
  return kept;
}

std::vector<Vec3d> without_short_edges(const std::vector<Vec3d>& polygon, double shortest_m) {
  std::vector<Vec3d> kept;
  for (const Vec3d& corner : polygon) {
    if (kept.empty() || glm::distance(corner, kept.back()) > shortest_m) kept.push_back(corner);
  }
  while (kept.size() > 1 && !(glm::distance(kept.front(), kept.back()) > shortest_m)) {
    kept.pop_back();
  }
  if (kept.size() < 3) kept.clear();
  return kept;
}

std::vector<Vec3d> clipped_by_shadow(std::vector<Vec3d> polygon, const std::vector<Vec3d>& window,
                                     const Vec3d& direction) {
  const Vec3d middle = centroid(window);
  for (std::size_t i = 0; i < window.size() && !polygon.empty(); ++i) {
    const Vec3d& a = window[i];
    const Vec3d& b = window[(i + 1) % window.size()];
    Vec3d side = glm::cross(b - a, direction);
    const double length = glm::length(side);
    if (!(length > 0.0)) continue;
    side /= length;
    // Outwards, whichever way the window is seen.
    if (glm::dot(side, middle - a) > 0.0) side = -side;
    polygon = clipped(polygon, side, glm::dot(side, a));
  }
  return polygon;
}

Ball ball_about(const std::vector<Vec3d>& points) {
  if (points.empty()) return {};
  Vec3d low = points.front();
  Vec3d high = low;
  for (const Vec3d& point : points) {
    low = glm::min(low, point);
    high = glm::max(high, point);
  }
  Ball ball{0.5 * (low + high), 0.0};
  for (const Vec3d& point : points) {
    ball.radius_m = std::max(ball.radius_m, glm::distance(point, ball.center));
  }
  return ball;
}

double area_of(const std::vector<Vec3d>& polygon) {
  Vec3d sum(0.0);
  for (std::size_t i = 2; i < polygon.size(); ++i) {
    sum += glm::cross(polygon[i - 1] - polygon[0], polygon[i] - polygon[0]);
  }
  return 0.5 * glm::length(sum);
}

double turns_about_origin(const Vec3d& a, const Vec3d& b, const Vec3d& c) {
  const double la = glm::length(a);
  const double lb = glm::length(b);
  const double lc = glm::length(c);
  const double rest =
      la * lb * lc + glm::dot(a, b) * lc + glm::dot(b, c) * la + glm::dot(c, a) * lb;
  return std::atan2(glm::dot(a, glm::cross(b, c)), rest) / (2.0 * kPi);
}

std::vector<Vec3d> convex_hull(const std::vector<Vec3d>& points, const Vec3d& normal) {
  const auto [u, v] = axes_of(normal);
  struct Flat {
    double x, y;
    std::size_t index;
  };
  std::vector<Flat> flat;
  double extent = 0.0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Vec3d from_first = points[i] - points[0];
    flat.push_back({glm::dot(from_first, u), glm::dot(from_first, v), i});
    extent = std::max({extent, std::abs(flat.back().x), std::abs(flat.back().y)});
  }
  std::sort(flat.begin(), flat.end(),
            [](const Flat& a, const Flat& b) { return a.x != b.x ? a.x < b.x : a.y < b.y; });
  // Andrew's monotone chain; a corner has to stand out by more than rounding.
  const double least_turn = 1e-9 * extent * extent;
  const auto turn = [](const Flat& o, const Flat& a, const Flat& b) {
    return (a.x - o.x) * (b.y - o.y) - (a.y - o.y) * (b.x - o.x);
  };
  std::vector<Flat> hull;
  for (int pass = 0; pass < 2; ++pass) {
    const std::size_t start = hull.size();
    for (const Flat& p : flat) {
      while (hull.size() >= start + 2 &&
             turn(hull[hull.size() - 2], hull.back(), p) <= least_turn) {
        hull.pop_back();
      }
      hull.push_back(p);
    }
    hull.pop_back();
    std::reverse(flat.begin(), flat.end());
  }
  std::vector<Vec3d> result;
  result.reserve(hull.size());
  for (const Flat& p : hull) result.push_back(points[p.index]);
  return result;
}

double distance_inside(const std::vector<Vec3d>& polygon, const Vec3d& normal, const Vec3d& point) {
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Vec3d& a = polygon[i];
    const Vec3d edge = polygon[(i + 1) % polygon.size()] - a;
    const double length = glm::length(edge);
    if (!(length > 0.0)) continue;
    least = std::min(least, glm::dot(glm::cross(normal, edge), point - a) / length);
  }
  return least;
}

}  // namespace abbe
