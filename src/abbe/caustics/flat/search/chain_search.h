/// What the searches for chains have in common.
#pragma once

#include <cstdint>
#include <optional>

#include "abbe/caustics/flat/flat_caustics.h"

namespace abbe {

/// Where chains are searched for, and how.
struct ChainSearch {
  const FlatBodies& flat;
  const TabulatedScene& tables;
  const CausticOptions& options;

  const FlatBody& body_of(const Facet& facet) const { return flat.bodies[facet.body]; }
  const SurfaceMaterial& material_of(const FlatBody& body) const {
    return tables.materials[body.material];
  }
};

/// What a search for the chains of one light has met.
struct ChainYield {
  double started = 0.0;  ///< Light that fell on facets; the unit depends on the kind of light.
  double cut = 0.0;      ///< The part of it that chains below the cutoff would have carried.
  std::optional<std::uint32_t> too_large;  ///< A body that has more chains than can be kept.
};

}  // namespace abbe
