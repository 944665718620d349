#include "abbe/accel/instances/tree.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>
#include <vector>

namespace abbe {
namespace {

constexpr std::size_t kChildren = 8;
constexpr std::size_t kBins = 16;
// Deeper nodes split at the middle, so that the tree ends.
constexpr std::size_t kDepthOfBins = 12;

double area(const Box3f& box) {
  if (box.is_empty()) return 0.0;
  const Vec3d s(box.size());
  return s.x * s.y + s.y * s.z + s.z * s.x;
}

class Builder {
 public:
  explicit Builder(std::span<const Box3f> boxes) : boxes_(boxes), order_(boxes.size()) {
    std::iota(order_.begin(), order_.end(), 0u);
    build(range(0, boxes.size()), 0);
  }

  const std::vector<PlaceNode>& nodes() const { return nodes_; }
  std::size_t depth() const { return depth_; }

 private:
  struct Range {
    std::size_t begin, end;
    Box3f bounds;
    std::size_t size() const { return end - begin; }
  };

  Range range(std::size_t begin, std::size_t end) const {
    Range made{begin, end, {}};
    for (std::size_t i = begin; i < end; ++i) made.bounds.extend(boxes_[order_[i]]);
    return made;
  }

  // Splits what costs most until there are eight parts.
  std::uint32_t build(const Range& all, std::size_t depth) {
    depth_ = std::max(depth_, depth + 1);
    std::vector<Range> parts{all};
    while (parts.size() < kChildren) {
      std::size_t costliest = parts.size();
      double most = -1.0;
      for (std::size_t i = 0; i < parts.size(); ++i) {
        const double cost = area(parts[i].bounds) * static_cast<double>(parts[i].size());
        if (parts[i].size() > 1 && cost > most) {
          most = cost;
          costliest = i;
        }
      }
      if (costliest == parts.size()) break;
      const Range part = parts[costliest];
      const std::size_t middle = split(part, depth);
      parts[costliest] = range(part.begin, middle);
      parts.push_back(range(middle, part.end));
    }
    const auto number = static_cast<std::uint32_t>(nodes_.size());
    PlaceNode& node = nodes_.emplace_back(PlaceNode{});
    node.count = static_cast<std::uint32_t>(parts.size());
    for (std::size_t i = 0; i < parts.size(); ++i) {
      for (int axis = 0; axis < 3; ++axis) {
        node.low[axis][i] = parts[i].bounds.low[axis];
        node.high[axis][i] = parts[i].bounds.high[axis];
      }
    }
    for (std::size_t i = 0; i < parts.size(); ++i) {
      const PlaceChild child =
          parts[i].size() == 1 ? kPlaceBit | order_[parts[i].begin] : build(parts[i], depth + 1);
      nodes_[number].children[i] = child;
    }
    return number;
  }

  // Where the surface-area heuristic divides a range into two, of which none is empty.
  std::size_t split(const Range& part, std::size_t depth) {
    Box3f centers;
    for (std::size_t i = part.begin; i < part.end; ++i) {
      centers.extend(boxes_[order_[i]].center());
    }
    const Vec3f size = centers.size();
    const int axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
    const auto at = [&](std::size_t i) { return order_.begin() + static_cast<std::ptrdiff_t>(i); };
    const auto center = [&](std::uint32_t box) { return boxes_[box].center()[axis]; };
    if (depth < kDepthOfBins && size[axis] > 0.0f && part.size() > 2) {
      const float scale = static_cast<float>(kBins) / size[axis];
      const auto bin_of = [&](std::uint32_t box) {
        const auto bin = static_cast<std::size_t>((center(box) - centers.low[axis]) * scale);
        return std::min(bin, kBins - 1);
      };
      std::array<Box3f, kBins> bounds;
      std::array<std::size_t, kBins> counts{};
      for (std::size_t i = part.begin; i < part.end; ++i) {
        const std::size_t bin = bin_of(order_[i]);
        bounds[bin].extend(boxes_[order_[i]]);
        ++counts[bin];
      }
      std::array<double, kBins> below{};
      Box3f box;
      std::size_t count = 0;
      for (std::size_t i = 0; i + 1 < kBins; ++i) {
        box.extend(bounds[i]);
        count += counts[i];
        below[i] = area(box) * static_cast<double>(count);
      }
      box = {};
      count = 0;
      std::size_t best = 0;
      double least = std::numeric_limits<double>::infinity();
      for (std::size_t i = kBins - 1; i > 0; --i) {
        box.extend(bounds[i]);
        count += counts[i];
        const double cost = below[i - 1] + area(box) * static_cast<double>(count);
        if (count > 0 && count < part.size() && cost < least) {
          least = cost;
          best = i;
        }
      }
      if (best > 0) {
        const auto middle = std::partition(at(part.begin), at(part.end),
                                           [&](std::uint32_t i) { return bin_of(i) < best; });
        return static_cast<std::size_t>(middle - order_.begin());
      }
    }
    const std::size_t middle = part.begin + part.size() / 2;
    std::nth_element(at(part.begin), at(middle), at(part.end),
                     [&](std::uint32_t a, std::uint32_t b) { return center(a) < center(b); });
    return middle;
  }

  std::span<const Box3f> boxes_;
  std::vector<std::uint32_t> order_;
  std::vector<PlaceNode> nodes_;
  std::size_t depth_ = 0;
};

}  // namespace

PlaceTree::PlaceTree(std::span<const Box3f> boxes) {
  for (const Box3f& box : boxes) bounds_.extend(box);
  const Builder builder(boxes);
  nodes_ = FlatArray<PlaceNode>(builder.nodes().size());
  std::copy(builder.nodes().begin(), builder.nodes().end(), nodes_.data());
  stack_entries_ = builder.depth() * (kChildren - 1) + kChildren + 1;
}

PlaceBeam beam_of(const Box3f& origins, const Box3f& directions, float reach_m) {
  constexpr float kMax = std::numeric_limits<float>::max();
  constexpr float kSlowest = std::numeric_limits<float>::min();
  const Vec3f far = glm::max(glm::abs(origins.low), glm::abs(origins.high));
  // A ray that is moved into a mesh's space is rounded there by one part in 2^24 of the way.
  const float slack_m =
      4.0f * std::numeric_limits<float>::epsilon() * (std::max({far.x, far.y, far.z}) + reach_m);
  PlaceBeam beam;
  for (int axis = 0; axis < 3; ++axis) {
    beam.origin_low[axis] = origins.low[axis] - slack_m;
    beam.origin_high[axis] = origins.high[axis] + slack_m;
    const float slowest = directions.low[axis];
    const float fastest = directions.high[axis];
    beam.enter_low[axis] = fastest > kSlowest ? 1.0f / fastest : kMax;
    beam.enter_high[axis] = slowest < -kSlowest ? 1.0f / slowest : -kMax;
    beam.leave_high[axis] = slowest > kSlowest ? 1.0f / slowest : 0.0f;
    beam.leave_low[axis] = fastest < -kSlowest ? 1.0f / fastest : 0.0f;
  }
  return beam;
}

Ray moved(const Mat3d& linear, const Vec3d& offset, const Ray& ray) {
  Ray to;
  to.t_max = ray.t_max;
  to.origin = Vec3f(linear * Vec3d(ray.origin) + offset);
  to.direction = Vec3f(linear * Vec3d(ray.direction));
  return to;
}

}  // namespace abbe
