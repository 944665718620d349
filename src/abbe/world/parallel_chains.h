/// Chains of directional lamps and beams: bundles of parallel rays, cut to the facets they meet.
#pragma once

#include <cstdint>

#include "abbe/world/chains.h"

namespace abbe {

/// Adds the chains of a directional light to World::chains and chain_rows. Incomplete where the
/// result names a body.
/// Units:  the result is in square metres of beam.
ChainYield add_parallel_chains(const Scene& scene, const CausticOptions& options,
                               std::uint32_t light, World& world);

}  // namespace abbe
