#include "abbe/accel/brute/brute_force.h"

#include <numeric>
#include <vector>

#include "abbe/accel/brute/kernels.h"
#include "abbe/accel/leaf/block_packer.h"
#include "abbe/accel/leaf/search.h"

namespace abbe {

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

template <class Search>
void BruteForce::show_all(const Ray& ray, Search& search) const {
  test_blocks({blocks_.data(), blocks_.size()}, ShearedRay(ray), search);
  const SolidView solids = solids_.view();
  for (std::uint32_t i = 0; i < solid_count_ && !search.is_done(); ++i) {
    test_solid(solids, solids.triangle_count + i, ray, search);
  }
}

void BruteForce::closest_hits(std::span<const Ray> rays, VisibilityMask mask,
                              std::span<Hit> hits) const {
  for (std::size_t i = 0; i < rays.size(); ++i) {
    NearestSearch search(visibility_, mask, rays[i], false);
    show_all(rays[i], search);
    hits[i] = search.answer();
  }
}

void BruteForce::any_hits(std::span<const Ray> rays, VisibilityMask mask,
                          std::span<std::uint8_t> occluded) const {
  for (std::size_t i = 0; i < rays.size(); ++i) {
    NearestSearch search(visibility_, mask, rays[i], true);
    show_all(rays[i], search);
    occluded[i] = search.answer().is_hit() ? 1 : 0;
  }
}

void BruteForce::all_hits(std::span<const Ray> rays, VisibilityMask mask, VisibilityMask stops,
                          HitLists& hits) const {
  hits.clear();
  AllSearch search(visibility_, mask, stops);
  for (const Ray& ray : rays) {
    search.start(ray);
    show_all(ray, search);
    search.finish(hits);
  }
}

// Every primitive is tested: what a ray meets makes no difference.
Hit BruteForce::closest_hit_with_cost(const Ray& ray, VisibilityMask mask, QueryCost& cost) const {
  Hit hit;
  closest_hits({&ray, 1}, mask, {&hit, 1});
  cost.primitives += solids_.view().triangle_count + solid_count_;
  return hit;
}

bool BruteForce::any_hit_with_cost(const Ray& ray, VisibilityMask mask, QueryCost& cost) const {
  return closest_hit_with_cost(ray, mask, cost).is_hit();
}

std::size_t BruteForce::bytes() const {
  return blocks_.bytes() + solids_.bytes() + visibility_.bytes();
}

}  // namespace abbe
