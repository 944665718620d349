/// What microfacets of GGX hide of each other.
#pragma once

#include <cmath>

namespace abbe {

/// Smith's Λ: microfacets hidden from a direction for each that it sees; masking is 1 / (1 + Λ).
/// Domain: 0 < cosine ≤ 1, alpha > 0.
/// Source: Heitz, Understanding the Masking-Shadowing Function, JCGT 3(2), 2014, eq. 72.
inline double smith_lambda(double cosine, double alpha) {
  return 0.5 * (std::sqrt(1.0 + alpha * alpha * (1.0 / (cosine * cosine) - 1.0)) - 1.0);
}

}  // namespace abbe
