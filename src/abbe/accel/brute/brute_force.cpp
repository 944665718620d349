#include "abbe/accel/brute/brute_force.h"

#include <numeric>
#include <vector>

#include "abbe/accel/leaf/block_packer.h"
#include "abbe/accel/leaf/search.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "abbe/accel/brute/brute_force.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "abbe/accel/leaf/triangles-inl.h"

HWY_BEFORE_NAMESPACE();
namespace abbe {
namespace HWY_NAMESPACE {

// Shows the search all triangles of loose blocks that lie behind each other.
void TestBlocks(std::span<const BlockLine> blocks, const ShearedRay& ray, AllSearch& search) {
  BlockResult result;
  for (std::size_t line = 0; line < blocks.size(); line += kLooseBlockLines) {
    const TriangleBlock& block = block_at(&blocks[line]);
    TestBlockOf<true>(block, ray, search.end(), result);
    if (result.candidates != 0) ShowCandidates(block, result, ray.shear_z, search.query(), search);
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace abbe
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace abbe {

HWY_EXPORT(TestBlocks);

BruteForce::BruteForce(const ShapeSpans& shapes)
    : solid_count_(static_cast<std::uint32_t>(shapes.ellipsoids.size() + shapes.polyhedra.size())),
      solids_(shapes),
      visibility_(shapes) {
  std::vector<std::uint32_t> triangles(shapes.triangles.size());
  std::iota(triangles.begin(), triangles.end(), 0u);
  const std::size_t blocks = (triangles.size() + kBlockTriangles - 1) / kBlockTriangles;
  blocks_ = FlatArray<BlockLine>(blocks * kLooseBlockLines);
  if (blocks != 0) {
    BlockLine* to = blocks_.data();
    BlockPacker(shapes, true).pack(triangles, [&](const PackedBlock& block) {
      block.write(to);
      to += block.lines();
    });
  }
  for (const Triangle& triangle : shapes.triangles) {
    for (const std::uint32_t corner : triangle) bounds_.extend(shapes.positions[corner]);
  }
  for (const Ellipsoid& ellipsoid : shapes.ellipsoids) bounds_.extend(ellipsoid.bounds);
  for (const ConvexPolyhedron& polyhedron : shapes.polyhedra) bounds_.extend(polyhedron.bounds);
}

void BruteForce::all_hits(std::span<const Ray> rays, QueryMask mask, VisibilityMask stops,
                          HitLists& hits) const {
  hits.clear();
  AllSearch search(visibility_, mask, stops);
  const SolidView solids = solids_.view();
  for (const Ray& ray : rays) {
    search.start(ray);
    HWY_DYNAMIC_DISPATCH(TestBlocks)
    ({blocks_.data(), blocks_.size()}, ShearedRay(ray), search);
    for (std::uint32_t i = 0; i < solid_count_; ++i) {
      test_solid(solids, solids.triangle_count + i, ray, search);
    }
    search.finish(hits);
  }
}

void BruteForce::closest_hits(std::span<const Ray> rays, QueryMask mask,
                              std::span<Hit> hits) const {
  HitLists lists;
  // What it sees stops a ray.
  all_hits(rays, mask, static_cast<VisibilityMask>(mask & kAllBits), lists);
  for (std::size_t i = 0; i < rays.size(); ++i) {
    hits[i] = lists[i].empty() ? Hit{} : lists[i].front();
  }
}

void BruteForce::any_hits(std::span<const Ray> rays, QueryMask mask,
                          std::span<std::uint8_t> occluded) const {
  std::vector<Hit> hits(rays.size());
  closest_hits(rays, mask, hits);
  for (std::size_t i = 0; i < rays.size(); ++i) occluded[i] = hits[i].is_hit() ? 1 : 0;
}

// Every primitive is tested: what a ray meets makes no difference.
Hit BruteForce::closest_hit_with_cost(const Ray& ray, QueryMask mask, QueryCost& cost) const {
  Hit hit;
  closest_hits({&ray, 1}, mask, {&hit, 1});
  cost.primitives += solids_.view().triangle_count + solid_count_;
  return hit;
}

bool BruteForce::any_hit_with_cost(const Ray& ray, QueryMask mask, QueryCost& cost) const {
  return closest_hit_with_cost(ray, mask, cost).is_hit();
}

std::size_t BruteForce::bytes() const {
  return blocks_.bytes() + solids_.bytes() + visibility_.bytes();
}

}  // namespace abbe
#endif  // HWY_ONCE
