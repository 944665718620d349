#include "abbe/accel/instances/bounds.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

namespace abbe {
namespace {

constexpr std::size_t kCells = 4;  // Along each axis.

}  // namespace

// A triangle is in the hull of its corners, and that in the hull of the boxes that hold them.
std::vector<Box3f> boxes_of_parts(std::span<const Vec3f> positions,
                                  std::span<const Triangle> triangles) {
  Box3f all;
  for (const Triangle& triangle : triangles) {
    for (const std::uint32_t corner : triangle) all.extend(positions[corner]);
  }
  const Vec3f size = all.size();
  std::array<Box3f, kCells * kCells * kCells> cells;
  for (const Triangle& triangle : triangles) {
    for (const std::uint32_t corner : triangle) {
      std::size_t cell = 0;
      for (int axis = 0; axis < 3; ++axis) {
        const float share =
            size[axis] > 0.0f ? (positions[corner][axis] - all.low[axis]) / size[axis] : 0.0f;
        cell = cell * kCells +
               std::min(static_cast<std::size_t>(share * static_cast<float>(kCells)), kCells - 1);
      }
      cells[cell].extend(positions[corner]);
    }
  }
  std::vector<Box3f> boxes;
  for (const Box3f& box : cells) {
    if (!box.is_empty()) boxes.push_back(box);
  }
  return boxes;
}

Box3f bounds_at(std::span<const Box3f> boxes, const Mat3d& linear, const Vec3d& offset_m) {
  Vec3d low(static_cast<double>(kInfinity)), high(-static_cast<double>(kInfinity));
  const Mat3d sizes(glm::abs(linear[0]), glm::abs(linear[1]), glm::abs(linear[2]));
  for (const Box3f& box : boxes) {
    const Vec3d center = linear * (0.5 * (Vec3d(box.low) + Vec3d(box.high))) + offset_m;
    const Vec3d half = sizes * (0.5 * (Vec3d(box.high) - Vec3d(box.low)));
    low = glm::min(low, center - half);
    high = glm::max(high, center + half);
  }
  // Corners in the world are rounded to single precision, and so is the box.
  Box3f bounds;
  for (int axis = 0; axis < 3; ++axis) {
    bounds.low[axis] = std::nextafter(static_cast<float>(low[axis]), -kInfinity);
    bounds.high[axis] = std::nextafter(static_cast<float>(high[axis]), kInfinity);
  }
  return bounds;
}

}  // namespace abbe
