#include "color/uplift_fit.h"

#include <algorithm>
#include <cmath>

#include "color/color.h"

namespace abbe {
namespace {

// A fit is good when it is this near in L*a*b*: far below what can be seen, or stored in a float.
constexpr double kGoodEnough = 1e-5;

// The colour of a reflectance and its derivatives by the coefficients.
struct Evaluation {
  Vec3d rgb_rec709{0.0};
  Mat3d derivative{0.0};  ///< Column k: by c_k.
};

Evaluation evaluate(const NormalisedSigmoid& sigmoid, const ReflectanceProjection& projection) {
  Evaluation result;
  for (std::size_t i = 0; i < projection.s.size(); ++i) {
    const double s = projection.s[i];
    const double x = (sigmoid.c[0] * s + sigmoid.c[1]) * s + sigmoid.c[2];
    const double root = 1.0 / std::sqrt(1.0 + x * x);
    const Vec3d& weight = projection.weight_rec709[i];
    result.rgb_rec709 += (0.5 + 0.5 * x * root) * weight;
    const Vec3d slope = (0.5 * root * root * root) * weight;
    result.derivative[0] += s * s * slope;
    result.derivative[1] += s * slope;
    result.derivative[2] += slope;
  }
  return result;
}

const Mat3d& to_xyz() {
  static const Mat3d matrix = rec709_to_xyz();
  return matrix;
}

const Vec3d& white_xyz() {
  static const Vec3d white = xyz_of_xy(kD65_xy);
  return white;
}

Vec3d lab_of(const Vec3d& rgb_rec709) {
  return lab_of_xyz(to_xyz() * rgb_rec709, white_xyz());
}

// Derivative of L*a*b* by linear Rec.709.
Mat3d lab_derivative(const Vec3d& rgb_rec709) {
  const Vec3d ratio = to_xyz() * rgb_rec709 / white_xyz();
  Vec3d root_slope;
  for (int i = 0; i < 3; ++i) {
    const double t = ratio[i];
    const double slope =
        t > 216.0 / 24389.0 ? 1.0 / (3.0 * std::cbrt(t * t)) : 24389.0 / 27.0 / 116.0;
    root_slope[i] = slope / white_xyz()[i];
  }
  Mat3d result;
  for (int channel = 0; channel < 3; ++channel) {
    const Vec3d by_channel = root_slope * to_xyz()[channel];
    result[channel] = {116.0 * by_channel.y, 500.0 * (by_channel.x - by_channel.y),
                       200.0 * (by_channel.y - by_channel.z)};
  }
  return result;
}

}  // namespace

Vec3d ReflectanceProjection::rec709(const NormalisedSigmoid& reflectance) const {
  return evaluate(reflectance, *this).rgb_rec709;
}

NormalisedSigmoid constant_reflectance(double value) {
  // S(x) = value, solved for x.
  const double spread = value * (1.0 - value);
  const double x =
      spread > 0.0 ? (value - 0.5) / std::sqrt(spread) : std::copysign(kSaturated, value - 0.5);
  return {Vec3d(0.0, 0.0, std::clamp(x, -kSaturated, kSaturated))};
}

NormalisedSigmoid fit_reflectance(const Vec3d& rgb_rec709, const ReflectanceProjection& projection,
                                  const NormalisedSigmoid& start) {
  const Vec3d target = lab_of(rgb_rec709);
  NormalisedSigmoid best = start;
  Evaluation at_best = evaluate(best, projection);
  Vec3d residual = lab_of(at_best.rgb_rec709) - target;
  double error = glm::dot(residual, residual);
  double damping = 1e-3;
  for (int iteration = 0; iteration < 60 && error > kGoodEnough * kGoodEnough; ++iteration) {
    const Mat3d jacobian = lab_derivative(at_best.rgb_rec709) * at_best.derivative;
    const Mat3d normal = glm::transpose(jacobian) * jacobian;
    const Vec3d gradient = glm::transpose(jacobian) * residual;
    bool improved = false;
    while (!improved && damping < 1e12) {
      Mat3d damped = normal;
      for (int k = 0; k < 3; ++k) damped[k][k] += damping * normal[k][k] + 1e-18;
      NormalisedSigmoid candidate = best;
      candidate.c -= glm::inverse(damped) * gradient;
      const double size =
          std::max({std::abs(candidate.c[0]), std::abs(candidate.c[1]), std::abs(candidate.c[2])});
      if (size < kSaturated) {
        const Evaluation at_candidate = evaluate(candidate, projection);
        const Vec3d candidate_residual = lab_of(at_candidate.rgb_rec709) - target;
        const double candidate_error = glm::dot(candidate_residual, candidate_residual);
        if (candidate_error < error) {
          best = candidate;
          at_best = at_candidate;
          residual = candidate_residual;
          error = candidate_error;
          improved = true;
        }
      }
      damping *= improved ? 0.1 : 8.0;
    }
    if (!improved) break;
    damping = std::max(damping, 1e-9);
  }
  return best;
}

NormalisedSigmoid fit_reflectance(const Vec3d& rgb_rec709,
                                  const ReflectanceProjection& projection) {
  if (rgb_rec709.r == rgb_rec709.g && rgb_rec709.g == rgb_rec709.b) {
    return constant_reflectance(rgb_rec709.r);
  }
  const double grey = std::clamp(glm::dot(rgb_rec709, Vec3d(0.2126, 0.7152, 0.0722)), 0.02, 0.98);
  NormalisedSigmoid sigmoid = constant_reflectance(grey);
  // Towards a saturated colour step by step, each from the result of the one before.
  constexpr int kSteps = 4;
  for (int step = 1; step <= kSteps; ++step) {
    const double t = static_cast<double>(step) / kSteps;
    sigmoid = fit_reflectance(t * rgb_rec709 + (1.0 - t) * Vec3d(grey), projection, sigmoid);
  }
  return sigmoid;
}

}  // namespace abbe
