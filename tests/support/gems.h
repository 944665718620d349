/// Cut gems as exact polyhedra.
#pragma once

#include "abbe/scene/scene.h"

namespace abbe::test {

/// A round brilliant of 57 facets: table, 8 stars, 8 bezels, 16 upper girdle facets, 16 lower ones
/// and 8 pavilion mains, with Tolkowsky's angles (crown 34.5°, pavilion 40.75°), a table of 56 %,
/// stars of 50 % and lower halves of 77 %. The girdle is a sharp edge of unit radius in the plane
/// y = 0; the table faces +Y.
/// Source: Tolkowsky, Diamond Design, 1919.
ConvexShape brilliant();

/// The same without halves and stars: table, 8 bezels, 8 pavilion mains.
ConvexShape single_cut();

/// The same without lower halves and with one upper facet where the brilliant has two: table, 8
/// stars, 8 bezels, 8 upper facets, 8 pavilion mains; 33 facets.
ConvexShape simple_brilliant();

}  // namespace abbe::test
