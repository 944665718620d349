/// Whether anything may stand between facets.
#pragma once

#include <cstdint>
#include <unordered_map>
#include <vector>

#include "abbe/caustics/flat/bodies.h"
#include "abbe/caustics/flat/chain.h"
#include "abbe/scene/scene.h"

namespace abbe {

/// Answers by the boxes of all objects; remembers what it was asked.
class Obstacles {
 public:
  Obstacles(const Scene& scene, const FlatBodies& flat);

  /// Marks the segments of a path on which nothing can stand: they need not be asked about. The
  /// first one comes from a lamp, and stays as it is.
  void mark(std::vector<ChainStep>& steps);

 private:
  bool may_stand_between(std::uint32_t facet, std::uint32_t other);

  const FlatBodies& flat_;
  std::vector<Box3d> boxes_;  ///< By instance.
  std::unordered_map<std::uint64_t, bool> known_;
};

}  // namespace abbe
