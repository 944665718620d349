/// Single scattering on GGX microfacets in double precision, integrated over their slopes: the
/// judge of everything that rough surfaces do. It shares no code with them.
#pragma once

#include <cmath>
#include <numbers>
#include <optional>

#include "abbe/math/vec.h"

namespace abbe::test {

/// A rough surface about +z. Vectors point away from it; `view` has view.z > 0.
/// Source: Walter, Marschner, Li & Torrance, EGSR 2007; Heitz, JCGT 3(2), 2014.
struct Ggx {
  double alpha = 1.0;  ///< roughness².

  double lambda(double cosine) const {
    return 0.5 * (std::sqrt(1.0 + alpha * alpha * (1.0 / (cosine * cosine) - 1.0)) - 1.0);
  }
  double g1(double cosine) const { return 1.0 / (1.0 + lambda(cosine)); }
  double distribution(const Vec3d& half) const {
    const Vec2d slope = Vec2d(half.x, half.y) / half.z;
    const double bracket = 1.0 + glm::dot(slope, slope) / (alpha * alpha);
    return 1.0 / (std::numbers::pi * alpha * alpha * std::pow(half.z, 4) * bracket * bracket);
  }
  /// G2/G1(view) of reflection, with heights that correlate.
  double reflected_share(double cos_view, double cos_out) const {
    return cos_out > 0.0 ? (1.0 + lambda(cos_view)) / (1.0 + lambda(cos_view) + lambda(cos_out))
                         : 0.0;
  }
  /// Of refraction, with independent ones.
  double refracted_share(double cos_behind) const {
    return cos_behind > 0.0 ? g1(cos_behind) : 0.0;
  }

  /// Where a facet lies among all: place in [0, 1)², even steps of which integrate well.
  Vec2d place_of(const Vec3d& half) const {
    const Vec2d slope = Vec2d(half.x, half.y) / (half.z * alpha);
    const double turn = std::atan2(slope.y, slope.x) / (2.0 * std::numbers::pi);
    return {std::sqrt(1.0 - 1.0 / std::sqrt(1.0 + glm::dot(slope, slope))),
            turn < 0.0 ? turn + 1.0 : turn};
  }
  /// Calls visit(place, half, share) for the microfacets seen from `view`, steps² of them; the
  /// shares add up to 1.
  template <class Visit>
  void for_each_visible(const Vec3d& view, int steps, Visit&& visit) const {
    for (int i = 0; i < steps; ++i) {
      for (int j = 0; j < steps; ++j) {
        // Shifted from row to row, so that no edge of what is asked for runs along a column.
        const double shift = std::fmod(j * std::numbers::phi, 1.0);
        const Vec2d place((i + shift) / steps, (j + 0.5) / steps);
        const double rest = 1.0 - place.x * place.x;
        const double steep = alpha * std::sqrt(1.0 - rest * rest) / rest;
        const double turn = 2.0 * std::numbers::pi * place.y;
        const Vec3d slope(steep * std::cos(turn), steep * std::sin(turn), 1.0);
        const double facing = glm::dot(view, slope);
        if (!(facing > 0.0)) continue;
        visit(place, glm::normalize(slope),
              g1(view.z) * facing / view.z * 4.0 * place.x * rest /
                  (steps * static_cast<double>(steps)));
      }
    }
  }
};

/// Mirrored at a facet.
inline Vec3d mirrored(const Vec3d& view, const Vec3d& half) {
  return 2.0 * glm::dot(view, half) * half - view;
}

/// Refracted at a facet by Snell's law; nothing at total reflection.
/// Units: eta_ti = n_behind / n_view.
inline std::optional<Vec3d> bent(const Vec3d& view, const Vec3d& half, double eta_ti) {
  const double cosine = glm::dot(view, half);
  const double square = 1.0 - (1.0 - cosine * cosine) / (eta_ti * eta_ti);
  if (!(square > 0.0)) return std::nullopt;
  return (cosine / eta_ti - std::sqrt(square)) * half - view / eta_ti;
}

}  // namespace abbe::test
