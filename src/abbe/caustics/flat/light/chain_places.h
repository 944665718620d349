/// What is known of a chain's path to a place, in every lane.
#pragma once

#include "abbe/caustics/flat/chain.h"
#include "abbe/math/lane_array.h"

namespace abbe {

/// Where light on a chain met its facets, relative to the chain's origin.
struct ChainPlaces {
  LaneArray3 places[kMaxChainSteps];
};

}  // namespace abbe
