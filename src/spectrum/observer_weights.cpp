// The weights by which radiance on the lanes of a wavelength set becomes tristimulus values.
#include <algorithm>
#include <array>
#include <cmath>

#include "base/constants.h"
#include "spectrum/wavelength_set.h"

namespace abbe {
namespace {

int kDegree = -2;

// Solves the symmetric system of up to 4 unknowns by elimination with pivots; false if singular.
constexpr int kMostTerms = 4;
using System = std::array<std::array<double, kMostTerms + 1>, kMostTerms>;

bool solve(System& system, int size, std::array<double, kMostTerms>& solution) {
  for (int column = 0; column < size; ++column) {
    int pivot = column;
    for (int row = column + 1; row < size; ++row) {
      if (std::abs(system[row][column]) > std::abs(system[pivot][column])) pivot = row;
    }
    if (std::abs(system[pivot][column]) < 1e-12) return false;
    std::swap(system[pivot], system[column]);
    for (int row = 0; row < size; ++row) {
      if (row == column) continue;
      const double factor = system[row][column] / system[column][column];
      for (int k = column; k <= size; ++k) system[row][k] -= factor * system[column][k];
    }
  }
  for (int row = 0; row < size; ++row) solution[row] = system[row][size] / system[row][row];
  return true;
}

}  // namespace

std::vector<float> WavelengthQuadrature::observer_weights(const Observer& observer) const {
  const auto stride = static_cast<std::size_t>(lane_stride_);
  const auto sets = static_cast<std::size_t>(set_count_);
  const auto continuous = static_cast<std::size_t>(continuous_count_);
  std::vector<float> result(sets * 3 * stride, 0.0f);
  const int terms = std::min(kDegree + 1, kMostTerms);

  std::size_t channel = 0;
  for (const Spectrum* cmf : {&observer.x_bar, &observer.y_bar, &observer.z_bar}) {
    const double centre_nm = 0.5 * (range_min_nm_ + range_max_nm_);
    const double half_nm = 0.5 * (range_max_nm_ - range_min_nm_);
    std::array<double, 2 * kMostTerms> exact{};
    (void)exact;
    std::vector<double> powers_exact(static_cast<std::size_t>(std::max(terms, 0)), 0.0);
    {
      // integrate over range by 0.25nm midpoint for the experiment
      for (double nm = range_min_nm_ + 0.05; nm < range_max_nm_; nm += 0.1) {
        double f = 0.1 * cmf->value(nm) * lamp_mix_.value(nm);
        for (double& e : powers_exact) {
          e += f;
          f *= (nm - centre_nm) / half_nm;
        }
      }
    }
    for (std::size_t set = 0; set < sets; ++set) {
      float* lanes = &result[(set * 3 + channel) * stride];
      std::vector<double> base(stride);
      for (std::size_t lane = 0; lane < stride; ++lane) {
        const std::size_t i = set * stride + lane;
        base[lane] = double{weights_nm_[i]} * cmf->value(wavelengths_nm_[i]);
      }
      if (terms > 0) {
        System system{};
        for (std::size_t lane = 0; lane < continuous; ++lane) {
          const double nm = wavelengths_nm_[set * stride + lane];
          const double s = (nm - centre_nm) / half_nm;
          const double contribution = base[lane] * lamp_mix_.value(nm);
          double sr = contribution;
          for (int r = 0; r < terms; ++r) {
            double src = sr;
            for (int c = 0; c < terms; ++c) {
              system[r][c] += src;
              src *= s;
            }
            system[r][terms] -= sr;
            sr *= s;
          }
        }
        for (int r = 0; r < terms; ++r) system[r][terms] += powers_exact[r];
        std::array<double, kMostTerms> e{};
        if (solve(system, terms, e)) {
          for (std::size_t lane = 0; lane < continuous; ++lane) {
            const double s = (wavelengths_nm_[set * stride + lane] - centre_nm) / half_nm;
            double p = 0;
            for (int r = terms - 1; r >= 0; --r) p = p * s + e[r];
            base[lane] *= 1 + p;
          }
        }
      }
      for (std::size_t lane = 0; lane < stride; ++lane) {
        lanes[lane] = static_cast<float>(kLuminousEfficacy_lm_per_W * base[lane]);
      }
    }
    ++channel;
  }
  return result;
}

}  // namespace abbe
