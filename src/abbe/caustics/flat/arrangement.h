/// Flat bodies that touch or hold each other: what lies on which side of their facets.
#pragma once

#include <string>
#include <vector>

#include "abbe/caustics/flat/bodies.h"

namespace abbe {

/// A body with its facets, before they are numbered.
struct BodyFacets {
  FlatBody body;
  std::vector<Facet> facets;
  bool is_exact_shape = false;  ///< Not a mesh: its primitive comes after those of all meshes.
};

/// Why a body cannot be told from others.
struct SharedSpace {
  std::size_t body = 0;
  std::string why;
};

/// Cuts facets where other bodies begin and notes the body before each piece. Of two closed bodies
/// the inner one has the place, of equal ones in one place the last. Facets touch within 4 units in
/// the last place of their own coordinates, as floats: what is elsewhere does not matter. Where two
/// bodies touch there is one boundary, kept by the first;
/// where a mirror touches glass, a gap of air is between them. Pieces that are no boundary go.
/// Domain: facets of closed bodies point outwards; a mirror's are taken from both
///         sides unless it is there from the front only.
/// Returns the bodies whose surfaces go through each other, and those that touch such a one: they
/// must not stay among the others.
std::vector<SharedSpace> arrange(std::vector<BodyFacets>& bodies);

}  // namespace abbe
