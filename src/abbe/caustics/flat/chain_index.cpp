#include "abbe/caustics/flat/chain_index.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace abbe {
namespace {

// Lists this short are read faster than they are split.
constexpr std::size_t kShortList = 4;
// A cell is split once so many places in it were asked about: what that costs is a share of what
// they did.
constexpr std::uint32_t kOften = 8;
// From a scene that is 16 km wide to a millimetre.
constexpr int kMaxDepth = 24;
// What lists and cells may take in all: 64 MiB or so.
constexpr std::size_t kMaxKept = std::size_t{1} << 24;
constexpr std::size_t kKeptByCell = 48;

}  // namespace

ChainIndex::Cell::~Cell() {
  for (std::atomic<Cell*>& child : children) delete child.load(std::memory_order_relaxed);
}

ChainIndex::ChainIndex(const Box3f& bounds, std::vector<std::uint32_t> chains, float room,
                       std::size_t sharers)
    : tree_(std::make_unique<Tree>()), room_(room), most_kept_(kMaxKept / sharers) {
  Cell& root = tree_->root;
  root.own = std::move(chains);
  root.numbers = root.own;
  if (bounds.is_empty()) return;
  const Vec3f size = bounds.size();
  root.center = bounds.center();
  root.half_m = 0.5f * std::max({size.x, size.y, size.z});
}

std::span<const std::uint32_t> ChainIndex::near(const Vec3f& center, float radius_m,
                                                const MayLight& may_light) const {
  if (!tree_) return {};
  Cell* cell = &tree_->root;
  const Vec3f off = glm::abs(center - cell->center);
  if (!(std::max({off.x, off.y, off.z}) <= cell->half_m)) return cell->numbers;
  while (cell->numbers.size() > kShortList && radius_m <= 0.5f * room_ * cell->half_m) {
    const std::size_t octant = (center.x > cell->center.x ? 1u : 0u) |
                               (center.y > cell->center.y ? 2u : 0u) |
                               (center.z > cell->center.z ? 4u : 0u);
    Cell* next = cell->children[octant].load(std::memory_order_acquire);
    if (next == nullptr) next = child(*cell, octant, may_light);
    if (next == nullptr) break;
    cell = next;
  }
  return cell->numbers;
}

ChainIndex::Cell* ChainIndex::child(Cell& cell, std::size_t octant,
                                    const MayLight& may_light) const {
  if (cell.depth == kMaxDepth) return nullptr;
  if (cell.times_asked.fetch_add(1, std::memory_order_relaxed) < kOften) return nullptr;
  if (tree_->kept.load(std::memory_order_relaxed) > most_kept_) return nullptr;
  auto made = std::make_unique<Cell>();
  made->depth = cell.depth + 1;
  made->half_m = 0.5f * cell.half_m;
  const Vec3f side((octant & 1) != 0 ? 1.0f : -1.0f, (octant & 2) != 0 ? 1.0f : -1.0f,
                   (octant & 4) != 0 ? 1.0f : -1.0f);
  made->center = cell.center + made->half_m * side;
  const float radius_m = (std::sqrt(3.0f) + room_) * made->half_m * 1.00001f;
  for (const std::uint32_t number : cell.numbers) {
    if (may_light(number, made->center, radius_m)) made->own.push_back(number);
  }
  // A list that is hardly shorter is not kept twice.
  if (made->own.size() > cell.numbers.size() / 8 * 7) {
    made->own = {};
    made->numbers = cell.numbers;
  } else {
    made->own.shrink_to_fit();
    made->numbers = made->own;
  }
  Cell* known = nullptr;
  if (!cell.children[octant].compare_exchange_strong(known, made.get(), std::memory_order_release,
                                                     std::memory_order_acquire)) {
    return known;
  }
  tree_->kept.fetch_add(made->own.size() + kKeptByCell, std::memory_order_relaxed);
  return made.release();
}

}  // namespace abbe
