/// Which of many boxes overlap one.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <numeric>
#include <span>
#include <vector>

#include "abbe/math/ray.h"

namespace abbe {

inline bool overlap(const Box3f& a, const Box3f& b) {
  return glm::all(glm::lessThanEqual(a.low, b.high)) && glm::all(glm::lessThanEqual(b.low, a.high));
}

/// Boxes, which have to outlive it, in a tree that is halved at the middle of its longest side.
class BoxTree {
 public:
  void build(std::span<const Box3f> boxes) {
    boxes_ = boxes;
    nodes_.clear();
    order_.resize(boxes.size());
    std::iota(order_.begin(), order_.end(), 0u);
    if (!boxes_.empty()) build(0, boxes_.size());
  }

  /// Calls visit(number) for the boxes that overlap one.
  template <class Visit>
  void for_each_overlapping(const Box3f& box, const Visit& visit) const {
    std::array<std::uint32_t, 64> stack;
    std::size_t depth = 0;
    if (!nodes_.empty()) stack[depth++] = 0;
    while (depth > 0) {
      const Node& node = nodes_[stack[--depth]];
      if (!overlap(node.bounds, box)) continue;
      if (node.right == 0) {
        for (std::size_t i = node.begin; i < node.end; ++i) {
          if (overlap(boxes_[order_[i]], box)) visit(order_[i]);
        }
        continue;
      }
      stack[depth++] = node.right;
      stack[depth++] = static_cast<std::uint32_t>(&node - nodes_.data()) + 1;
    }
  }

 private:
  struct Node {
    Box3f bounds;
    std::uint32_t begin = 0, end = 0;
    std::uint32_t right = 0;  // The left child comes next; a leaf has 0.
  };
  static constexpr std::size_t kLeafBoxes = 8;

  std::uint32_t build(std::size_t begin, std::size_t end) {
    const auto number = static_cast<std::uint32_t>(nodes_.size());
    Node node;
    node.begin = static_cast<std::uint32_t>(begin);
    node.end = static_cast<std::uint32_t>(end);
    Box3f centers;
    for (std::size_t i = begin; i < end; ++i) {
      node.bounds.extend(boxes_[order_[i]]);
      centers.extend(boxes_[order_[i]].center());
    }
    nodes_.push_back(node);
    if (end - begin <= kLeafBoxes) return number;
    const Vec3f size = centers.size();
    const int axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
    const std::size_t middle = begin + (end - begin) / 2;
    const auto at = [&](std::size_t i) { return order_.begin() + static_cast<std::ptrdiff_t>(i); };
    std::nth_element(at(begin), at(middle), at(end), [&](std::uint32_t a, std::uint32_t b) {
      return boxes_[a].center()[axis] < boxes_[b].center()[axis];
    });
    build(begin, middle);
    nodes_[number].right = build(middle, end);
    return number;
  }

  std::span<const Box3f> boxes_;
  std::vector<std::uint32_t> order_;
  std::vector<Node> nodes_;
};

}  // namespace abbe
