/// Chains of parallel light.
///
/// Behind every facet of a chain all rays of one wavelength are parallel again, so the light that
/// leaves is a prism in space: the part of the last facet that all facets before it let through,
/// swept along one direction. A point is lit when it lies inside the planes of that prism. Its
/// irradiance across the beam is the lamp's times
///   Π τ_j · cosθ_i,j/cosθ_t,j   over refractions and   Π ρ_j   over reflections:
/// τ and ρ are Fresnel's shares of power, and a bundle of cross section A that meets a facet under
/// θ_i covers A/cosθ_i of it and leaves with A·cosθ_t/cosθ_i; a reflection keeps the cross section.
#pragma once

#include <cstddef>
#include <vector>

#include "abbe/caustics/flat/chain.h"

namespace abbe {

/// A chain of parallel light. What depends on the wavelength lies in ParallelChains::rows.
struct ParallelChain : ChainPath {
  // All it lights lies in a cone, of which the tip is this sphere: for a quick no.
  Vec3f bound_center{0.0f};  ///< World coordinates.
  float bound_radius_m = 0.0f;
  Vec3f bound_axis{0.0f, 0.0f, 1.0f};
  float bound_tan = 0.0f;  ///< Of its half angle.
  std::size_t side_count = 0;
  std::size_t rows = 0;

  std::size_t array_count() const { return 1 + 3 * steps.size() + 4 * side_count; }
};

/// What a chain of parallel light has for each lane of a wavelength set: arrays of lane_stride
/// floats. Of vectors, y and z follow x a stride apart.
template <class Float>
struct ParallelChainRows {
  Float* first = nullptr;
  std::size_t stride = 0;
  std::size_t step_count = 0;

  /// Irradiance over the lamp's; 0 in lanes that no light passes.
  Float* weight() const { return first; }
  /// The direction x, y, z after a step.
  Float* direction(std::size_t step) const { return first + (1 + 3 * step) * stride; }
  /// A plane of what is lit: normal x, y, z and offset. A point is lit where all normal·x + offset
  /// ≥ 0, x relative to the chain's origin.
  Float* side(std::size_t number) const {
    return first + (1 + 3 * step_count + 4 * number) * stride;
  }
};

/// The chains of all parallel light.
struct ParallelChains {
  std::vector<ParallelChain> chains;  ///< Largest first.
  std::vector<float> rows;
  std::size_t lane_stride = 0;

  ParallelChainRows<const float> of(const ParallelChain& chain, int set) const {
    return {rows.data() + place_of(chain, set), lane_stride, chain.steps.size()};
  }
  ParallelChainRows<float> of(const ParallelChain& chain, int set) {
    return {rows.data() + place_of(chain, set), lane_stride, chain.steps.size()};
  }

 private:
  std::size_t place_of(const ParallelChain& chain, int set) const {
    return chain.rows + static_cast<std::size_t>(set) * chain.array_count() * lane_stride;
  }
};

}  // namespace abbe
