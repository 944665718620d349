/// From triangles to the blocks that leaves hold.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstring>
#include <span>

#include "abbe/accel/leaf/block.h"
#include "abbe/accel/shapes.h"

namespace abbe {

/// A block as it grows.
struct PackedBlock {
  TriangleBlock head{};
  float rows[3][kLooseVertices] = {};

  std::uint32_t lines() const { return head.is_loose != 0 ? kLooseBlockLines : kSharedBlockLines; }
  /// Writes the block to so many lines.
  void write(BlockLine* to) const {
    std::memcpy(to, &head, sizeof(head));
    const auto count = static_cast<std::size_t>(head.vertices_per_row());
    auto* const vertices = reinterpret_cast<float*>(to + 2);
    for (std::size_t k = 0; k < 3; ++k) {
      std::copy_n(rows[k], count, vertices + k * count);
    }
  }
};

/// Packs the triangles of a leaf into blocks, one after the other.
class BlockPacker {
 public:
  BlockPacker(const ShapeSpans& shapes, bool is_loose) : shapes_(shapes), is_loose_(is_loose) {}

  /// Hands each full block to `emit`, and the last one.
  template <class Emit>
  void pack(std::span<const std::uint32_t> triangles, Emit emit) {
    clear();
    for (const std::uint32_t id : triangles) {
      if (block_.head.triangle_count == kBlockTriangles || !add(id)) {
        block_.head.next_lines = static_cast<std::uint8_t>(block_.lines());
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
    if (!shapes_.front_only.empty() && shapes_.front_only[id] != 0) {
      block_.head.front_only = static_cast<std::uint16_t>(block_.head.front_only | 1u << lane);
    }
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

}  // namespace abbe
