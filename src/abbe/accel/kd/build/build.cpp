#include "abbe/accel/kd/build/build.h"

#include <oneapi/tbb/parallel_invoke.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <utility>

#include "abbe/accel/kd/build/primitives.h"
#include "abbe/accel/kd/build/sharing.h"
#include "abbe/accel/kd/build/split.h"
#include "abbe/accel/kd/layout.h"
#include "abbe/base/parallel.h"

namespace abbe {
namespace {

// Cells with more primitives are split into parallel tasks, each with memory of its own.
constexpr std::size_t kTaskLimit = 8192;
// A leaf of sixteen triangles seldom shares sixteen vertices; one of fourteen mostly does, if
// three or more triangles meet in each.
constexpr std::uint32_t kSharedBlockTriangles = 14;
constexpr double kSharingTriangles = 3.0;
// Small scenes may duplicate freely: so many primitives cost 40 MB.
constexpr std::size_t kFreePrimitives = std::size_t{1} << 20;

struct Job {
  Box3f cell;
  std::uint32_t depth = 0;
  std::size_t added_budget = 0;  ///< Primitives this subtree may have beyond those it begins with.
};

// The jobs of both sides, still without a budget.
std::pair<Job, Job> split_job(const Job& job, const Split& split) {
  Job low{job.cell, job.depth + 1, 0};
  Job high = low;
  low.cell.high[split.axis] = split.plane;
  high.cell.low[split.axis] = split.plane;
  return {low, high};
}

// Shares what is left of the budget of a cell with `count` parts between its sides by theirs.
void share_budget(const Job& job, std::size_t count, std::size_t below, std::size_t above,
                  std::pair<Job, Job>& sides) {
  const std::size_t total = below + above;
  const std::size_t added = total > count ? total - count : 0;
  const std::size_t left = job.added_budget > added ? job.added_budget - added : 0;
  sides.first.added_budget =
      static_cast<std::size_t>(static_cast<double>(left) * static_cast<double>(below) /
                               static_cast<double>(std::max<std::size_t>(total, 1)));
  sides.second.added_budget = left - sides.first.added_budget;
}

/// Builds one subtree on one thread, its primitives on one stack.
class SubtreeBuilder {
 public:
  SubtreeBuilder(const ShapeSpans& shapes, const KdTreeConfig& config)
      : shapes_(shapes), config_(config), finder_(shapes, config) {}

  BuildTree build(std::vector<BuildPrimitive> primitives, const Job& job) {
    stack_ = std::move(primitives);
    build_range(0, job);
    return std::move(tree_);
  }

 private:
  // Builds the subtree of the primitives from `first` to the top of the stack.
  std::uint32_t build_range(std::size_t first, const Job& job) {
    const std::size_t count = stack_.size() - first;
    const auto index = static_cast<std::uint32_t>(tree_.nodes.size());
    tree_.nodes.emplace_back();
    std::optional<Split> split;
    if (job.depth < config_.max_depth) {
      split = finder_.find({stack_.data() + first, count}, job.cell, job.added_budget);
    }
    if (!split) {
      tree_.nodes[index].first = static_cast<std::uint32_t>(tree_.primitives.size());
      tree_.nodes[index].second = static_cast<std::uint32_t>(count);
      for (std::size_t i = first; i < stack_.size(); ++i) {
        tree_.primitives.push_back(stack_[i].primitive);
      }
      return index;
    }
    // Those below stay, packed at the front; those above go on top and are built first.
    auto sides = split_job(job, *split);
    std::size_t kept = first;
    for (std::size_t i = first; i < first + count; ++i) {
      const BuildPrimitive p = stack_[i];
      const bool below = split->goes_below(p);
      const bool above = split->goes_above(p);
      if (below && above) {
        BuildPrimitive part = p;
        if (clip_to_cell(shapes_, sides.second.cell, part)) stack_.push_back(part);
        part = p;
        if (clip_to_cell(shapes_, sides.first.cell, part)) stack_[kept++] = part;
      } else if (above) {
        stack_.push_back(p);
      } else {
        stack_[kept++] = p;
      }
    }
    share_budget(job, count, kept - first, stack_.size() - (first + count), sides);
    const std::uint32_t high = build_range(first + count, sides.second);
    stack_.resize(kept);
    const std::uint32_t low = build_range(first, sides.first);
    tree_.nodes[index] = {static_cast<std::uint32_t>(split->axis), split->plane, low, high};
    return index;
  }

  const ShapeSpans& shapes_;
  const KdTreeConfig& config_;
  SplitFinder finder_;
  std::vector<BuildPrimitive> stack_;
  BuildTree tree_;
};

/// The upper part of the tree while its subtrees are built in parallel.
struct Branch {
  Split split;
  std::unique_ptr<Branch> below, above;  ///< Both null: `subtree` has it all.
  BuildTree subtree;
};

std::unique_ptr<Branch> build_branch(const ShapeSpans& shapes, const KdTreeConfig& config,
                                     std::vector<BuildPrimitive> primitives, const Job& job) {
  auto branch = std::make_unique<Branch>();
  std::optional<Split> split;
  if (primitives.size() > kTaskLimit && job.depth < config.max_depth) {
    split = SplitFinder(shapes, config).find(primitives, job.cell, job.added_budget);
  }
  if (!split) {
    branch->subtree = SubtreeBuilder(shapes, config).build(std::move(primitives), job);
    return branch;
  }
  auto sides = split_job(job, *split);
  std::vector<BuildPrimitive> low, high;
  for (const BuildPrimitive& p : primitives) {
    const bool below = split->goes_below(p);
    const bool above = split->goes_above(p);
    BuildPrimitive part = p;
    if (below && (!above || clip_to_cell(shapes, sides.first.cell, part))) low.push_back(part);
    part = p;
    if (above && (!below || clip_to_cell(shapes, sides.second.cell, part))) high.push_back(part);
  }
  share_budget(job, primitives.size(), low.size(), high.size(), sides);
  std::vector<BuildPrimitive>().swap(primitives);
  branch->split = *split;
  oneapi::tbb::parallel_invoke(
      [&] { branch->below = build_branch(shapes, config, std::move(low), sides.first); },
      [&] { branch->above = build_branch(shapes, config, std::move(high), sides.second); });
  return branch;
}

std::uint32_t append_branch(const Branch& branch, BuildTree& tree) {
  const auto index = static_cast<std::uint32_t>(tree.nodes.size());
  if (branch.below == nullptr) {
    const auto first_primitive = static_cast<std::uint32_t>(tree.primitives.size());
    for (BuildNode node : branch.subtree.nodes) {
      if (node.axis == BuildNode::kLeaf) {
        node.first += first_primitive;
      } else {
        node.first += index;
        node.second += index;
      }
      tree.nodes.push_back(node);
    }
    tree.primitives.insert(tree.primitives.end(), branch.subtree.primitives.begin(),
                           branch.subtree.primitives.end());
    return index;
  }
  tree.nodes.emplace_back();
  const std::uint32_t low = append_branch(*branch.below, tree);
  const std::uint32_t high = append_branch(*branch.above, tree);
  tree.nodes[index] = {static_cast<std::uint32_t>(branch.split.axis), branch.split.plane, low,
                       high};
  return index;
}

}  // namespace

BuildTree build_kd_tree(const ShapeSpans& shapes, const KdTreeConfig& given_config) {
  KdTreeConfig config = given_config;
  config.max_depth = std::min(config.max_depth, kMaxTreeDepth);
  if (config.block_size == 0) {
    config.block_size =
        triangles_per_vertex(shapes) < kSharingTriangles ? kBlockTriangles : kSharedBlockTriangles;
  }
  const std::size_t count = shapes.primitive_count();
  std::vector<BuildPrimitive> primitives(count);
  parallel_for(0, count, 4096, [&](std::size_t i) {
    primitives[i] = make_build_primitive(shapes, static_cast<std::uint32_t>(i));
  });
  BuildTree tree;
  for (const BuildPrimitive& p : primitives) {
    tree.bounds.extend(Vec3f(p.low[0], p.low[1], p.low[2]));
    tree.bounds.extend(Vec3f(p.high[0], p.high[1], p.high[2]));
  }
  if (count == 0) {
    tree.nodes.emplace_back();
    return tree;
  }
  const double allowed =
      std::max(static_cast<double>(config.max_build_primitives) * static_cast<double>(count),
               static_cast<double>(kFreePrimitives));
  const Job job{tree.bounds, 0,
                static_cast<std::size_t>(std::max(allowed - static_cast<double>(count), 0.0))};
  const auto root = build_branch(shapes, config, std::move(primitives), job);
  append_branch(*root, tree);
  return tree;
}

}  // namespace abbe
