#include "abbe/accel/kd/trace/scalar.h"

#include <algorithm>
#include <utility>

#include "abbe/accel/kd/trace/beam.h"
#include "abbe/accel/leaf/search.h"

namespace abbe {
namespace {

struct StackEntry {
  KdChild child;
  float t_near, t_far;
};

// Puts the children that the beam meets before t_end onto a stack, the nearest on top; returns how
// many.
int push_children(const WideNode& node, const Beam& beam, const StackEntry& entry, float t_end,
                  StackEntry* stack) {
  int count = 0;
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
    if (t_near <= t_far && t_near <= t_end) stack[count++] = {child, t_near, t_far};
  }
  return count;
}

template <class Search>
void test_leaf(const KdView& view, KdChild leaf, const Ray& ray, const ShearedRay& sheared,
               Search& search, QueryCost& cost) {
  std::span<const std::uint32_t> solids;
  if ((leaf & kMixedBit) != 0) {
    const MixedLeaf& mixed = view.mixed_leaves[leaf & kIndexMask];
    solids = {view.leaf_solids + mixed.first_solid, mixed.solid_count};
    leaf = mixed.triangles;
  }
  while (leaf != kEmptyChild) {
    const TriangleBlock& block = view.block(leaf);
    cost.primitives += block.triangle_count;
    test_block(block, sheared, search);
    leaf = next_block(block, leaf);
  }
  cost.primitives += solids.size();
  for (const std::uint32_t solid : solids) test_solid(view.solids, solid, ray, search);
}

// Shows the search what lies in the cells that the ray meets before the search's end, the nearest
// first.
template <class Search>
void traverse(const KdView& view, const Ray& ray, Search& search, QueryCost& cost) {
  const Beam beam = make_beam(ray, view.bounds);
  if (view.root == kEmptyChild || !(beam.t_near <= beam.t_far)) return;
  const ShearedRay sheared(ray);
  StackEntry stack[kStackEntries];
  int top = 0;
  stack[top++] = {view.root, beam.t_near, beam.t_far};
  while (top > 0) {
    const StackEntry entry = stack[--top];
    if (entry.t_near > search.end()) continue;
    if (search.is_done()) return;
    if ((entry.child & kLeafBit) != 0) {
      test_leaf(view, entry.child, ray, sheared, search, cost);
    } else {
      ++cost.nodes;
      top += push_children(view.nodes[entry.child], beam, entry, search.end(), stack + top);
    }
  }
}

}  // namespace

Hit search_nearest(const KdView& view, const Visibility& visibility, const Ray& ray,
                   VisibilityMask mask, bool any, QueryCost& cost) {
  NearestSearch search(visibility, mask, ray, any);
  if (visibility.sees_any(mask)) traverse(view, ray, search, cost);
  return search.answer();
}

void search_all(const KdView& view, const Visibility& visibility, std::span<const Ray> rays,
                VisibilityMask mask, VisibilityMask stops, HitLists& hits) {
  AllSearch search(visibility, mask, stops);
  QueryCost cost;
  for (const Ray& ray : rays) {
    search.start(ray);
    if (visibility.sees_any(mask)) traverse(view, ray, search, cost);
    search.finish(hits);
  }
}

}  // namespace abbe
