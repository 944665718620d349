/// Places that stand for a lamp with an extent where its light is followed instead of drawn.
#pragma once

#include <cstddef>
#include <vector>

#include "abbe/scene/scene.h"
#include "abbe/world/light/lights.h"

namespace abbe {

/// A place of a lamp, as a lamp without an extent of its own.
struct LampPlace {
  Light light;  ///< Where it shines from, or in which direction: of a disc on the sky.
  /// Its illuminance, if it were the only one, over that of the whole lamp on what faces its
  /// middle: a disc on the sky arrives aslant.
  double times = 1.0;
};

/// Shape:  `count` places that shine alike, of which any aligned 2^k one after the other lie in
///         neighbouring parts; a single one is the middle. A lamp without an extent is its only
///         place. Those of a ball shine all around and lie in it so that from afar they fill its
///         disc evenly, and what faces it has the light of its middle at any distance.
/// Domain: count is a power of 2.
std::vector<LampPlace> lamp_places(const Light& light, std::size_t count);

/// The same in the world. Flat ones shine to their side by Lambert's law (WindowFromMiddle).
WorldLight at_place(const WorldLight& lamp, const LampPlace& place);

}  // namespace abbe
