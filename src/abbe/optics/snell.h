/// Directions of reflected and refracted rays.
#pragma once

#include <cmath>
#include <optional>

#include <glm/geometric.hpp>
#include <glm/vec3.hpp>

namespace abbe {

/// Mirror direction of a ray that travels along `direction`.
/// Domain: unit vectors of float or double; the sign of the normal does not matter.
template <typename Real>
glm::vec<3, Real> reflected_direction(const glm::vec<3, Real>& direction,
                                      const glm::vec<3, Real>& normal) {
  return direction - Real(2) * glm::dot(direction, normal) * normal;
}

/// Direction behind a boundary, by Snell's law; nothing at total internal reflection.
/// Units:  eta_ti = n_transmitted / n_incident.
/// Domain: unit vectors of float or double; the normal on either side: the one that faces the ray
///         is used. The result is a unit vector.
/// Source: Born & Wolf, Principles of Optics, 7th ed., 1.5.1.
template <typename Real>
std::optional<glm::vec<3, Real>> refracted_direction(const glm::vec<3, Real>& direction,
                                                     const glm::vec<3, Real>& normal, Real eta_ti) {
  const Real signed_cosine = -glm::dot(direction, normal);
  const Real cos_incident = std::abs(signed_cosine);
  // g = eta_ti · cos_transmitted, in the form that is exact where both indices are equal.
  const Real g_squared = (eta_ti - Real(1)) * (eta_ti + Real(1)) + cos_incident * cos_incident;
  if (!(g_squared > Real(0))) return std::nullopt;
  const Real along_normal = cos_incident - std::sqrt(g_squared);
  const glm::vec<3, Real> facing = signed_cosine < Real(0) ? -normal : normal;
  return glm::normalize((direction + along_normal * facing) / eta_ti);
}

}  // namespace abbe
