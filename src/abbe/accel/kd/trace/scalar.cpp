#include "abbe/accel/kd/trace/scalar.h"

#include "abbe/accel/kd/trace/beam.h"
#include "abbe/accel/kd/trace/state.h"
#include "abbe/accel/kd/trace/step.h"
#include "abbe/accel/leaf/search.h"

namespace abbe {
namespace {

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
    test_block(block, sheared, search.query(), search);
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
  if (view.root == kEmptyChild) return;
  const ShearedRay sheared(ray);
  TraversalStack stack;
  stack.start(view.root, beam);
  for (KdChild cell = kDoneChild; (cell = stack.child[--stack.top]) != kDoneChild;) {
    const float t_near = stack.t_near[stack.top], t_far = stack.t_far[stack.top];
    if (t_near > search.end()) continue;
    if (search.is_done()) return;
    if ((cell & kLeafBit) != 0) {
      test_leaf(view, cell, ray, sheared, search, cost);
    } else {
      ++cost.nodes;
      push_children(view.nodes[cell], beam, t_near, t_far, search.end(), stack);
    }
  }
}

}  // namespace

void RaySearch::test(std::uint32_t solid) {
  test_solid(view.solids, solid, *ray.ray, *this);
}

Hit search_nearest(const KdView& view, const Visibility& visibility, const Ray& ray, QueryMask mask,
                   bool any, QueryCost& cost) {
  NearestSearch search(visibility, mask, ray, any);
  if (visibility.sees_any(mask)) traverse(view, ray, search, cost);
  return search.answer();
}

void search_all(const KdView& view, const Visibility& visibility, std::span<const Ray> rays,
                QueryMask mask, VisibilityMask stops, HitLists& hits) {
  AllSearch search(visibility, mask, stops);
  QueryCost cost;
  for (const Ray& ray : rays) {
    search.start(ray);
    if (visibility.sees_any(mask)) traverse(view, ray, search, cost);
    search.finish(hits);
  }
}

}  // namespace abbe
