#include "abbe/caustics/flat/chain_index.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numeric>

namespace abbe {
namespace {

// Lists this short are read faster than they are split, and cells no smaller than this.
constexpr std::uint32_t kShortList = 12;
constexpr int kMaxDepth = 6;
// What lists may take in all: 64 MiB.
constexpr std::size_t kMaxNumbers = std::size_t{1} << 24;

}  // namespace

ChainIndex::ChainIndex(const Box3f& bounds, std::uint32_t chains, const MayLight& may_light) {
  numbers_.resize(chains);
  std::iota(numbers_.begin(), numbers_.end(), 0u);
  const Vec3f size = bounds.is_empty() ? Vec3f(0.0f) : bounds.size();
  const float half_m = 0.5f * std::max({size.x, size.y, size.z});
  const Vec3f center = bounds.is_empty() ? Vec3f(0.0f) : bounds.center();
  cells_.push_back({center, half_m, 0, chains, 0});
  split(0, 0, may_light);
}

void ChainIndex::split(std::uint32_t number, int depth, const MayLight& may_light) {
  const Cell cell = cells_[number];
  const auto size = cell.last - cell.first;
  if (size <= kShortList || depth == kMaxDepth || !(cell.half_m > 0.0f)) return;
  if (numbers_.size() + std::size_t{8} * size > kMaxNumbers) return;
  const auto children = static_cast<std::uint32_t>(cells_.size());
  const float half_m = 0.5f * cell.half_m;
  std::size_t kept = 0;
  for (int octant = 0; octant < 8; ++octant) {
    const Vec3f side((octant & 1) != 0 ? 1.0f : -1.0f, (octant & 2) != 0 ? 1.0f : -1.0f,
                     (octant & 4) != 0 ? 1.0f : -1.0f);
    Cell child{cell.center + half_m * side, half_m, static_cast<std::uint32_t>(numbers_.size()), 0,
               0};
    // Twice as large as the octant.
    const float radius_m = 2.0f * std::sqrt(3.0f) * half_m * 1.00001f;
    for (std::uint32_t i = cell.first; i < cell.last; ++i) {
      const std::uint32_t chain = numbers_[i];
      if (may_light(chain, child.center, radius_m)) numbers_.push_back(chain);
    }
    child.last = static_cast<std::uint32_t>(numbers_.size());
    kept += child.last - child.first;
    cells_.push_back(child);
  }
  // Where nearly all of it lights everything, smaller cells do not help.
  if (kept > std::size_t{8} * size * 9 / 10) {
    cells_.resize(children);
    numbers_.resize(numbers_.size() - kept);
    return;
  }
  cells_[number].children = children;
  for (std::uint32_t i = 0; i < 8; ++i) split(children + i, depth + 1, may_light);
}

std::span<const std::uint32_t> ChainIndex::near(const Vec3f& center, float radius_m) const {
  if (cells_.empty()) return {};
  const Cell* cell = &cells_[0];
  const Vec3f off = glm::abs(center - cell->center);
  const bool is_inside = std::max({off.x, off.y, off.z}) <= cell->half_m;
  // A child holds balls about places of its octant that are no larger than half of it.
  while (is_inside && cell->children != 0 && radius_m <= 0.5f * cell->half_m) {
    const std::uint32_t octant = (center.x > cell->center.x ? 1u : 0u) |
                                 (center.y > cell->center.y ? 2u : 0u) |
                                 (center.z > cell->center.z ? 4u : 0u);
    cell = &cells_[cell->children + octant];
  }
  return std::span(numbers_).subspan(cell->first, cell->last - cell->first);
}

}  // namespace abbe
