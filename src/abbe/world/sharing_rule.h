/// When instances of a mesh share its data.
#pragma once

#include <cstddef>

namespace abbe {

/// When the instances of a mesh share its data instead of having their own.
struct SharingRule {
  /// They do where that saves so many triangles. With few, a tree over all is faster, and knows
  /// which primitives touch.
  std::size_t least_saved_triangles = 1u << 18;
  /// A place takes as much memory as so many triangles.
  std::size_t least_triangles = 32;
};

}  // namespace abbe
