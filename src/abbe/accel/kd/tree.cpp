#include "abbe/accel/kd/tree.h"

#include <algorithm>
#include <vector>

#include "abbe/accel/kd/build/build.h"
#include "abbe/accel/kd/build/convert.h"
#include "abbe/accel/kd/layout.h"
#include "abbe/accel/kd/trace/kernels.h"
#include "abbe/accel/kd/trace/scalar.h"
#include "abbe/accel/leaf/isolated_solids.h"

namespace abbe {

struct KdTree::Data {
  KdArrays arrays;
  std::vector<Ellipsoid> ellipsoids;
  std::vector<ConvexPolyhedron> polyhedra;
  std::vector<Plane> planes;
  std::vector<VisibilityMask> masks;
  std::vector<std::uint8_t> isolated_solids;
  KdView view;
  KdView unmasked;  ///< Of the same, for queries that see every primitive.
  bool all_have_bits = true;

  bool can_hit(VisibilityMask mask) const {
    return view.root != kEmptyChild && (view.any_mask & mask) != 0;
  }
  // The mask of a primitive is a memory access away: it is only looked at where it matters.
  const KdView& view_of(VisibilityMask mask) const {
    const bool sees_all = all_have_bits && (view.any_mask & mask) == view.any_mask;
    return sees_all ? unmasked : view;
  }
};

namespace {

// Bits of all primitives, whether they are the same for all, and whether none is without.
struct MaskSummary {
  VisibilityMask any = 0;
  bool is_uniform = true;
  bool all_have_bits = true;
};

MaskSummary summarize_masks(const ShapeSpans& shapes) {
  if (shapes.masks.empty()) return {kAllBits, true, true};
  MaskSummary summary{0, true, true};
  for (const VisibilityMask mask : shapes.masks) {
    summary.any = static_cast<VisibilityMask>(summary.any | mask);
    summary.is_uniform = summary.is_uniform && mask == shapes.masks.front();
    summary.all_have_bits = summary.all_have_bits && mask != 0;
  }
  return summary;
}

HitPacket nothing_hit() {
  HitPacket hits{};
  std::fill(std::begin(hits.t), std::end(hits.t), kInfinity);
  std::fill(std::begin(hits.primitive), std::end(hits.primitive), kNoPrimitive);
  return hits;
}

}  // namespace

KdTree::KdTree() : data_(std::make_unique<const Data>()) {}
KdTree::KdTree(KdTree&&) noexcept = default;
KdTree& KdTree::operator=(KdTree&&) noexcept = default;
KdTree::~KdTree() = default;

KdTree KdTree::build(const ShapeSpans& shapes, const KdTreeConfig& config) {
  auto data = std::make_unique<Data>();
  const BuildTree tree = build_kd_tree(shapes, config);
  data->arrays = convert_kd_tree(tree, shapes);
  data->ellipsoids.assign(shapes.ellipsoids.begin(), shapes.ellipsoids.end());
  data->polyhedra.assign(shapes.polyhedra.begin(), shapes.polyhedra.end());
  data->planes.assign(shapes.planes.begin(), shapes.planes.end());
  const MaskSummary masks = summarize_masks(shapes);
  if (!masks.is_uniform) data->masks.assign(shapes.masks.begin(), shapes.masks.end());

  KdView& view = data->view;
  view.root = data->arrays.root;
  view.nodes = data->arrays.nodes.data();
  view.blocks = data->arrays.blocks.data();
  view.lines_ahead = data->arrays.lines_ahead;
  view.mixed_leaves = data->arrays.mixed_leaves.data();
  view.solids = data->arrays.solids.data();
  view.ellipsoids = data->ellipsoids.data();
  view.polyhedra = data->polyhedra.data();
  view.planes = data->planes.data();
  data->isolated_solids = find_isolated_solids(shapes);
  view.isolated_solids = data->isolated_solids.data();
  view.masks = masks.is_uniform ? nullptr : data->masks.data();
  view.any_mask = masks.any;
  view.triangle_count = static_cast<std::uint32_t>(shapes.triangles.size());
  view.ellipsoid_count = static_cast<std::uint32_t>(shapes.ellipsoids.size());
  view.bounds = tree.bounds;
  data->unmasked = view;
  data->unmasked.masks = nullptr;
  data->all_have_bits = masks.all_have_bits;

  KdTree result;
  result.data_ = std::move(data);
  return result;
}

void KdTree::closest_hits(std::span<const Ray> rays, VisibilityMask mask,
                          std::span<Hit> hits) const {
  if (!data_->can_hit(mask)) {
    std::fill_n(hits.begin(), rays.size(), Hit{});
    return;
  }
  trace_closest(data_->view_of(mask), rays.data(), rays.size(), mask, hits.data());
}

void KdTree::closest_hits(std::span<const RayPacket> packets, VisibilityMask mask,
                          std::span<HitPacket> hits) const {
  if (!data_->can_hit(mask)) {
    std::fill_n(hits.begin(), packets.size(), nothing_hit());
    return;
  }
  trace_closest(data_->view_of(mask), packets.data(), packets.size(), mask, hits.data());
}

void KdTree::any_hits(std::span<const Ray> rays, VisibilityMask mask,
                      std::span<std::uint8_t> occluded) const {
  if (!data_->can_hit(mask)) {
    std::fill_n(occluded.begin(), rays.size(), std::uint8_t{0});
    return;
  }
  trace_any(data_->view_of(mask), rays.data(), rays.size(), mask, occluded.data());
}

void KdTree::any_hits(std::span<const RayPacket> packets, VisibilityMask mask,
                      std::span<std::uint32_t> occluded) const {
  if (!data_->can_hit(mask)) {
    std::fill_n(occluded.begin(), packets.size(), 0u);
    return;
  }
  trace_any(data_->view_of(mask), packets.data(), packets.size(), mask, occluded.data());
}

Hit KdTree::closest_hit_with_cost(const Ray& ray, VisibilityMask mask, QueryCost& cost) const {
  return closest_hit_scalar(data_->view, ray, mask, cost);
}

bool KdTree::any_hit_with_cost(const Ray& ray, VisibilityMask mask, QueryCost& cost) const {
  return any_hit_scalar(data_->view, ray, mask, cost);
}

Box3f KdTree::bounds() const {
  return data_->view.bounds;
}

std::size_t KdTree::bytes() const {
  const Data& d = *data_;
  return d.arrays.nodes.bytes() + d.arrays.blocks.bytes() +
         d.arrays.mixed_leaves.size() * sizeof(MixedLeaf) +
         d.arrays.solids.size() * sizeof(std::uint32_t) + d.ellipsoids.size() * sizeof(Ellipsoid) +
         d.polyhedra.size() * sizeof(ConvexPolyhedron) + d.planes.size() * sizeof(Plane) +
         d.masks.size();
}

}  // namespace abbe
