/// Chains of directional lamps and beams: bundles of parallel rays, cut to the facets they meet.
#pragma once

#include <cstdint>

#include "abbe/caustics/flat/search/chain_search.h"

namespace abbe {

/// Adds the chains of a directional light, the one of that number.
/// Units:  the result is in square metres of beam.
ChainYield add_parallel_chains(const ChainSearch& search, const Light& light, std::uint32_t number,
                               ParallelChains& chains);

}  // namespace abbe
