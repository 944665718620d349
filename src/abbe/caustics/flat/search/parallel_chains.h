/// Chains of directional lamps and beams: bundles of parallel rays, cut to the facets they meet.
#pragma once

#include <cstddef>
#include <cstdint>

#include "abbe/caustics/flat/search/chain_search.h"
#include "abbe/world/light/lamp_places.h"

namespace abbe {

/// Adds the chains of a directional light, the source of that number; it and those after it, so
/// many, share the room that is left in the tables.
/// Units:  the result is in square metres of beam. Domain: sources_left ≥ 1.
ChainYield add_parallel_chains(const ChainSearch& search, const LampPlace& place,
                               std::uint32_t source, std::size_t sources_left,
                               ParallelChains& chains);

}  // namespace abbe
