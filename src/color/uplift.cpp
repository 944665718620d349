#include "color/uplift.h"

#include <algorithm>
#include <cmath>

#include "base/constants.h"
#include "color/uplift_fit.h"
#include "color/uplift_table.h"

namespace abbe {
namespace {

constexpr double kCentre_nm = 595.0;
constexpr double kHalfRange_nm = 235.0;

const ReflectanceProjection& projection() {
  static const ReflectanceProjection result = [] {
    ReflectanceProjection made;
    for (std::size_t i = 0; i < kUpliftWavelengths; ++i) {
      made.s.push_back((kRangeMin_nm + static_cast<double>(i) - kCentre_nm) / kHalfRange_nm);
      const double* weight = &kUpliftProjection[3 * i];
      made.weight_rec709.emplace_back(weight[0], weight[1], weight[2]);
    }
    return made;
  }();
  return result;
}

// The polynomial through three values of x at kUpliftStored_s, by Newton's divided differences.
Vec3d polynomial_through(const Vec3d& x) {
  const auto& s = kUpliftStored_s;
  const double first = (x[1] - x[0]) / (s[1] - s[0]);
  const double second = ((x[2] - x[1]) / (s[2] - s[1]) - first) / (s[2] - s[0]);
  return {second, first - second * (s[0] + s[1]), x[0] - s[0] * first + s[0] * s[1] * second};
}

// The four nodes around a position along an axis and their weights in Lagrange's cubic.
struct CubicWeights {
  std::size_t first = 0;
  double weight[4] = {};

  explicit CubicWeights(double coordinate) {
    const double position = uplift_position(coordinate) * (kUpliftNodes - 1);
    const double before = std::clamp(std::floor(position) - 1.0, 0.0, kUpliftNodes - 4.0);
    first = static_cast<std::size_t>(before);
    const double t = position - before;  // nodes at 0, 1, 2, 3
    weight[0] = -(t - 1.0) * (t - 2.0) * (t - 3.0) / 6.0;
    weight[1] = t * (t - 2.0) * (t - 3.0) / 2.0;
    weight[2] = -t * (t - 1.0) * (t - 3.0) / 2.0;
    weight[3] = t * (t - 1.0) * (t - 2.0) / 6.0;
  }
};

}  // namespace

SigmoidPolynomial polynomial_in_nm(const Vec3d& coefficients_in_s) {
  constexpr double a = 1.0 / kHalfRange_nm, b = -kCentre_nm / kHalfRange_nm;  // s = a λ + b
  const Vec3d& c = coefficients_in_s;
  return {c[0] * a * a, (2.0 * c[0] * b + c[1]) * a, (c[0] * b + c[1]) * b + c[2]};
}

Vec3d coefficients_in_s(const SigmoidPolynomial& polynomial) {
  constexpr double a = kHalfRange_nm, b = kCentre_nm;  // λ = a s + b
  return {polynomial.c0 * a * a, (2.0 * polynomial.c0 * b + polynomial.c1) * a,
          (polynomial.c0 * b + polynomial.c1) * b + polynomial.c2};
}

SigmoidPolynomial uplift_rec709(const Vec3d& rgb_rec709) {
  const Vec3d color = glm::clamp(rgb_rec709, 0.0, 1.0);
  return polynomial_in_nm(fit_reflectance(color, projection()).c);
}

Vec3f uplift_rec709_from_table(const Vec3f& rgb_rec709) {
  const Vec3f color = glm::clamp(rgb_rec709, 0.0f, 1.0f);
  if (color.r == color.g && color.g == color.b) {
    return Vec3f(constant_reflectance(color.r).c);
  }
  const int largest = color.r >= color.g && color.r >= color.b ? 0 : (color.g >= color.b ? 1 : 2);
  const double brightness = color[largest];
  const CubicWeights along_i(brightness);
  const CubicWeights along_j(color[(largest + 1) % 3] / brightness);
  const CubicWeights along_k(color[(largest + 2) % 3] / brightness);

  Vec3d stored(0.0);
  for (std::size_t i = 0; i < 4; ++i) {
    for (std::size_t j = 0; j < 4; ++j) {
      const double weight_ij = along_i.weight[i] * along_j.weight[j];
      const float* row = &kUpliftTable[uplift_index(
          static_cast<std::size_t>(largest), along_i.first + i, along_j.first + j, along_k.first)];
      for (std::size_t k = 0; k < 4; ++k) {
        const double weight = weight_ij * along_k.weight[k];
        stored += weight * Vec3d(row[3 * k], row[3 * k + 1], row[3 * k + 2]);
      }
    }
  }
  Vec3d x;
  for (int w = 0; w < 3; ++w) {
    // A cubic may overshoot; 1e-4 is within what single precision calls 0 or 1.
    const double theta = std::clamp(stored[w], 1e-4, kPi - 1e-4);
    x[w] = -1.0 / std::tan(theta);
  }
  return Vec3f(polynomial_through(x));
}

Spectrum uplift_emission_rec709(const Vec3d& rgb_rec709, const Spectrum& d65_at_1_cd_per_m2) {
  const Vec3d color = glm::max(rgb_rec709, 0.0);
  const double scale = 2.0 * std::max<double>({color.r, color.g, color.b});
  if (!(scale > 0.0)) return {};
  const Spectrum shape = Spectrum::sigmoid(uplift_rec709(color / scale));
  return product(shape, d65_at_1_cd_per_m2).scaled(scale);
}

}  // namespace abbe
