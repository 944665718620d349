#include "accel/kd_convert.h"

#include <algorithm>
#include <array>
#include <bit>
#include <span>
#include <vector>

#include "base/parallel.h"

namespace abbe {
namespace {

// The triangles of a leaf and where their blocks go.
struct LeafSlot {
  std::span<const std::uint32_t> triangles;
  std::uint32_t first_block = 0;
  std::uint32_t block_count = 0;
};

// Packs the triangles of a leaf into blocks, one after the other.
class BlockPacker {
 public:
  explicit BlockPacker(const ShapeSpans& shapes) : shapes_(shapes) {}

  // Hands each full block to `emit`, and the last one.
  template <class Emit>
  void pack(std::span<const std::uint32_t> triangles, Emit emit) {
    clear();
    for (const std::uint32_t id : triangles) {
      if (block_.triangle_count == kBlockTriangles || !add(id)) {
        block_.has_next = 1;
        emit(block_);
        clear();
        add(id);
      }
    }
    if (block_.triangle_count > 0) emit(block_);
  }

 private:
  void clear() {
    block_ = {};
    vertex_count_ = 0;
  }

  // False, with nothing added, if the block has no room for the vertices.
  bool add(std::uint32_t id) {
    const std::uint32_t old_count = vertex_count_;
    const std::size_t lane = block_.triangle_count;
    for (std::size_t corner = 0; corner < 3; ++corner) {
      const std::uint32_t vertex = find_or_add(shapes_.triangles[id][corner]);
      if (vertex == kBlockVertices) {
        vertex_count_ = old_count;
        for (auto& row : block_.corners) row[lane] = 0;
        return false;
      }
      block_.corners[corner][lane] = static_cast<std::uint8_t>(vertex);
    }
    block_.id[lane] = id;
    ++block_.triangle_count;
    return true;
  }

  // The number of a vertex in the block, kBlockVertices if there is no room. Vertices are shared by
  // position: faces that meet in an edge often differ in what else a vertex has.
  std::uint32_t find_or_add(std::uint32_t index) {
    const Vec3f& p = shapes_.positions[index];
    const std::array<std::uint32_t, 3> bits = std::bit_cast<std::array<std::uint32_t, 3>>(p);
    for (std::uint32_t v = 0; v < vertex_count_; ++v) {
      if (bits_[v] == bits) return v;
    }
    if (vertex_count_ == kBlockVertices) return kBlockVertices;
    bits_[vertex_count_] = bits;
    for (int k = 0; k < 3; ++k) block_.vertices[k][vertex_count_] = p[k];
    return vertex_count_++;
  }

  const ShapeSpans& shapes_;
  TriangleBlock block_{};
  std::array<std::array<std::uint32_t, 3>, kBlockVertices> bits_{};
  std::uint32_t vertex_count_ = 0;
};

class Converter {
 public:
  Converter(const BuildTree& tree, const ShapeSpans& shapes, KdArrays& arrays)
      : tree_(tree), shapes_(shapes), arrays_(arrays), nodes_(1) {}

  void run() {
    KdChild root = add(0);
    parallel_for(0, leaves_.size(), kLeavesPerTask, [&](std::size_t i) {
      BlockPacker(shapes_).pack(leaves_[i].triangles,
                                [&](const TriangleBlock&) { ++leaves_[i].block_count; });
    });
    std::uint32_t block_count = 0;
    for (LeafSlot& leaf : leaves_) {
      leaf.first_block = block_count;
      block_count += leaf.block_count;
    }
    arrays_.blocks = FlatArray<TriangleBlock>(block_count);
    parallel_for(0, leaves_.size(), kLeavesPerTask, [&](std::size_t i) {
      TriangleBlock* next = arrays_.blocks.data() + leaves_[i].first_block;
      BlockPacker(shapes_).pack(leaves_[i].triangles,
                                [&](const TriangleBlock& block) { *next++ = block; });
    });
    place_blocks(root);
    arrays_.root = root;
    arrays_.nodes = FlatArray<WideNode>(nodes_.size());
    for (WideNode& node : nodes_) {
      for (KdChild& child : node.children) place_blocks(child);
    }
    std::copy(nodes_.begin(), nodes_.end(), arrays_.nodes.data());
    for (MixedLeaf& mixed : arrays_.mixed_leaves) {
      if (mixed.block_count == 0) continue;  // No triangles.
      const LeafSlot& leaf = leaves_[mixed.first_block];
      mixed.first_block = leaf.first_block;
      mixed.block_count = leaf.block_count;
    }
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
    arrays_.mixed_leaves.push_back({leaf_number, triangles > 0 ? 1u : 0u,
                                    static_cast<std::uint32_t>(arrays_.solids.size()),
                                    static_cast<std::uint32_t>(primitives.size() - triangles)});
    arrays_.solids.insert(arrays_.solids.end(), end, primitives.end());
    return kLeafBit | kMixedBit | mixed;
  }

  // From the number of a leaf of triangles, as add_leaf() leaves it, to that of its first block.
  void place_blocks(KdChild& child) const {
    if ((child & kLeafBit) == 0 || (child & kMixedBit) != 0) return;
    child = kLeafBit | leaves_[child & kIndexMask].first_block;
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
