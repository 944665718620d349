#include "abbe/accel/kd/build/convert.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cstring>
#include <span>
#include <vector>

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

// A block as it grows.
struct PackedBlock {
  TriangleBlock head{};
  float rows[3][kLooseVertices] = {};

  void write(BlockLine* to) const {
    std::memcpy(to, &head, sizeof(head));
    const auto count = static_cast<std::size_t>(head.vertices_per_row());
    auto* const vertices = reinterpret_cast<float*>(to + 2);
    for (std::size_t k = 0; k < 3; ++k) {
      std::copy_n(rows[k], count, vertices + k * count);
    }
  }
};

// Packs the triangles of a leaf into blocks, one after the other.
class BlockPacker {
 public:
  BlockPacker(const ShapeSpans& shapes, bool is_loose) : shapes_(shapes), is_loose_(is_loose) {}

  // Hands each full block to `emit`, and the last one.
  template <class Emit>
  void pack(std::span<const std::uint32_t> triangles, Emit emit) {
    clear();
    for (const std::uint32_t id : triangles) {
      if (block_.head.triangle_count == kBlockTriangles || !add(id)) {
        block_.head.next_lines =
            static_cast<std::uint8_t>(is_loose_ ? kLooseBlockLines : kSharedBlockLines);
        emit(block_);
        clear();
        add(id);
      }
    }
    emit(block_);
  }

 private:
  void clear() {
    block_ = {};
    block_.head.is_loose = is_loose_ ? 1 : 0;
    vertex_count_ = 0;
  }

  // False, with nothing added, if the block has no room for the vertices.
  bool add(std::uint32_t id) {
    const std::uint32_t old_count = vertex_count_;
    const std::size_t lane = block_.head.triangle_count;
    for (std::size_t corner = 0; corner < 3; ++corner) {
      const Vec3f& position = shapes_.positions[shapes_.triangles[id][corner]];
      auto vertex = static_cast<std::uint32_t>(corner * kBlockTriangles + lane);
      if (is_loose_) {
        set_vertex(vertex, position);
      } else if ((vertex = find_or_add(position)) == kSharedVertices) {
        vertex_count_ = old_count;
        for (auto& row : block_.head.corners) row[lane] = 0;
        return false;
      }
      block_.head.corners[corner][lane] = static_cast<std::uint8_t>(vertex);
    }
    block_.head.id[lane] = id;
    ++block_.head.triangle_count;
    return true;
  }

  void set_vertex(std::uint32_t vertex, const Vec3f& position) {
    for (int k = 0; k < 3; ++k) block_.rows[k][vertex] = position[k];
  }

  // The number of a vertex in the block, kSharedVertices if there is no room. Vertices are shared
  // by position: faces that meet in an edge often differ in what else a vertex has.
  std::uint32_t find_or_add(const Vec3f& position) {
    const auto bits = std::bit_cast<std::array<std::uint32_t, 3>>(position);
    for (std::uint32_t v = 0; v < vertex_count_; ++v) {
      if (bits_[v] == bits) return v;
    }
    if (vertex_count_ == kSharedVertices) return kSharedVertices;
    bits_[vertex_count_] = bits;
    set_vertex(vertex_count_, position);
    return vertex_count_++;
  }

  const ShapeSpans& shapes_;
  bool is_loose_;
  PackedBlock block_;
  std::array<std::array<std::uint32_t, 3>, kSharedVertices> bits_{};
  std::uint32_t vertex_count_ = 0;
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
