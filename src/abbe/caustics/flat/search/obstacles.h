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

  /// Marks the segments of a chain on which nothing can stand: they need not be asked about. The
  /// first one comes from a lamp, and stays as it is. Marks the facets on which something may lie
  /// that chains do not lead through, and says how far places on them may be off by rounding.
  /// Domain: a chain that has its origin.
  void mark(ChainPath& chain);

 private:
  /// The box of a facet and of what follows of its face.
  Box3d box_of_face(std::uint32_t facet) const;
  bool may_be_touched(std::uint32_t facet);
  bool may_stand_between(std::uint32_t facet, std::uint32_t other);

  const FlatBodies& flat_;
  std::vector<Box3d> boxes_;    ///< By instance.
  std::vector<bool> is_glass_;  ///< By instance: glass that chains lead through.
  std::unordered_map<std::uint64_t, bool> known_;
  std::unordered_map<std::uint32_t, bool> known_touched_;
};

}  // namespace abbe
