/// Convex polygons in space: the cross sections of bundles of rays that pass flat facets.
#pragma once

#include <vector>

#include "abbe/math/vec.h"

namespace abbe {

/// A square of half width `half_m` about the foot of the origin in the plane n·x = distance,
/// counter-clockwise seen from where n points.
std::vector<Vec3d> large_square(const Vec3d& normal, double distance, double half_m);

/// The part of a polygon where normal·x ≤ distance; empty if there is none. Domain: convex.
std::vector<Vec3d> clipped(const std::vector<Vec3d>& polygon, const Vec3d& normal, double distance);

/// A polygon without corners that are closer than this to the one before: where planes meet in a
/// corner, clipping leaves two, and the edge between them has the direction of rounding errors.
/// Empty if fewer than three are left.
std::vector<Vec3d> without_short_edges(const std::vector<Vec3d>& polygon, double shortest_m);

/// The common part of a polygon and an infinite convex prism: the shadow that `window` casts along
/// `direction`. Domain: both convex, the window without short edges; the result lies in the plane
/// of `polygon`.
std::vector<Vec3d> clipped_by_shadow(std::vector<Vec3d> polygon, const std::vector<Vec3d>& window,
                                     const Vec3d& direction);

/// A ball that holds points.
struct Ball {
  Vec3d center{0.0};
  double radius_m = 0.0;
};
/// About the middle of their box; of none, nothing about the origin.
Ball ball_about(const std::vector<Vec3d>& points);

/// Area of a flat polygon, m².
double area_of(const std::vector<Vec3d>& polygon);

/// The share of all directions in which the origin sees a triangle, positive where its corners go
/// round clockwise seen from there: over a closed surface the sum is how often it goes round.
/// Source: Van Oosterom and Strackee, The solid angle of a plane triangle, 1983.
double turns_about_origin(const Vec3d& a, const Vec3d& b, const Vec3d& c);

/// The convex hull of points in one plane, counter-clockwise about the normal; points on its edges
/// are left out.
std::vector<Vec3d> convex_hull(const std::vector<Vec3d>& points, const Vec3d& normal);

/// How far inside the edges of a convex polygon a point of its plane lies; negative outside.
double distance_inside(const std::vector<Vec3d>& polygon, const Vec3d& normal, const Vec3d& point);

}  // namespace abbe
