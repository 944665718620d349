/// The order in which a ray meets primitives: the one rule that decides which hit is the answer.
#pragma once

#include <cstdint>

#include "abbe/accel/query.h"

namespace abbe {

/// Whether a hit comes before the one that a ray has so far; `best.t` is the end of the open
/// segment where there is none. Of two primitives at the same distance the lower number wins,
/// whatever was tested first. IsNearer() in lanes-inl.h is the same for lanes.
inline bool is_nearer(float t, std::uint32_t primitive, const Hit& best) {
  return t < best.t || (t == best.t && best.is_hit() && primitive < best.primitive);
}

}  // namespace abbe
