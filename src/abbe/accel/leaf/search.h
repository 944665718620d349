/// What a ray looks for, and one ray against the triangles of a block or a solid in plain C++: the
/// operations of the kernels in the same order, so that the answers are the same to the bit.
#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

#include "abbe/accel/leaf/block.h"
#include "abbe/accel/leaf/shear.h"
#include "abbe/accel/leaf/solids.h"
#include "abbe/accel/leaf/ties.h"
#include "abbe/accel/leaf/visibility.h"
#include "abbe/accel/query.h"

namespace abbe {

/// The nearest primitive, or, with `is_any`, one that is met at all.
/// Searches are shown every hit with found(): t, the primitive, u, v, and for a solid whether it is
/// the first or the second that the ray's line has with it. Nothing beyond end() is of interest.
struct NearestSearch {
  const Visibility& visibility;
  QueryMask mask;
  bool is_any;
  Hit hit;  ///< hit.t is the end of the open segment until something is met.

  NearestSearch(const Visibility& of, QueryMask bits, const Ray& ray, bool any)
      : visibility(of), mask(bits), is_any(any) {
    hit.t = ray.t_max;
  }

  void found(float t, std::uint32_t primitive, float u, float v, int) {
    if (t > 0.0f && is_nearer(t, primitive, hit) && (visibility.of(primitive) & mask) != 0) {
      hit = {t, primitive, u, v};
    }
  }
  QueryMask query() const { return mask; }
  float end() const { return hit.t; }
  bool is_done() const { return is_any && hit.is_hit(); }
  Hit answer() const { return hit.is_hit() ? hit : Hit{}; }
};

/// All primitives up to the first that stops the ray. Its memory is used for one ray after another.
class AllSearch {
 public:
  AllSearch(const Visibility& visibility, QueryMask mask, VisibilityMask stops)
      : visibility_(visibility), mask_(mask), stops_(stops) {}

  void start(const Ray& ray) {
    t_max_ = end_ = ray.t_max;
    found_.clear();
  }
  void found(float t, std::uint32_t primitive, float u, float v, int crossing);
  QueryMask query() const { return mask_; }
  float end() const { return end_; }
  bool is_done() const { return false; }
  /// Appends what was found as the next list.
  void finish(HitLists& lists);

 private:
  // A primitive may be shown more than once: the same crossing is the same hit.
  struct Found {
    Hit hit;
    int crossing;
  };

  const Visibility& visibility_;
  QueryMask mask_;
  VisibilityMask stops_;
  float t_max_ = 0.0f;
  float end_ = 0.0f;  // t_max, or the distance of a hit that stops the ray.
  std::vector<Found> found_;
};

/// Shows a search where a ray's line meets the triangles of a block.
template <class Search>
void test_block(const TriangleBlock& block, const ShearedRay& ray, QueryMask mask, Search& search) {
  const float* const row_x = block.row(ray.axes.x);
  const float* const row_y = block.row(ray.axes.y);
  const float* const row_z = block.row(ray.axes.z);
  for (int i = 0; i < block.triangle_count; ++i) {
    const std::size_t a = block.corners[0][i], b = block.corners[1][i], c = block.corners[2][i];
    const float az = row_z[a] - ray.origin_z, bz = row_z[b] - ray.origin_z,
                cz = row_z[c] - ray.origin_z;
    const float ax = (row_x[a] - ray.origin_x) - ray.shear_x * az;
    const float ay = (row_y[a] - ray.origin_y) - ray.shear_y * az;
    const float bx = (row_x[b] - ray.origin_x) - ray.shear_x * bz;
    const float by = (row_y[b] - ray.origin_y) - ray.shear_y * bz;
    const float cx = (row_x[c] - ray.origin_x) - ray.shear_x * cz;
    const float cy = (row_y[c] - ray.origin_y) - ray.shear_y * cz;
    const float u = cx * by - cy * bx;
    const float v = ax * cy - ay * cx;
    const float w = bx * ay - by * ax;
    const bool is_inside =
        (u >= 0.0f && v >= 0.0f && w >= 0.0f) || (u <= 0.0f && v <= 0.0f && w <= 0.0f);
    const float determinant = (u + v) + w;
    if (!is_inside || determinant == 0.0f) continue;
    if ((block.front_only >> i & 1) != 0 && is_culled(mask, determinant, ray.shear_z)) continue;
    const float inverse = 1.0f / determinant;
    const float t = (((u * az + v * bz) + w * cz) * ray.shear_z) * inverse;
    search.found(t, block.id[i], v * inverse, w * inverse, 0);
  }
}

/// Shows a search where a ray's line meets a solid.
template <class Search>
void test_solid(const SolidView& solids, std::uint32_t primitive, const Ray& ray, Search& search) {
  const auto crossings = solids.is_ellipsoid(primitive)
                             ? intersect_ellipsoid(ray, solids.ellipsoid(primitive))
                             : intersect_polyhedron(ray, solids.planes_of(primitive));
  if (!crossings) return;
  // The answer is a float: what rounds to 0 or to t_max is outside the open segment.
  search.found(static_cast<float>(crossings->enter), primitive,
               static_cast<float>(crossings->enter_face), 0.0f, 0);
  search.found(static_cast<float>(crossings->leave), primitive,
               static_cast<float>(crossings->leave_face), 0.0f, 1);
}

}  // namespace abbe
