/// Triangles as leaves hold them: blocks of up to sixteen in SIMD layout.
#pragma once

#include <cstddef>
#include <cstdint>

namespace abbe {

inline constexpr int kBlockTriangles = 16;
/// Vertices of a block whose triangles share them, and of one whose triangles do not.
inline constexpr int kSharedVertices = 16;
inline constexpr int kLooseVertices = 3 * kBlockTriangles;

/// What the array of blocks is made of.
struct alignas(64) BlockLine {
  std::uint8_t bytes[64];
};

/// Up to sixteen triangles in SIMD layout: this, and behind it the rows of x, y and z of their
/// vertices. Triangles that share sixteen vertices take half the memory of separate corners, and a
/// ray moves and shears each vertex once for all its triangles. Others have a loose block: three
/// vertices each, those of the first corners first. Unused triangles have three times the same
/// corner, which no ray meets.
struct alignas(64) TriangleBlock {
  std::uint8_t corners[3][kBlockTriangles];  ///< Numbers of the vertices of each triangle.
  std::uint8_t triangle_count;
  std::uint8_t is_loose;     ///< 1 or 0.
  std::uint8_t next_lines;   ///< To the leaf's next block, in lines; 0 if there is none.
  std::uint16_t front_only;  ///< A bit for each triangle that no ray meets from behind.
  alignas(64) std::uint32_t id[kBlockTriangles];

  int vertices_per_row() const { return is_loose != 0 ? kLooseVertices : kSharedVertices; }
  const float* rows() const { return reinterpret_cast<const float*>(this + 1); }
  /// The coordinates of all vertices along an axis.
  const float* row(int axis) const { return rows() + axis * vertices_per_row(); }
};
static_assert(sizeof(TriangleBlock) == 2 * sizeof(BlockLine));

/// Lines of a block with its vertices.
inline constexpr std::uint32_t kSharedBlockLines = 2 + 3 * kSharedVertices * sizeof(float) / 64;
inline constexpr std::uint32_t kLooseBlockLines = 2 + 3 * kLooseVertices * sizeof(float) / 64;

/// The block that begins with a line.
inline const TriangleBlock& block_at(const BlockLine* line) {
  return *reinterpret_cast<const TriangleBlock*>(line);
}

}  // namespace abbe
