// The weights by which radiance on the lanes of a wavelength set becomes tristimulus values.
#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "abbe/base/constants.h"
#include "abbe/spectrum/wavelength_set.h"

namespace abbe {
namespace {

constexpr std::size_t kMaxLamps = WavelengthQuadrature::kMaxExactLamps;
using Row = std::array<double, kMaxLamps + 1>;

// Solves the positive definite system of `size` equations, the right-hand side in the last place of
// each row, by elimination; the solution is left there.
void solve(std::array<Row, kMaxLamps>& rows, std::size_t size) {
  for (std::size_t column = 0; column < size; ++column) {
    for (std::size_t row = 0; row < size; ++row) {
      if (row == column) continue;
      const double factor = rows[row][column] / rows[column][column];
      for (std::size_t k = column; k < size; ++k) rows[row][k] -= factor * rows[column][k];
      rows[row][kMaxLamps] -= factor * rows[column][kMaxLamps];
    }
  }
  for (std::size_t row = 0; row < size; ++row) rows[row][kMaxLamps] /= rows[row][row];
}

// Factors by which the weights of one set and channel are corrected, close to 1.
//
// With w the uncorrected weights (cmf included) and l_j a lamp, lane by lane, the correction 1 + e
// has to satisfy Σ w (1 + e) l_j = exact_j for every lamp. Of all solutions the one with the least
// Σ w m e² is taken, m being the mix of the lamps: e = Σ_j c_j l_j/m, where c solves the small
// system Σ_k c_k Σ w l_j l_k/m = exact_j − Σ w l_j. Lamps that look alike make it nearly singular;
// a relative 1e-7 on its diagonal keeps it solvable and costs as much accuracy. Lanes of mix 0 stay
// as they are.
std::vector<double> corrections(const std::vector<double>& weights,
                                const std::vector<std::vector<double>>& lamps,
                                const std::vector<double>& mix, const std::vector<double>& exact) {
  constexpr double kRegularisation = 1e-7;
  const std::size_t count = lamps.size();
  std::array<Row, kMaxLamps> rows{};
  for (std::size_t j = 0; j < count; ++j) {
    rows[j][kMaxLamps] = exact[j];
    for (std::size_t lane = 0; lane < mix.size(); ++lane) {
      rows[j][kMaxLamps] -= weights[lane] * lamps[j][lane];
      if (!(mix[lane] > 0.0)) continue;
      for (std::size_t k = 0; k < count; ++k) {
        rows[j][k] += weights[lane] * lamps[j][lane] * lamps[k][lane] / mix[lane];
      }
    }
  }
  double largest = 0.0;
  for (std::size_t j = 0; j < count; ++j) largest = std::max(largest, rows[j][j]);
  std::vector<double> factors(mix.size(), 1.0);
  if (!(largest > 0.0)) return factors;
  for (std::size_t j = 0; j < count; ++j) rows[j][j] += kRegularisation * largest;
  solve(rows, count);
  for (std::size_t lane = 0; lane < mix.size(); ++lane) {
    if (!(mix[lane] > 0.0)) continue;
    for (std::size_t j = 0; j < count; ++j) {
      factors[lane] += rows[j][kMaxLamps] * lamps[j][lane] / mix[lane];
    }
  }
  return factors;
}

// The correction pays while it is small; past this, lamps and lanes fit so badly that its ripple
// would be worse than the noise it removes.
constexpr double kLargestCorrection = 0.15;

bool is_small(const std::vector<double>& factors) {
  return std::all_of(factors.begin(), factors.end(), [](double factor) {
    return std::abs(factor - 1.0) <= kLargestCorrection;  // false for what is not a number, too
  });
}

}  // namespace

std::vector<float> WavelengthQuadrature::observer_weights(const Observer& observer) const {
  const auto stride = static_cast<std::size_t>(lane_stride_);
  const auto sets = static_cast<std::size_t>(set_count_);
  const auto continuous = static_cast<std::size_t>(continuous_count_);
  std::vector<float> result(sets * 3 * stride, 0.0f);
  const auto is_in_band = [this](float nm) {
    return std::any_of(bands_.begin(), bands_.end(), [nm](const NarrowBand& band) {
      return band.low_nm <= double{nm} && double{nm} <= band.high_nm;
    });
  };

  // A lamp that ends with a jump at the edge of the rendered range.
  const Spectrum range =
      Spectrum::tabulated({range_min_nm_, range_max_nm_}, {1.0, 1.0}, OutsideTable::Zero);
  std::vector<Spectrum> lamps_in_range;
  for (const Spectrum& lamp : exact_lamps_) lamps_in_range.push_back(product(lamp, range));

  // All sets are corrected or none: a mixture of both would not converge to the truth.
  std::vector<float> corrected = result;
  bool all_small = !exact_lamps_.empty();

  std::size_t channel = 0;
  for (const Spectrum* cmf : {&observer.x_bar, &observer.y_bar, &observer.z_bar}) {
    std::vector<double> exact;
    for (const Spectrum& lamp : lamps_in_range) exact.push_back(integral(lamp, *cmf));
    for (std::size_t set = 0; set < sets; ++set) {
      const float* nm = &wavelengths_nm_[set * stride];
      std::vector<double> weights(stride), mix(continuous, 0.0);
      std::vector<std::vector<double>> lamps(exact_lamps_.size(), std::vector<double>(continuous));
      for (std::size_t lane = 0; lane < stride; ++lane) {
        weights[lane] = double{weights_nm_[set * stride + lane]} * cmf->value(nm[lane]);
        if (lane >= continuous) continue;
        for (std::size_t j = 0; j < lamps.size(); ++j) {
          lamps[j][lane] = exact_lamps_[j].value(nm[lane]);
          mix[lane] += lamps[j][lane];
        }
        // Over a narrow band a ripple would not average out.
        if (is_in_band(nm[lane])) mix[lane] = 0.0;
      }
      std::vector<double> factors = corrections(weights, lamps, mix, exact);
      all_small = all_small && is_small(factors);
      factors.resize(stride, 1.0);
      for (std::size_t lane = 0; lane < stride; ++lane) {
        const std::size_t i = (set * 3 + channel) * stride + lane;
        result[i] = static_cast<float>(kLuminousEfficacy_lm_per_W * weights[lane]);
        corrected[i] =
            static_cast<float>(kLuminousEfficacy_lm_per_W * weights[lane] * factors[lane]);
      }
    }
    ++channel;
  }
  return all_small ? corrected : result;
}

}  // namespace abbe
