#include "accel/kd_split.h"

#include <hwy/contrib/sort/vqsort.h>

#include <algorithm>
#include <array>

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

// The best split so far of one cell, and what rates another.
struct SplitFinder::Candidate {
  const KdTreeConfig& config;
  const Box3f& cell;
  std::size_t count;
  std::size_t max_added;
  std::size_t block_size;
  float solid_share;  // Of the references, taken to be the same on both sides of a plane.
  Vec3f size;
  float inverse_area;
  Split split;
  bool found = false;

  Candidate(const KdTreeConfig& c, const Box3f& box, std::size_t n, std::size_t added, float solids)
      : config(c),
        cell(box),
        count(n),
        max_added(added),
        block_size(std::max(c.block_size, 1u)),
        solid_share(solids),
        size(box.size()) {
    const float half_area = size.x * size.y + size.y * size.z + size.z * size.x;
    inverse_area = half_area > 0.0f ? 1.0f / half_area : 0.0f;
    split.cost = leaf_cost(n);
  }

  // A block of triangles costs as much as one of them, a solid as much as a block.
  float leaf_cost(std::size_t n) const {
    const auto blocks = static_cast<float>((n + block_size - 1) / block_size);
    return config.block_cost * std::max(blocks, solid_share * static_cast<float>(n));
  }

  void rate(int axis, float plane, std::size_t below, std::size_t above, bool planar_below) {
    if (!(plane > cell.low[axis] && plane < cell.high[axis])) return;
    if (below + above > count + max_added) return;
    const int u = axis == 2 ? 0 : axis + 1;
    const int v = axis == 0 ? 2 : axis - 1;
    const float side = size[u] * size[v];
    const float rim = size[u] + size[v];
    const float p_below = (side + (plane - cell.low[axis]) * rim) * inverse_area;
    const float p_above = (side + (cell.high[axis] - plane) * rim) * inverse_area;
    float cost = config.traversal_cost + p_below * leaf_cost(below) + p_above * leaf_cost(above);
    if (below == 0 || above == 0) cost *= 1.0f - config.empty_bonus;
    if (cost < split.cost) {
      split = {axis, plane, planar_below, cost};
      found = true;
    }
  }
};

void SplitFinder::search_binned(std::span<const BuildReference> references, Candidate& best) const {
  const auto bin_count = static_cast<int>(std::clamp(config_.bins, 2u, kMaxBins));
  std::array<float, 3> low, high, scale;
  for (std::size_t k = 0; k < 3; ++k) {
    low[k] = kInfinity;
    high[k] = -kInfinity;
    for (const BuildReference& r : references) {
      low[k] = std::min(low[k], r.low[k]);
      high[k] = std::max(high[k], r.high[k]);
    }
    scale[k] = high[k] > low[k] ? static_cast<float>(bin_count) / (high[k] - low[k]) : 0.0f;
  }
  std::array<AxisBins, 3> bins;
  for (const BuildReference& r : references) {
    for (std::size_t k = 0; k < 3; ++k) {
      const int start = static_cast<int>((r.low[k] - low[k]) * scale[k]);
      const int end = static_cast<int>((r.high[k] - low[k]) * scale[k]);
      ++bins[k].starts[static_cast<std::size_t>(std::clamp(start, 0, bin_count - 1))];
      ++bins[k].ends[static_cast<std::size_t>(std::clamp(end, 0, bin_count - 1))];
    }
  }
  for (std::size_t k = 0; k < 3; ++k) {
    const int axis = static_cast<int>(k);
    best.rate(axis, low[k], 0, references.size(), false);
    best.rate(axis, high[k], references.size(), 0, true);
    if (scale[k] == 0.0f) continue;
    std::size_t below = 0;
    std::size_t above = references.size();
    for (std::size_t b = 1; b < static_cast<std::size_t>(bin_count); ++b) {
      below += bins[k].starts[b - 1];
      above -= bins[k].ends[b - 1];
      best.rate(axis, low[k] + static_cast<float>(b) / scale[k], below, above, true);
    }
  }
}

void SplitFinder::search_exact(std::span<const BuildReference> references, int axis,
                               Candidate& best) {
  const std::size_t n = references.size();
  lows_.resize(n);
  highs_.resize(n);
  planar_.clear();
  for (std::size_t i = 0; i < n; ++i) {
    lows_[i] = references[i].low[axis];
    highs_[i] = references[i].high[axis];
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
    best.rate(axis, plane, below + in_plane, above, true);
    if (in_plane > 0) best.rate(axis, plane, below, above + in_plane, false);
  }
}

std::optional<Split> SplitFinder::find(std::span<const BuildReference> references,
                                       const Box3f& cell, std::size_t max_added) {
  if (references.size() <= config_.leaf_size) return std::nullopt;
  const auto solids =
      std::count_if(references.begin(), references.end(),
                    [&](const BuildReference& r) { return r.primitive >= triangle_count_; });
  const float share = references.empty()
                          ? 0.0f
                          : static_cast<float>(solids) / static_cast<float>(references.size());
  Candidate best(config_, cell, references.size(), max_added, share);
  if (references.size() > config_.exact_limit) {
    search_binned(references, best);
  } else {
    for (int axis = 0; axis < 3; ++axis) search_exact(references, axis, best);
  }
  if (!best.found) return std::nullopt;
  return best.split;
}

}  // namespace abbe
