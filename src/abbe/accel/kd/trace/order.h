/// The order in which a ray meets the children of a wide node.
#pragma once

#include <cstdint>

namespace abbe {

/// For each set of planes whose upper side comes first (bit p for plane p) the eight children, the
/// farthest first.
struct ChildOrder {
  alignas(64) std::uint8_t order[128][8]{};

  constexpr ChildOrder() {
    for (unsigned flips = 0; flips < 128; ++flips) {
      for (unsigned i = 0; i < 8; ++i) {
        const unsigned s0 = (i >> 2) ^ (flips & 1u);
        const unsigned s1 = (i >> 1 & 1u) ^ (flips >> (1 + s0) & 1u);
        const unsigned s2 = (i & 1u) ^ (flips >> (3 + 2 * s0 + s1) & 1u);
        order[flips][7 - i] = static_cast<std::uint8_t>(4 * s0 + 2 * s1 + s2);
      }
    }
  }
};
inline constexpr ChildOrder kChildOrder;

}  // namespace abbe
