/// Cut gems as exact polyhedra.
#pragma once

#include "scene/scene.h"

namespace abbe::test {

/// A round brilliant of 57 facets: table, 8 stars, 8 bezels, 16 upper girdle facets, 16 lower ones
/// and 8 pavilion mains, with Tolkowsky's angles (crown 34.5°, pavilion 40.75°), a table of 56 %,
/// stars of 50 % and lower halves of 77 %. The girdle is a sharp edge of unit radius in the plane
/// y = 0; the table faces +Y.
/// Source: Tolkowsky, Diamond Design, 1919.
ConvexShape brilliant();

}  // namespace abbe::test
