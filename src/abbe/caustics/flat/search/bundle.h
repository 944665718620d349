/// Bundles of parallel rays that cross flat facets.
#pragma once

#include <vector>

#include "abbe/caustics/flat/bodies.h"
#include "abbe/math/polygon.h"
#include "abbe/math/vec.h"

namespace abbe {

/// A bundle of parallel rays of one wavelength at a facet.
struct Bundle {
  std::vector<Vec3d> polygon;  ///< Where it meets the facet; empty: nothing is left.
  Vec3d direction{0.0};        ///< Behind the facet.
};

/// The bundles of all wavelengths behind a facet, and a cone that holds them, once bound() has made
/// it.
struct BundleSet {
  std::vector<Bundle> bundles;  ///< Of each wavelength, or one where all of them go the same way.
  std::vector<double> weights;  ///< Per wavelength, irradiance across the beam over the lamp's.
  Ball ball;
  Vec3d axis{0.0, 0.0, 1.0};
  double tan_spread = 0.0;

  bool is_one() const { return bundles.size() == 1; }
  const Bundle& of(std::size_t wave) const { return bundles[is_one() ? 0 : wave]; }
  bool is_alive() const { return ball.radius_m > 0.0; }
  void bound();
};

}  // namespace abbe
