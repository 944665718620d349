#include "abbe/color/uplift/fit.h"

#include <algorithm>
#include <cmath>

#include "abbe/color/color.h"

namespace abbe {
namespace {

// A fit is good when it is this near in L*a*b*: far below what can be seen, or stored in a float.
constexpr double kGoodEnough = 1e-5;
// A step that takes off less than this share of the squared distance says that no reflectance comes
// nearer: the colour is one that none has.
constexpr double kStalled = 1e-5;

// The colour of a reflectance and its derivatives by the coefficients.
struct Evaluation {
  Vec3d rgb_rec709{0.0};
  Mat3d derivative{0.0};  ///< Column k: by c_k.
};

// Two wavelengths side by side, which the compiler makes vectors of: sums of the even and of the
// odd ones.
Evaluation evaluate(const NormalisedSigmoid& sigmoid, const ReflectanceProjection& projection) {
  const double c0 = sigmoid.c[0], c1 = sigmoid.c[1], c2 = sigmoid.c[2];
  double value[3][2] = {}, by_c0[3][2] = {}, by_c1[3][2] = {}, by_c2[3][2] = {};
  const std::size_t count = projection.s.size();
  for (std::size_t i = 0; i < count; i += 2) {
    const double* s = projection.s.data() + i;
    double fraction[2], slope[2];
    for (std::size_t p = 0; p < 2; ++p) {
      const double x = (c0 * s[p] + c1) * s[p] + c2;
      const double root = 1.0 / std::sqrt(1.0 + x * x);
      fraction[p] = 0.5 + 0.5 * x * root;
      slope[p] = 0.5 * root * root * root;
    }
    for (std::size_t channel = 0; channel < 3; ++channel) {
      const double* weight = projection.weight_rec709[channel].data() + i;
      for (std::size_t p = 0; p < 2; ++p) {
        value[channel][p] += weight[p] * fraction[p];
        const double weighted = weight[p] * slope[p];
        by_c2[channel][p] += weighted;
        by_c1[channel][p] += weighted * s[p];
        by_c0[channel][p] += weighted * s[p] * s[p];
      }
    }
  }
  Evaluation result;
  for (int channel = 0; channel < 3; ++channel) {
    result.rgb_rec709[channel] = value[channel][0] + value[channel][1];
    result.derivative[0][channel] = by_c0[channel][0] + by_c0[channel][1];
    result.derivative[1][channel] = by_c1[channel][0] + by_c1[channel][1];
    result.derivative[2][channel] = by_c2[channel][0] + by_c2[channel][1];
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
    const double error_before = error;
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
    if (!improved || error_before - error < kStalled * error) break;
    damping = std::max(damping, 1e-9);
  }
  return best;
}

namespace {

// Sums of the weights up to a place between two wavelengths, for reflectances with sharp edges.
class EdgeSums {
 public:
  explicit EdgeSums(const ReflectanceProjection& projection) {
    sums_.emplace_back(0.0);
    for (std::size_t i = 0; i < projection.s.size(); ++i) {
      Vec3d weight;
      for (std::size_t c = 0; c < 3; ++c)
        weight[static_cast<int>(c)] = projection.weight_rec709[c][i];
      sums_.push_back(sums_.back() + weight);
    }
  }
  double size() const { return static_cast<double>(sums_.size() - 1); }
  Vec3d up_to(double place) const {
    const double at = std::clamp(place, 0.0, size());
    const std::size_t below = std::min(static_cast<std::size_t>(at), sums_.size() - 2);
    const double t = at - static_cast<double>(below);
    return (1.0 - t) * sums_[below] + t * sums_[below + 1];
  }
  Vec3d band(double from, double to, bool is_gap) const {
    const Vec3d inside = up_to(to) - up_to(from);
    return is_gap ? sums_.back() - inside : inside;
  }

 private:
  std::vector<Vec3d> sums_;
};

}  // namespace

// First on a coarse grid of edges, then both in ever smaller steps.
NormalisedSigmoid nearest_optimal_color(const Vec3d& rgb_rec709,
                                        const ReflectanceProjection& projection) {
  const EdgeSums sums(projection);
  const Vec3d target = lab_of(rgb_rec709);
  double edge[2] = {0.0, 0.0}, error = 1e30;
  bool is_gap = false;
  const auto try_edges = [&](double from, double to, bool gap) {
    if (from > to) return false;
    const Vec3d residual = lab_of(sums.band(from, to, gap)) - target;
    const double here = glm::dot(residual, residual);
    if (here >= error) return false;
    error = here;
    edge[0] = from;
    edge[1] = to;
    is_gap = gap;
    return true;
  };
  constexpr double kCoarse = 20.0, kFine = 1.0 / 64.0;
  for (double from = 0.0; from < sums.size(); from += kCoarse) {
    for (double to = from + kCoarse; to < sums.size() + kCoarse; to += kCoarse) {
      for (const bool gap : {false, true}) try_edges(from, to, gap);
    }
  }
  for (double step = 0.5 * kCoarse; step > kFine;) {
    bool improved = false;
    for (const double first : {-step, 0.0, step}) {
      for (const double second : {-step, 0.0, step}) {
        improved |= try_edges(edge[0] + first, edge[1] + second, is_gap);
      }
    }
    if (!improved) step *= 0.5;
  }
  // Edges as steep as single precision lets them be: x = ∓k (s − s0)(s − s1).
  constexpr double k = 0.25 * kSaturated;
  const double step_s = projection.s[1] - projection.s[0];
  const double s0 = projection.s[0] + (edge[0] - 0.5) * step_s;
  const double s1 = projection.s[0] + (edge[1] - 0.5) * step_s;
  const double sign = is_gap ? 1.0 : -1.0;
  return {sign * k * Vec3d(1.0, -(s0 + s1), s0 * s1)};
}

double squared_miss_in_lab(const NormalisedSigmoid& sigmoid, const Vec3d& rgb_rec709,
                           const ReflectanceProjection& projection) {
  const Vec3d residual = lab_of(projection.rec709(sigmoid)) - lab_of(rgb_rec709);
  return glm::dot(residual, residual);
}

NormalisedSigmoid fit_reflectance(const Vec3d& rgb_rec709,
                                  const ReflectanceProjection& projection) {
  if (rgb_rec709.r == rgb_rec709.g && rgb_rec709.g == rgb_rec709.b) {
    return constant_reflectance(std::clamp(rgb_rec709.r, 0.0, 1.0));
  }
  const double grey = std::clamp(glm::dot(rgb_rec709, Vec3d(0.2126, 0.7152, 0.0722)), 0.02, 0.98);
  NormalisedSigmoid sigmoid = constant_reflectance(grey);
  // Towards a saturated colour step by step, each from the result of the one before.
  constexpr int kSteps = 4;
  for (int step = 1; step <= kSteps; ++step) {
    const double t = static_cast<double>(step) / kSteps;
    sigmoid = fit_reflectance(t * rgb_rec709 + (1.0 - t) * Vec3d(grey), projection, sigmoid);
  }
  const double miss = squared_miss_in_lab(sigmoid, rgb_rec709, projection);
  if (miss < kMissedInLab * kMissedInLab) return sigmoid;
  const NormalisedSigmoid optimal = nearest_optimal_color(rgb_rec709, projection);
  return squared_miss_in_lab(optimal, rgb_rec709, projection) < miss ? optimal : sigmoid;
}

}  // namespace abbe
