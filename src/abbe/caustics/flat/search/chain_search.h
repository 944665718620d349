/// What the searches for chains have in common.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "abbe/caustics/flat/facet_optics.h"
#include "abbe/caustics/flat/flat_caustics.h"
#include "abbe/caustics/flat/search/obstacles.h"
#include "abbe/caustics/flat/search/regions.h"

namespace abbe {

/// What a material is to light of all wavelengths.
struct MaterialRange {
  double low = 1.0, high = 1.0;  ///< Of its index.
  bool is_grey = true;           ///< A boundary to it does the same to all wavelengths.

  bool disperses() const { return low < high; }
};

/// Of each material, over waves [first, last) of those in the order of their wavelengths.
/// Domain: shares of them in [0, 1].
std::vector<MaterialRange> material_ranges(const TabulatedScene& tables, double first = 0.0,
                                           double last = 1.0);

/// Where chains are searched for, and how.
struct ChainSearch {
  const FlatBodies& flat;
  const Regions& regions;
  const TabulatedScene& tables;
  const CausticOptions& options;
  Obstacles& obstacles;
  std::vector<MaterialRange> ranges = material_ranges(tables);

  const FlatBody& body_of(const Facet& facet) const { return flat.bodies[facet.body]; }
  FacetMedia media_of(const Facet& facet) const {
    const SurfaceMaterial* outside = nullptr;
    if (facet.beyond) outside = &tables.materials[flat.bodies[*facet.beyond].material];
    return {&tables.materials[body_of(facet).material], outside};
  }

  /// Of a medium; air has none.
  MaterialRange range_of(const SurfaceMaterial* medium) const {
    if (medium == nullptr) return {};
    return ranges[static_cast<std::size_t>(medium - tables.materials.data())];
  }

  /// Whether anything may be in a region that its light shows on.
  bool lights_places(Region region) const {
    return !region || flat.bodies[*region].has_lit_inclusions;
  }

  std::size_t lanes() const { return static_cast<std::size_t>(tables.lanes.lane_count()); }
  /// Wavelengths of all sets.
  std::size_t waves() const { return lanes() * static_cast<std::size_t>(tables.lanes.set_count()); }
  /// Whether wavelengths differ, but are so few that each is searched for by itself: what is found
  /// for it does not depend on the others then.
  bool has_separate_waves() const;
  Wave wave(std::size_t number) const {
    return {static_cast<int>(number / lanes()), static_cast<int>(number % lanes())};
  }
};

/// The nearest numbers of single precision. A cast there and back will not do: at -O3 the
/// vectoriser of GCC 12.2 drops such a pair.
Vec3d rounded_to_single(const Vec3d& v);

/// What a search for the chains of one light has met.
struct ChainYield {
  double started = 0.0;  ///< Light that fell on facets; the unit depends on the kind of light.
  double cut = 0.0;      ///< The part of it on paths that are left out.
  std::vector<BodyLight> by_body = {};
};

}  // namespace abbe
