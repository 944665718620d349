#include "abbe/accel/kd/build/primitives.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace abbe {
namespace {

float round_down(double x) {
  const auto f = static_cast<float>(x);
  return static_cast<double>(f) <= x ? f : std::nextafter(f, -kInfinity);
}

float round_up(double x) {
  const auto f = static_cast<float>(x);
  return static_cast<double>(f) >= x ? f : std::nextafter(f, kInfinity);
}

// A triangle cut by six planes has at most nine corners.
struct Polygon {
  double corner[10][3];
  int count = 0;
};

// Keeps the part on one side of the plane x[axis] = bound; corners on the plane stay.
void clip_polygon(Polygon& polygon, int axis, double bound, double side) {
  Polygon result;
  for (int i = 0; i < polygon.count; ++i) {
    const double* const a = polygon.corner[i];
    const double* const b = polygon.corner[i + 1 == polygon.count ? 0 : i + 1];
    const double distance_a = side * (a[axis] - bound);
    const double distance_b = side * (b[axis] - bound);
    if (distance_a >= 0.0) std::copy_n(a, 3, result.corner[result.count++]);
    if ((distance_a > 0.0 && distance_b < 0.0) || (distance_a < 0.0 && distance_b > 0.0)) {
      const double s = distance_a / (distance_a - distance_b);
      double* const cut = result.corner[result.count++];
      for (int k = 0; k < 3; ++k) cut[k] = a[k] + s * (b[k] - a[k]);
      cut[axis] = bound;
    }
  }
  polygon = result;
}

}  // namespace

BuildPrimitive make_build_primitive(const ShapeSpans& shapes, std::uint32_t primitive) {
  Box3f box;
  std::size_t i = primitive;
  if (i < shapes.triangles.size()) {
    for (const std::uint32_t corner : shapes.triangles[i]) box.extend(shapes.positions[corner]);
  } else if ((i -= shapes.triangles.size()) < shapes.ellipsoids.size()) {
    box = shapes.ellipsoids[i].bounds;
  } else {
    box = shapes.polyhedra[i - shapes.ellipsoids.size()].bounds;
  }
  return {{box.low.x, box.low.y, box.low.z}, {box.high.x, box.high.y, box.high.z}, primitive};
}

bool clip_to_cell(const ShapeSpans& shapes, const Box3f& cell, BuildPrimitive& part) {
  if (part.primitive < shapes.triangles.size()) {
    const Triangle& triangle = shapes.triangles[part.primitive];
    Polygon polygon;
    polygon.count = 3;
    for (int c = 0; c < 3; ++c) {
      const Vec3f& position = shapes.positions[triangle[static_cast<std::size_t>(c)]];
      for (int k = 0; k < 3; ++k) polygon.corner[c][k] = static_cast<double>(position[k]);
    }
    // The part's box remembers the sides of the cells further up.
    for (int k = 0; k < 3; ++k) {
      clip_polygon(polygon, k, static_cast<double>(std::max(part.low[k], cell.low[k])), 1.0);
      clip_polygon(polygon, k, static_cast<double>(std::min(part.high[k], cell.high[k])), -1.0);
    }
    if (polygon.count == 0) return false;
    for (int k = 0; k < 3; ++k) {
      double low = polygon.corner[0][k];
      double high = low;
      for (int c = 1; c < polygon.count; ++c) {
        low = std::min(low, polygon.corner[c][k]);
        high = std::max(high, polygon.corner[c][k]);
      }
      part.low[k] = std::max(part.low[k], round_down(low));
      part.high[k] = std::min(part.high[k], round_up(high));
    }
  }
  for (int k = 0; k < 3; ++k) {
    part.low[k] = std::max(part.low[k], cell.low[k]);
    part.high[k] = std::min(part.high[k], cell.high[k]);
    if (part.low[k] > part.high[k]) return false;
  }
  return true;
}

}  // namespace abbe
