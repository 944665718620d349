/// Chains of point and spot lights: cones of light that took the same path, put together.
#pragma once

#include <cstdint>

#include "abbe/caustics/flat/search/chain_search.h"

namespace abbe {

/// Adds the chains of a point or spot light, the source of that number, with their groups.
/// Units:  the result is in steradians.
ChainYield add_point_chains(const ChainSearch& search, const Light& light, std::uint32_t source,
                            PointChains& chains);

/// Orders groups and the chains in them, largest first.
void sort_point_chains(PointChains& all);

}  // namespace abbe
