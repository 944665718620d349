#include "abbe/optics/rough/microfacet_loss.h"

#include <algorithm>
#include <cmath>

#include "abbe/base/constants.h"
#include "abbe/optics/rough/smith.h"

namespace abbe {
namespace {

// The part of visible microfacets that does not send light out, integrated over their slopes. With
// u = 1 − (1 − w)² of P22's radial distribution far ones have no pole, w = q² is even about the
// middle, and x, of which q is a smooth step, has nothing at its ends.
double lost_share(double cosine, double alpha) {
  constexpr int kPlaces = 48, kTurns = 21;
  const double sine = std::sqrt(1.0 - cosine * cosine);
  const double of_view = smith_lambda(cosine, alpha);
  double lost = 0.0;
  for (int j = 0; j < kTurns; ++j) {
    // A lattice of Fibonacci's: what has an edge along a column, as the horizon has, is met evenly.
    const double shift = (8 * j % kTurns + 0.5) / kTurns;
    for (int i = 0; i < kPlaces; ++i) {
      const double x = (i + shift) / kPlaces;
      const double q = x * x * (3.0 - 2.0 * x);
      const double rest = 1.0 - q * q;
      const double steep = alpha * std::sqrt(1.0 - rest * rest) / rest;
      const double facing = cosine + sine * steep * std::cos(kPi * (j + 0.5) / kTurns);
      if (!(facing > 0.0)) continue;
      const double out = 2.0 * facing / (1.0 + steep * steep) - cosine;
      const double let_by =
          out > 0.0 ? (1.0 + of_view) / (1.0 + of_view + smith_lambda(out, alpha)) : 0.0;
      lost +=
          24.0 * x * (1.0 - x) * q * rest * facing / (cosine * (1.0 + of_view)) * (1.0 - let_by);
    }
  }
  return lost / (kPlaces * kTurns);
}

struct Place {
  int below;
  float part;
};

Place place_of(float value, int steps) {
  const float place = std::clamp(value, 0.0f, 1.0f) * static_cast<float>(steps);
  const int below = std::min(static_cast<int>(place), steps - 1);
  return {below, place - static_cast<float>(below)};
}

float mixed(float a, float b, float part) {
  return a + part * (b - a);
}

// A column between two rows.
template <class Table>
float mixed(const Table& table, const Place& row, int column) {
  const auto r = static_cast<std::size_t>(row.below);
  const auto c = static_cast<std::size_t>(column);
  return mixed(table[r][c], table[r + 1][c], row.part);
}

// The square of μ, a fourth power, at a node of so many steps.
float square_at(int node, int steps) {
  return std::pow(static_cast<float>(node) / static_cast<float>(steps), 4.0f);
}

}  // namespace

const MicrofacetLoss& MicrofacetLoss::table() {
  static const MicrofacetLoss kTable;
  return kTable;
}

// At a cosine of 0 and at roughness 0 nothing is lost.
MicrofacetLoss::MicrofacetLoss() {
  for (std::size_t r = 1; r < kNodes; ++r) {
    const double roughness = static_cast<double>(r) / kSteps;
    double below = 0.0;
    for (std::size_t c = 1; c < kNodes; ++c) {
      const double high = static_cast<double>(c) / kSteps, low = high - 1.0 / kSteps;
      lost_[r][c] = static_cast<float>(lost_share(high * high, roughness * roughness));
      // 2μ dμ = 4t³ dt of the line from `low` to `high` in t, the root of the cosine.
      const double before = static_cast<double>(lost_[r][c - 1]);
      const double slope = (static_cast<double>(lost_[r][c]) - before) * kSteps;
      below += (before - slope * low) * (std::pow(high, 4) - std::pow(low, 4)) +
               slope * 0.8 * (std::pow(high, 5) - std::pow(low, 5));
      below_[r][c] = static_cast<float>(below);
    }
  }
}

float MicrofacetLoss::at(float cosine, float alpha) const {
  const Place r = place_of(std::sqrt(alpha), kSteps);
  const Place c = place_of(std::sqrt(std::max(cosine, 0.0f)), kSteps);
  return mixed(mixed(lost_, r, c.below), mixed(lost_, r, c.below + 1), c.part);
}

float MicrofacetLoss::mean(float alpha) const {
  return mixed(below_, place_of(std::sqrt(alpha), kSteps), kSteps);
}

float MicrofacetLoss::draw(float alpha, float u) const {
  const Place r = place_of(std::sqrt(alpha), kSteps);
  const float all = mixed(below_, r, kSteps);
  int step = 0;
  while (step < kSteps - 1 && mixed(below_, r, step + 1) <= u * all) ++step;
  const float low = mixed(below_, r, step);
  const float within = mixed(below_, r, step + 1) - low;
  if (!(within > 0.0f)) return std::sqrt(square_at(step, kSteps));
  // As if the loss were the same all over the step: μ² is even there.
  const float part = std::clamp((u * all - low) / within, 0.0f, 1.0f);
  return std::sqrt(square_at(step, kSteps) +
                   part * (square_at(step + 1, kSteps) - square_at(step, kSteps)));
}

float MicrofacetLoss::density(float cosine, float alpha) const {
  if (!(cosine > 0.0f)) return 0.0f;
  const Place r = place_of(std::sqrt(alpha), kSteps);
  const int step = place_of(std::sqrt(cosine), kSteps).below;
  const float within = mixed(below_, r, step + 1) - mixed(below_, r, step);
  return within /
         ((square_at(step + 1, kSteps) - square_at(step, kSteps)) * mixed(below_, r, kSteps));
}

}  // namespace abbe
