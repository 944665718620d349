#include "abbe/accel/kd/build/split.h"

#include <hwy/contrib/sort/vqsort.h>

#include <algorithm>
#include <array>

#include "abbe/accel/kd/build/few_split.h"

namespace abbe {
namespace {

constexpr std::uint32_t kMaxBins = 256;

struct AxisBins {
  std::array<std::uint32_t, kMaxBins> starts{}, ends{};
};

void sort_floats(std::vector<float>& values) {
  if (values.size() < 16) {
    std::sort(values.begin(), values.end());
  } else {
    static thread_local hwy::Sorter sorter;
    sorter(values.data(), values.size(), hwy::SortAscending());
  }
}

}  // namespace

void SplitFinder::search_binned(std::span<const BuildPrimitive> primitives, SahCell& cell) const {
  const auto bin_count = static_cast<int>(std::clamp(config_.bins, 2u, kMaxBins));
  std::array<float, 3> low, high, scale;
  for (std::size_t k = 0; k < 3; ++k) {
    low[k] = kInfinity;
    high[k] = -kInfinity;
    for (const BuildPrimitive& p : primitives) {
      low[k] = std::min(low[k], p.low[k]);
      high[k] = std::max(high[k], p.high[k]);
    }
    scale[k] = high[k] > low[k] ? static_cast<float>(bin_count) / (high[k] - low[k]) : 0.0f;
  }
  std::array<AxisBins, 3> bins;
  for (const BuildPrimitive& p : primitives) {
    for (std::size_t k = 0; k < 3; ++k) {
      const int start = static_cast<int>((p.low[k] - low[k]) * scale[k]);
      const int end = static_cast<int>((p.high[k] - low[k]) * scale[k]);
      ++bins[k].starts[static_cast<std::size_t>(std::clamp(start, 0, bin_count - 1))];
      ++bins[k].ends[static_cast<std::size_t>(std::clamp(end, 0, bin_count - 1))];
    }
  }
  for (std::size_t k = 0; k < 3; ++k) {
    const int axis = static_cast<int>(k);
    cell.rate(axis, low[k], 0, primitives.size(), false);
    cell.rate(axis, high[k], primitives.size(), 0, true);
    if (scale[k] == 0.0f) continue;
    std::size_t below = 0;
    std::size_t above = primitives.size();
    for (std::size_t b = 1; b < static_cast<std::size_t>(bin_count); ++b) {
      below += bins[k].starts[b - 1];
      above -= bins[k].ends[b - 1];
      cell.rate(axis, low[k] + static_cast<float>(b) / scale[k], below, above, true);
    }
  }
}

void SplitFinder::search_exact(std::span<const BuildPrimitive> primitives, int axis,
                               SahCell& cell) {
  const std::size_t n = primitives.size();
  lows_.resize(n);
  highs_.resize(n);
  planar_.clear();
  for (std::size_t i = 0; i < n; ++i) {
    lows_[i] = primitives[i].low[axis];
    highs_[i] = primitives[i].high[axis];
    if (lows_[i] == highs_[i]) planar_.push_back(lows_[i]);
  }
  sort_floats(lows_);
  sort_floats(highs_);
  sort_floats(planar_);
  std::size_t next_low = 0, next_high = 0, next_planar = 0;
  while (next_low < n || next_high < n) {
    const float plane =
        next_low < n ? std::min(lows_[next_low], highs_[next_high]) : highs_[next_high];
    const std::size_t below = next_low;  // Those that start before the plane.
    while (next_low < n && lows_[next_low] == plane) ++next_low;
    while (next_high < n && highs_[next_high] == plane) ++next_high;
    const std::size_t first_planar = next_planar;
    while (next_planar < planar_.size() && planar_[next_planar] == plane) ++next_planar;
    const std::size_t in_plane = next_planar - first_planar;
    const std::size_t above = n - next_high;  // Those that end behind it.
    cell.rate(axis, plane, below + in_plane, above, true);
    if (in_plane > 0) cell.rate(axis, plane, below, above + in_plane, false);
  }
}

std::optional<Split> SplitFinder::find(std::span<const BuildPrimitive> primitives,
                                       const Box3f& cell, std::size_t max_added) {
  if (primitives.size() <= config_.leaf_size) return std::nullopt;
  const auto solids =
      std::count_if(primitives.begin(), primitives.end(),
                    [&](const BuildPrimitive& p) { return p.primitive >= triangle_count_; });
  const float share = primitives.empty()
                          ? 0.0f
                          : static_cast<float>(solids) / static_cast<float>(primitives.size());
  SahCell sah(config_, cell, primitives.size(), max_added, share);
  if (primitives.size() > config_.exact_limit) {
    search_binned(primitives, sah);
  } else if (primitives.size() <= kFewPrimitives) {
    search_few(primitives, sah);
  } else {
    for (int axis = 0; axis < 3; ++axis) search_exact(primitives, axis, sah);
  }
  if (!sah.found) return std::nullopt;
  return sah.best;
}

}  // namespace abbe
