/// Which primitives a query sees.
#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

#include "abbe/accel/shapes.h"

namespace abbe {

/// The masks of a world's primitives, kept only where they differ.
class Visibility {
 public:
  /// Of a world without primitives.
  Visibility() = default;
  explicit Visibility(const ShapeSpans& shapes) : any_(kAllBits) {
    if (shapes.masks.empty()) return;
    any_ = 0;
    bool is_uniform = true;
    for (const VisibilityMask mask : shapes.masks) {
      any_ = static_cast<VisibilityMask>(any_ | mask);
      is_uniform = is_uniform && mask == shapes.masks.front();
      all_have_bits_ = all_have_bits_ && mask != 0;
    }
    if (!is_uniform) masks_.assign(shapes.masks.begin(), shapes.masks.end());
  }

  /// Whether a query with this mask sees any primitive, and whether it sees all.
  bool sees_any(QueryMask mask) const { return (any_ & mask) != 0; }
  bool sees_all(QueryMask mask) const { return all_have_bits_ && (any_ & mask) == any_; }

  VisibilityMask of(std::uint32_t primitive) const {
    return masks_.empty() ? any_ : masks_[primitive];
  }
  /// One per primitive; null where all are alike.
  const VisibilityMask* masks() const { return masks_.empty() ? nullptr : masks_.data(); }
  std::size_t bytes() const { return masks_.size(); }

 private:
  std::vector<VisibilityMask> masks_;
  VisibilityMask any_ = 0;
  bool all_have_bits_ = true;
};

}  // namespace abbe
