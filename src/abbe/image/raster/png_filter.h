/// The five filters of PNG rows. Source: W3C, PNG Specification (Third Edition), 9.
#pragma once

#include <cstdlib>

namespace abbe {

/// What a filter expects a byte to be, from those to the left, above, and above to the left.
template <int kFilter>
int png_prediction(int left, int above, int corner) {
  if constexpr (kFilter == 0) return 0;
  if constexpr (kFilter == 1) return left;
  if constexpr (kFilter == 2) return above;
  if constexpr (kFilter == 3) return (left + above) / 2;
  // Paeth: the one that is nearest to left + above - corner.
  const int to_left = std::abs(above - corner);
  const int to_above = std::abs(left - corner);
  const int to_corner = std::abs(left + above - 2 * corner);
  if (to_left <= to_above && to_left <= to_corner) return left;
  return to_above <= to_corner ? above : corner;
}

}  // namespace abbe
