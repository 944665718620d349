/// What lies in flat bodies or reaches into them.
#pragma once

#include <vector>

#include "abbe/caustics/flat/arrangement.h"
#include "abbe/scene/scene.h"

namespace abbe {

/// Marks the bodies of glass in which another object may lie or into which one may reach
/// (FlatBody::has_inclusions), and those of them of which light may show on it
/// (FlatBody::has_lit_inclusions). What lies on a body has its surface on the far side of one of
/// the planes that the body is behind, but for rounding: 4 units in the last place of its
/// coordinates, as floats. Never marks too few. Domain: facets of closed bodies point outwards.
void find_inclusions(const Scene& scene, std::vector<BodyFacets>& bodies);

}  // namespace abbe
