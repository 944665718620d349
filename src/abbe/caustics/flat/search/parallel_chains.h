/// Chains of directional lamps and beams: bundles of parallel rays, cut to the facets they meet.
#pragma once

#include <cstddef>
#include <cstdint>

#include "abbe/caustics/flat/search/chain_search.h"

namespace abbe {

/// Adds the chains of a directional light, the one of that number; it and those after it, so many,
/// share the room that is left in the tables.
/// Units:  the result is in square metres of beam. Domain: lights_left ≥ 1.
ChainYield add_parallel_chains(const ChainSearch& search, const Light& light, std::uint32_t number,
                               std::size_t lights_left, ParallelChains& chains);

}  // namespace abbe
