/// What is known of a chain's path to a place, in every lane.
#pragma once

#include "abbe/caustics/flat/chain.h"
#include "abbe/math/lane_array.h"

namespace abbe {

/// Where light on a chain met its facets, relative to the chain's origin, and a distance that
/// covers the rounding errors of these places.
struct ChainPlaces {
  LaneArray3 places[kMaxChainSteps];
  LaneArray slack_m;
};

}  // namespace abbe
