/// Which paths light takes over flat facets, and how much of it: rays of a lamp, followed one by
/// one, find those that matter.
#pragma once

#include <cstdint>
#include <vector>

#include "abbe/caustics/flat/search/chain_search.h"
#include "abbe/caustics/flat/search/regions.h"
#include "abbe/math/lane_mask.h"

namespace abbe {

/// The last step of a path; those before it are its ancestors.
struct PathNode {
  std::uint32_t place = 0;  ///< A facet or, of lamps, a face.
  ChainEvent event = ChainEvent::Enter;
  Region region;        ///< In which light goes on.
  double flux = 0.0;    ///< Light that took it: lumens over the intensity of the lamp.
  double sent = 0.0;    ///< The same before it lost any on its way.
  double useful = 0.0;  ///< Of it, what may light something, behind this step or later.
  std::uint32_t rays = 0;
  std::vector<std::uint32_t> children = {};
  LaneMask lanes = {};  ///< That are followed over it.
};

/// The paths of one light. Node 0 is the lamp.
struct PathTree {
  std::vector<PathNode> nodes;
  double started = 0.0;  ///< Light that fell on facets.
  double cut = 0.0;      ///< Of it, what would have lit something on paths that are left out.
  std::vector<BodyLight> by_body = {};

  /// The child of a node by what happens where; none: 0.
  std::uint32_t child(std::uint32_t node, std::uint32_t place, ChainEvent event) const;
};

/// Follows rays of a lamp over the facets, their light split at each; more of them until what lies
/// on paths that none has taken is little. Keeps the paths that carry most light: as many as it
/// takes to leave little out, if they are not too many. Of few wavelengths each has paths of its
/// own; light is the mean over them then. Shape:  places are facets of parallel light, faces
/// otherwise.
PathTree find_paths(const ChainSearch& search, const Light& light);

}  // namespace abbe
