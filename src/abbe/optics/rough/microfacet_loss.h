/// What single scattering on GGX microfacets loses: light that meets a second one.
#pragma once

#include <array>

namespace abbe {

/// Shares of white light that does not leave a rough mirror after one microfacet.
class MicrofacetLoss {
 public:
  /// The one table, made when it is first asked for, in some hundredths of a second.
  static const MicrofacetLoss& table();

  /// Of light that arrives at an angle, within 0.002.
  /// Domain: cosine in [0, 1], alpha = roughness² in [0, 1].
  float at(float cosine, float alpha) const;
  /// The mean of at() over light from all around, 2∫ at(μ) μ dμ; exact for its values.
  float mean(float alpha) const;
  /// A cosine drawn with nearly at(μ)·μ for its density.
  /// Domain: u in [0, 1), alpha > 0.
  float draw(float alpha, float u) const;
  /// The density of draw() over 2μ: over directions of the half space, times π, over that of
  /// Lambert's law. 0 for cosines below 0.
  float density(float cosine, float alpha) const;

 private:
  MicrofacetLoss();
  static constexpr int kSteps = 32;
  static constexpr int kNodes = kSteps + 1;
  // Nodes are even in roughness, and in the root of the cosine: losses are steep near grazing.
  std::array<std::array<float, kNodes>, kNodes> lost_{};
  std::array<std::array<float, kNodes>, kNodes> below_{};  ///< Of the mean, from cosine 0 up.
};

}  // namespace abbe
