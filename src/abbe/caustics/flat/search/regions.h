/// Where light is among flat bodies, and what it can meet from there.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "abbe/caustics/flat/bodies.h"
#include "abbe/math/polygon.h"

namespace abbe {

/// The inside of a body, by its number, or air.
using Region = std::optional<std::uint32_t>;

/// A facet as it is met from one side.
struct FacetSide {
  std::uint32_t facet = 0;
  bool from_inside = false;

  bool operator==(const FacetSide&) const = default;
};

/// Where a ray meets a facet.
struct FacetHit {
  FacetSide side;
  double distance_m = 0.0;
};

/// What borders on each region.
class Regions {
 public:
  explicit Regions(const FlatBodies& flat);

  /// Facets of one body on the border of a region, and a ball about them.
  struct Group {
    Ball ball;
    std::vector<FacetSide> sides;
  };
  const std::vector<Group>& border(Region region) const {
    return borders_[region ? *region + 1 : 0];
  }

  /// The side on which light goes on, behind a facet or reflected by it.
  Region behind(const FacetSide& side) const {
    return side.from_inside ? flat_.facets[side.facet].beyond
                            : Region(flat_.facets[side.facet].body);
  }

  /// The facet that a ray in a region meets first, other than the one it comes from.
  std::optional<FacetHit> first_hit(Region region, const Vec3d& origin, const Vec3d& direction,
                                    std::uint32_t from) const;

  /// The region that a place lies in.
  Region at(const Vec3d& place) const;

 private:
  const FlatBodies& flat_;
  std::vector<std::vector<Group>> borders_;
};

}  // namespace abbe
