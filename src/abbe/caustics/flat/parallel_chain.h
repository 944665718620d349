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

#include <algorithm>
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
  /// In ParallelChains::rows: the weights of all sets, then the directions and sides of each or,
  /// where all wavelengths go the same way, of one.
  std::size_t rows = 0;
  bool disperses = true;  ///< Wavelengths go different ways.

  std::size_t geometry_arrays() const { return 3 * steps.size() + 4 * side_count; }
  std::size_t array_count(std::size_t sets) const {
    return sets + (disperses ? sets : 1) * geometry_arrays();
  }
};

/// Whether a ball about `center` may get light from a chain; a quick no.
inline bool may_light(const ParallelChain& chain, const Vec3f& center, float radius_m) {
  const Vec3f v = center - chain.bound_center;
  const float along = glm::dot(v, chain.bound_axis);
  const float reach = chain.bound_radius_m + radius_m;
  if (along < -reach) return false;
  // The cone's tip is a ball: at a distance its cross section has grown by that distance's share.
  const float across2 = glm::dot(v, v) - along * along;
  const float widest = reach * (1.0f + chain.bound_tan) + std::max(along, 0.0f) * chain.bound_tan;
  return across2 <= widest * widest;
}

/// What a chain of parallel light has for each lane of a wavelength set: arrays of lane_stride
/// floats. Of vectors, y and z follow x a stride apart.
template <class Float>
struct ParallelChainRows {
  Float* weight = nullptr;  ///< Irradiance over the lamp's; 0 in lanes that no light passes.
  Float* geometry = nullptr;
  std::size_t stride = 0;
  std::size_t step_count = 0;

  /// The direction x, y, z after a step.
  Float* direction(std::size_t step) const { return geometry + 3 * step * stride; }
  /// A plane of what is lit: normal x, y, z and offset. A point is lit where all normal·x + offset
  /// ≥ 0, x relative to the chain's origin.
  Float* side(std::size_t number) const {
    return geometry + (3 * step_count + 4 * number) * stride;
  }
};

/// The chains of all parallel light.
struct ParallelChains {
  std::vector<ParallelChain> chains;  ///< Largest first.
  std::vector<float> rows;
  std::size_t lane_stride = 0, set_count = 0;

  ParallelChainRows<const float> of(const ParallelChain& chain, int set) const {
    return rows_of(rows.data(), chain, static_cast<std::size_t>(set));
  }
  ParallelChainRows<float> of(const ParallelChain& chain, int set) {
    return rows_of(rows.data(), chain, static_cast<std::size_t>(set));
  }

 private:
  template <class Float>
  ParallelChainRows<Float> rows_of(Float* all, const ParallelChain& chain, std::size_t set) const {
    Float* first = all + chain.rows;
    const std::size_t arrays = set_count + (chain.disperses ? set * chain.geometry_arrays() : 0);
    return {first + set * lane_stride, first + arrays * lane_stride, lane_stride,
            chain.steps.size()};
  }
};

}  // namespace abbe
