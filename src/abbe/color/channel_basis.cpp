#include "abbe/color/channel_basis.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>
#include <vector>

#include "abbe/base/constants.h"

namespace abbe {
namespace {

constexpr int kNodes = static_cast<int>(kRangeMax_nm - kRangeMin_nm) + 1;

double node_nm(int i) {
  return kRangeMin_nm + i;
}

// The abscissa of the quadratics, in [−1, 1].
double abscissa(int i) {
  return (node_nm(i) - 595.0) / 235.0;
}

/// Coefficients of q_R and q_G: of s², s and 1.
using Coefficients = std::array<Vec3d, 2>;

std::array<double, 3> shares(const Coefficients& q, int i) {
  const double s = abscissa(i);
  const double red = (q[0].x * s + q[0].y) * s + q[0].z;
  const double green = (q[1].x * s + q[1].y) * s + q[1].z;
  // The largest exponent is taken off all three: nothing overflows.
  const double largest = std::max({red, green, 0.0});
  const std::array<double, 3> e{std::exp(red - largest), std::exp(green - largest),
                                std::exp(-largest)};
  const double sum = e[0] + e[1] + e[2];
  return {e[0] / sum, e[1] / sum, e[2] / sum};
}

// By what a table's value at each node counts in the colour of a reflectance under D65: the
// integral of cmf times the hat of that node, both linear between whole nanometres.
std::vector<Vec3d> node_weights(const Observer& observer, const Spectrum& d65,
                                const Development& development) {
  const auto cmf = [&](int i) {
    const double nm = node_nm(i);
    return Vec3d(observer.x_bar.value(nm), observer.y_bar.value(nm), observer.z_bar.value(nm));
  };
  std::vector<Vec3d> weights(kNodes, Vec3d(0.0));
  for (int i = 0; i + 1 < kNodes; ++i) {
    weights[i] += (2.0 * cmf(i) + cmf(i + 1)) / 6.0;
    weights[i + 1] += (cmf(i) + 2.0 * cmf(i + 1)) / 6.0;
  }
  double white = 0.0;
  for (int i = 0; i < kNodes; ++i) {
    weights[i] *= d65.value(node_nm(i));
    const Vec3d xyz = observer.responses_to_xyz * weights[i];
    white += xyz.y;
    weights[i] = development.xyz_to_rec709 * xyz;
  }
  for (Vec3d& weight : weights) weight /= white;
  return weights;
}

/// How far the colours of b_R and b_G are from their primaries, and the derivatives by q.
struct Evaluation {
  std::array<Vec3d, 2> error{Vec3d(0.0), Vec3d(0.0)};
  Mat3d derivative[2][2] = {{Mat3d(0.0), Mat3d(0.0)}, {Mat3d(0.0), Mat3d(0.0)}};

  double cost() const { return glm::dot(error[0], error[0]) + glm::dot(error[1], error[1]); }
};

Evaluation evaluate(const Coefficients& q, const std::vector<Vec3d>& weights) {
  Evaluation result;
  for (int i = 0; i < kNodes; ++i) {
    const std::array<double, 3> b = shares(q, i);
    const double s = abscissa(i);
    const Vec3d powers(s * s, s, 1.0);
    for (std::size_t c = 0; c < 2; ++c) {
      result.error[c] += b[c] * weights[i];
      for (std::size_t j = 0; j < 2; ++j) {
        const double slope = b[c] * ((c == j ? 1.0 : 0.0) - b[j]);
        result.derivative[c][j] += glm::outerProduct(slope * weights[i], powers);
      }
    }
  }
  result.error[0].x -= 1.0;
  result.error[1].y -= 1.0;
  return result;
}

// One step of Levenberg and Marquardt: the normal equations, their diagonal raised, solved block by
// block.
Coefficients step(const Evaluation& at, double damping) {
  Mat3d H[2][2];
  Vec3d g[2];
  for (std::size_t j = 0; j < 2; ++j) {
    g[j] = -(glm::transpose(at.derivative[0][j]) * at.error[0] +
             glm::transpose(at.derivative[1][j]) * at.error[1]);
    for (std::size_t l = 0; l < 2; ++l) {
      H[j][l] = glm::transpose(at.derivative[0][j]) * at.derivative[0][l] +
                glm::transpose(at.derivative[1][j]) * at.derivative[1][l];
    }
    for (int k = 0; k < 3; ++k) H[j][j][k][k] += damping * (H[j][j][k][k] + 1e-12);
  }
  const Mat3d inverse = glm::inverse(H[0][0]);
  const Mat3d rest = H[1][1] - H[1][0] * inverse * H[0][1];
  const Vec3d green = glm::inverse(rest) * (g[1] - H[1][0] * inverse * g[0]);
  return {inverse * (g[0] - H[0][1] * green), green};
}

}  // namespace

std::optional<ChannelBasis> channel_basis(const Observer& observer, const Spectrum& d65,
                                          const Development& development) {
  const std::vector<Vec3d> weights = node_weights(observer, d65, development);
  // A long-pass for red, a short-pass for blue, green between them.
  Coefficients q{Vec3d(0.0, 40.0, 0.0), Vec3d(-40.0, 0.0, 4.0)};
  Evaluation at = evaluate(q, weights);
  double damping = 1e-3;
  constexpr double kGoodEnough = 1e-24;  // Of the squares' sum: twelve digits of a channel.
  for (int i = 0; i < 500 && at.cost() > kGoodEnough && damping < 1e12; ++i) {
    const Coefficients d = step(at, damping);
    const Coefficients next{q[0] + d[0], q[1] + d[1]};
    const Evaluation there = evaluate(next, weights);
    if (there.cost() < at.cost()) {
      q = next;
      at = there;
      damping = std::max(damping / 5.0, 1e-12);
    } else {
      damping *= 4.0;
    }
  }
  if (!(at.cost() < 1e-18)) return std::nullopt;

  std::vector<double> nm;
  std::array<std::vector<double>, 3> values;
  for (int i = 0; i < kNodes; ++i) {
    nm.push_back(node_nm(i));
    const std::array<double, 3> b = shares(q, i);
    for (std::size_t c = 0; c < 3; ++c) values[c].push_back(b[c]);
  }
  ChannelBasis basis;
  for (std::size_t c = 0; c < 3; ++c) {
    basis[c] = Spectrum::tabulated(nm, std::move(values[c]), OutsideTable::Clamp);
  }
  return basis;
}

}  // namespace abbe
