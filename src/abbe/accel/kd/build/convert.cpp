#include "abbe/accel/kd/build/convert.h"

#include <algorithm>
#include <span>
#include <vector>

#include "abbe/accel/leaf/block_packer.h"
#include "abbe/base/parallel.h"

namespace abbe {
namespace {

// The triangles of a leaf and where their blocks go.
struct LeafSlot {
  std::span<const std::uint32_t> triangles;
  bool is_loose = false;
  std::uint32_t first_line = 0;
  std::uint32_t line_count = 0;
};

class Converter {
 public:
  Converter(const BuildTree& tree, const ShapeSpans& shapes, KdArrays& arrays)
      : tree_(tree), shapes_(shapes), arrays_(arrays), nodes_(1) {}

  void run() {
    KdChild root = add(0);
    parallel_for(0, leaves_.size(), kLeavesPerTask, [&](std::size_t i) { plan(leaves_[i]); });
    std::uint32_t line_count = 0, loose_lines = 0;
    for (LeafSlot& leaf : leaves_) {
      leaf.first_line = line_count;
      line_count += leaf.line_count;
      if (leaf.is_loose) loose_lines += leaf.line_count;
    }
    if (loose_lines > line_count - loose_lines) arrays_.lines_ahead = kLooseBlockLines;
    arrays_.blocks = FlatArray<BlockLine>(line_count);
    parallel_for(0, leaves_.size(), kLeavesPerTask, [&](std::size_t i) {
      const LeafSlot& leaf = leaves_[i];
      BlockLine* to = arrays_.blocks.data() + leaf.first_line;
      BlockPacker(shapes_, leaf.is_loose).pack(leaf.triangles, [&](const PackedBlock& block) {
        block.write(to);
        to += block.head.next_lines;
      });
    });
    place_blocks(root);
    arrays_.root = root;
    arrays_.nodes = FlatArray<WideNode>(nodes_.size());
    for (WideNode& node : nodes_) {
      for (KdChild& child : node.children) place_blocks(child);
    }
    std::copy(nodes_.begin(), nodes_.end(), arrays_.nodes.data());
    for (MixedLeaf& mixed : arrays_.mixed_leaves) place_blocks(mixed.triangles);
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
    const auto leaf_number = static_cast<std::uint32_t>(leaves_.size());
    if (triangles > 0) leaves_.push_back({primitives.first(triangles)});
    if (triangles == primitives.size()) return kLeafBit | leaf_number;
    const auto mixed = static_cast<std::uint32_t>(arrays_.mixed_leaves.size());
    arrays_.mixed_leaves.push_back({triangles > 0 ? kLeafBit | leaf_number : kEmptyChild,
                                    static_cast<std::uint32_t>(arrays_.solids.size()),
                                    static_cast<std::uint32_t>(primitives.size() - triangles)});
    arrays_.solids.insert(arrays_.solids.end(), end, primitives.end());
    return kLeafBit | kMixedBit | mixed;
  }

  // Loose blocks where triangles share so little that they would take more blocks: a block costs a
  // ray the same, however full it is.
  void plan(LeafSlot& leaf) const {
    std::size_t shared = 0;
    BlockPacker(shapes_, false).pack(leaf.triangles, [&](const PackedBlock&) { ++shared; });
    const std::size_t loose = (leaf.triangles.size() + kBlockTriangles - 1) / kBlockTriangles;
    leaf.is_loose = loose < shared;
    leaf.line_count = static_cast<std::uint32_t>(leaf.is_loose ? loose * kLooseBlockLines
                                                               : shared * kSharedBlockLines);
  }

  // From the number of a leaf of triangles, as add_leaf() leaves it, to that of its first line.
  void place_blocks(KdChild& child) const {
    if ((child & kLeafBit) == 0 || (child & kMixedBit) != 0) return;
    child = kLeafBit | leaves_[child & kIndexMask].first_line;
  }

  static constexpr std::size_t kLeavesPerTask = 256;
  static constexpr std::uint32_t kNothing = 0xffffffffu;
  const BuildTree& tree_;
  const ShapeSpans& shapes_;
  KdArrays& arrays_;
  std::vector<WideNode> nodes_;
  std::vector<LeafSlot> leaves_;
};

}  // namespace

KdArrays convert_kd_tree(const BuildTree& tree, const ShapeSpans& shapes) {
  KdArrays arrays;
  Converter(tree, shapes, arrays).run();
  return arrays;
}

}  // namespace abbe
