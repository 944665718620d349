#include "accel/kd_convert.h"

#include <algorithm>
#include <span>

#include "base/parallel.h"

namespace abbe {
namespace {

// Where the blocks of a leaf go, so that they can be filled in parallel.
struct LeafSlot {
  std::uint32_t first_block;
  std::span<const std::uint32_t> triangles;
};

std::size_t blocks_for(std::size_t triangles) {
  return (triangles + kBlockTriangles - 1) / kBlockTriangles;
}

class Converter {
 public:
  Converter(const BuildTree& tree, const ShapeSpans& shapes, KdArrays& arrays)
      : tree_(tree), shapes_(shapes), arrays_(arrays), nodes_(1) {}

  void run() {
    arrays_.root = add(0);
    arrays_.nodes = FlatArray<WideNode>(nodes_.size());
    std::copy(nodes_.begin(), nodes_.end(), arrays_.nodes.data());
    arrays_.blocks = FlatArray<TriangleBlock>(block_count_);
    parallel_for(0, leaves_.size(), 1024, [&](std::size_t i) { fill(leaves_[i]); });
  }

 private:
  KdChild add(std::uint32_t index) {
    const BuildNode& node = tree_.nodes[index];
    return node.axis == BuildNode::kLeaf ? add_leaf(node) : add_inner(index);
  }

  KdChild add_inner(std::uint32_t index) {
    const auto wide_index = static_cast<std::uint32_t>(nodes_.size());
    nodes_.emplace_back();
    WideNode wide{};
    std::fill(std::begin(wide.planes), std::end(wide.planes), kInfinity);
    std::uint32_t bottom[8];
    std::fill(std::begin(bottom), std::end(bottom), kNothing);
    expand(index, 0, 0, 1, wide, bottom);
    for (int c = 0; c < 8; ++c) {
      wide.children[c] = bottom[c] == kNothing ? kEmptyChild : add(bottom[c]);
    }
    nodes_[wide_index] = wide;
    return wide_index;
  }

  // Lays the binary node at plane `plane` of the wide node, below it child slots from `slot`.
  // A leaf that comes early takes the lower side of planes at infinity: every ray is below those.
  void expand(std::uint32_t index, int plane, int slot, int level, WideNode& wide,
              std::uint32_t* bottom) const {
    const BuildNode& node = tree_.nodes[index];
    if (level == 4 || node.axis == BuildNode::kLeaf) {
      bottom[slot] = index;
      return;
    }
    wide.planes[plane] = node.plane;
    wide.axes |= node.axis << (4 * plane);
    expand(node.first, 2 * plane + 1, slot, level + 1, wide, bottom);
    expand(node.second, 2 * plane + 2, slot + (8 >> level), level + 1, wide, bottom);
  }

  KdChild add_leaf(const BuildNode& leaf) {
    if (leaf.second == 0) return kEmptyChild;
    const std::span<const std::uint32_t> primitives(tree_.primitives.data() + leaf.first,
                                                    leaf.second);
    // Primitives ascend and triangles come first.
    const auto end = std::lower_bound(primitives.begin(), primitives.end(),
                                      static_cast<std::uint32_t>(shapes_.triangles.size()));
    const auto triangles = static_cast<std::size_t>(end - primitives.begin());
    const auto first_block = static_cast<std::uint32_t>(block_count_);
    const std::size_t blocks = blocks_for(triangles);
    if (triangles > 0) leaves_.push_back({first_block, primitives.first(triangles)});
    block_count_ += blocks;
    if (triangles == primitives.size()) return kLeafBit | first_block;
    const auto mixed = static_cast<std::uint32_t>(arrays_.mixed_leaves.size());
    arrays_.mixed_leaves.push_back({first_block, static_cast<std::uint32_t>(blocks),
                                    static_cast<std::uint32_t>(arrays_.solids.size()),
                                    static_cast<std::uint32_t>(primitives.size() - triangles)});
    arrays_.solids.insert(arrays_.solids.end(), end, primitives.end());
    return kLeafBit | kMixedBit | mixed;
  }

  void fill(const LeafSlot& leaf) {
    const std::size_t blocks = blocks_for(leaf.triangles.size());
    for (std::size_t b = 0; b < blocks; ++b) {
      TriangleBlock& block = arrays_.blocks[leaf.first_block + b];
      for (std::size_t lane = 0; lane < kBlockTriangles; ++lane) {
        const std::size_t i = b * kBlockTriangles + lane;
        const bool is_used = i < leaf.triangles.size();
        const std::uint32_t id = leaf.triangles[is_used ? i : b * kBlockTriangles];
        for (std::size_t corner = 0; corner < 3; ++corner) {
          const Vec3f& p = shapes_.positions[shapes_.triangles[id][is_used ? corner : 0]];
          for (int k = 0; k < 3; ++k)
            block.corners[corner * 3 + static_cast<std::size_t>(k)][lane] = p[k];
        }
        block.id[lane] = id;
      }
      if (b + 1 < blocks) block.id[0] |= kMoreBlocksBit;
    }
  }

  static constexpr std::uint32_t kNothing = 0xffffffffu;
  const BuildTree& tree_;
  const ShapeSpans& shapes_;
  KdArrays& arrays_;
  std::vector<WideNode> nodes_;
  std::vector<LeafSlot> leaves_;
  std::size_t block_count_ = 0;
};

}  // namespace

KdArrays convert_kd_tree(const BuildTree& tree, const ShapeSpans& shapes) {
  KdArrays arrays;
  Converter(tree, shapes, arrays).run();
  return arrays;
}

}  // namespace abbe
