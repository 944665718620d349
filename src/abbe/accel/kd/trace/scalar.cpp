#include "abbe/accel/kd/trace/scalar.h"

#include <cmath>
#include <utility>

#include "abbe/accel/leaf/solids.h"

namespace abbe {
namespace {

struct StackEntry {
  KdChild child;
  float t_near, t_far;
};

// What the triangle test needs of a ray.
// Source: Woop, Benthin & Wald, Watertight Ray/Triangle Intersection, JCGT 2(1), 2013.
struct ShearedRay {
  int kx, ky, kz;
  float shear_x, shear_y, shear_z;

  explicit ShearedRay(const Vec3f& direction) {
    const float x = std::abs(direction.x), y = std::abs(direction.y), z = std::abs(direction.z);
    kz = x > y ? (x > z ? 0 : 2) : (y > z ? 1 : 2);
    kx = kz == 2 ? 0 : kz + 1;
    ky = kx == 2 ? 0 : kx + 1;
    shear_z = 1.0f / direction[kz];
    shear_x = direction[kx] * shear_z;
    shear_y = direction[ky] * shear_z;
  }
};

class Query {
 public:
  Query(const KdView& view, const Ray& ray, VisibilityMask mask, QueryCost& cost)
      : view_(view), ray_(ray), mask_(mask), cost_(cost), sheared_(ray.direction) {
    hit_.t = ray.t_max;
  }

  bool any() {
    stops_at_first_ = true;
    traverse();
    return hit_.is_hit();
  }

  Hit closest() {
    traverse();
    return hit_.is_hit() ? hit_ : Hit{};
  }

 private:
  void traverse() {
    const Beam beam = make_beam(ray_, view_.bounds);
    if ((view_.any_mask & mask_) == 0 || view_.root == kEmptyChild) return;
    if (!(beam.t_near <= beam.t_far)) return;
    StackEntry stack[kStackEntries];
    int top = 0;
    stack[top++] = {view_.root, beam.t_near, beam.t_far};
    while (top > 0) {
      const StackEntry entry = stack[--top];
      if (entry.t_near > hit_.t) continue;
      if (stops_at_first_ && hit_.is_hit()) return;
      if (entry.child & kLeafBit) {
        test_leaf(entry.child);
      } else {
        top = push_children(beam, entry, stack, top);
      }
    }
  }

  int push_children(const Beam& beam, const StackEntry& entry, StackEntry* stack, int top) {
    ++cost_.nodes;
    const WideNode& node = view_.nodes[entry.child];
    float near_below[7], far_below[7], near_above[7], far_above[7];
    bool is_flipped[7];
    for (int p = 0; p < 7; ++p) {
      const unsigned axis = (node.axes >> (4 * p)) & 3u;
      const float below = (node.planes[p] - beam.origin[axis]) * beam.reciprocal[axis];
      const float above = (node.planes[p] - beam.origin[4 + axis]) * beam.reciprocal[4 + axis];
      const bool low_ends = beam.reciprocal[axis] > 0.0f;
      const bool high_ends = beam.reciprocal[4 + axis] < 0.0f;
      near_below[p] = low_ends ? -kInfinity : below;
      far_below[p] = low_ends ? below : kInfinity;
      near_above[p] = high_ends ? -kInfinity : above;
      far_above[p] = high_ends ? above : kInfinity;
      // The side of the origin comes first: a ray that meets both sides starts there.
      is_flipped[p] = node.planes[p] < beam.origin[axis];
    }
    for (int i = 7; i >= 0; --i) {
      const int b2 = (i >> 2) ^ static_cast<int>(is_flipped[0]);
      const int p1 = 1 + b2;
      const int b1 = ((i >> 1) & 1) ^ static_cast<int>(is_flipped[p1]);
      const int p2 = 3 + 2 * b2 + b1;
      const int b0 = (i & 1) ^ static_cast<int>(is_flipped[p2]);
      const KdChild child = node.children[b2 * 4 + b1 * 2 + b0];
      if (child == kEmptyChild) continue;
      float t_near = entry.t_near;
      float t_far = entry.t_far;
      const std::pair<int, int> path[3] = {{0, b2}, {p1, b1}, {p2, b0}};
      for (const auto& [p, is_above] : path) {
        t_near = std::max(t_near, is_above ? near_above[p] : near_below[p]);
        t_far = std::min(t_far, is_above ? far_above[p] : far_below[p]);
      }
      if (t_near <= t_far && t_near <= hit_.t) stack[top++] = {child, t_near, t_far};
    }
    return top;
  }

  void test_leaf(KdChild child) {
    const std::uint32_t index = child & kIndexMask;
    if ((child & kMixedBit) == 0) {
      test_blocks(child);
      return;
    }
    const MixedLeaf& leaf = view_.mixed_leaves[index];
    test_blocks(leaf.triangles);
    for (std::uint32_t s = 0; s < leaf.solid_count; ++s)
      test_solid(view_.solids[leaf.first_solid + s]);
  }

  void test_blocks(KdChild leaf) {
    while (leaf != kEmptyChild) {
      const TriangleBlock& block = view_.block(leaf);
      test_block(block);
      leaf = next_block(block, leaf);
    }
  }

  void test_block(const TriangleBlock& block) {
    cost_.primitives += block.triangle_count;
    const float ox = ray_.origin[sheared_.kx], oy = ray_.origin[sheared_.ky],
                oz = ray_.origin[sheared_.kz];
    const float* const row_x = block.row(sheared_.kx);
    const float* const row_y = block.row(sheared_.ky);
    const float* const row_z = block.row(sheared_.kz);
    for (int i = 0; i < block.triangle_count; ++i) {
      const std::size_t a = block.corners[0][i], b = block.corners[1][i], c = block.corners[2][i];
      const float az = row_z[a] - oz, bz = row_z[b] - oz, cz = row_z[c] - oz;
      const float ax = (row_x[a] - ox) - sheared_.shear_x * az;
      const float ay = (row_y[a] - oy) - sheared_.shear_y * az;
      const float bx = (row_x[b] - ox) - sheared_.shear_x * bz;
      const float by = (row_y[b] - oy) - sheared_.shear_y * bz;
      const float cx = (row_x[c] - ox) - sheared_.shear_x * cz;
      const float cy = (row_y[c] - oy) - sheared_.shear_y * cz;
      const float u = cx * by - cy * bx;
      const float v = ax * cy - ay * cx;
      const float w = bx * ay - by * ax;
      const bool is_inside =
          (u >= 0.0f && v >= 0.0f && w >= 0.0f) || (u <= 0.0f && v <= 0.0f && w <= 0.0f);
      const float determinant = (u + v) + w;
      if (!is_inside || determinant == 0.0f) continue;
      const float inverse = 1.0f / determinant;
      const float t = (((u * az + v * bz) + w * cz) * sheared_.shear_z) * inverse;
      accept(t, block.id[i], v * inverse, w * inverse);
    }
  }

  void test_solid(std::uint32_t primitive) {
    ++cost_.primitives;
    const std::uint32_t ellipsoid = primitive - view_.triangle_count;
    if (ellipsoid < view_.ellipsoid_count) {
      if (const auto hit = intersect_ellipsoid(ray_, view_.ellipsoids[ellipsoid])) {
        accept(static_cast<float>(hit->t), primitive, 0.0f, 0.0f);
      }
      return;
    }
    const ConvexPolyhedron& solid = view_.polyhedra[ellipsoid - view_.ellipsoid_count];
    if (const auto hit =
            intersect_polyhedron(ray_, {view_.planes + solid.first_plane, solid.plane_count})) {
      accept(static_cast<float>(hit->t), primitive, static_cast<float>(hit->face), 0.0f);
    }
  }

  // Of two primitives at the same distance the lower number wins, whatever was tested first.
  void accept(float t, std::uint32_t primitive, float u, float v) {
    const bool is_nearer =
        t < hit_.t || (t == hit_.t && hit_.is_hit() && primitive < hit_.primitive);
    if (t > 0.0f && is_nearer && view_.is_visible(primitive, mask_)) hit_ = {t, primitive, u, v};
  }

  const KdView& view_;
  const Ray& ray_;
  VisibilityMask mask_;
  QueryCost& cost_;
  ShearedRay sheared_;
  Hit hit_;
  bool stops_at_first_ = false;
};

}  // namespace

Hit closest_hit_scalar(const KdView& view, const Ray& ray, VisibilityMask mask, QueryCost& cost) {
  return Query(view, ray, mask, cost).closest();
}

bool any_hit_scalar(const KdView& view, const Ray& ray, VisibilityMask mask, QueryCost& cost) {
  return Query(view, ray, mask, cost).any();
}

}  // namespace abbe
