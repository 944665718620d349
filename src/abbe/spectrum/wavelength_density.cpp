#include "abbe/spectrum/wavelength_density.h"

#include <algorithm>
#include <cmath>

#include "abbe/base/constants.h"

namespace abbe {
namespace {

// Chosen by measurement: mean chroma error C*ab of one sample of 16 wavelengths, white under D65,
// was 3.7 with power 1 and 0.62 with the uniform density; it is 0.11 to 0.17 for powers 0.25 to
// 0.35 at this share and width, which are no sharp optimum either.
constexpr double kPower = 0.3;
constexpr double kUniformShare = 0.1;
constexpr double kSmoothing_nm = 25.0;  // standard deviation of a Gaussian

void sort_and_unite(std::vector<double>& points) {
  std::sort(points.begin(), points.end());
  points.erase(std::unique(points.begin(), points.end()), points.end());
}

Spectrum smoothed(const Spectrum& spectrum) {
  std::vector<double> points, values;
  for (double nm = kRangeMin_nm; nm <= kRangeMax_nm; nm += 1.0) points.push_back(nm);
  for (const double nm : points) {
    double sum = 0.0, total_weight = 0.0;
    for (const double at_nm : points) {
      const double t = (at_nm - nm) / kSmoothing_nm;
      const double weight = std::exp(-0.5 * t * t);
      sum += weight * spectrum.value(at_nm);
      total_weight += weight;
    }
    values.push_back(sum / total_weight);
  }
  return Spectrum::tabulated(std::move(points), std::move(values), OutsideTable::Clamp);
}

}  // namespace

Spectrum lamp_mix(std::span<const Spectrum> lamps, const Observer& observer) {
  std::vector<double> points;
  for (double nm = kRangeMin_nm; nm <= kRangeMax_nm; nm += 1.0) points.push_back(nm);
  std::vector<Spectrum> scaled;
  for (const Spectrum& lamp : lamps) {
    const double luminance = kLuminousEfficacy_lm_per_W * integral(lamp, observer.y_bar);
    if (!(luminance > 0.0) || lamp.is_lines_only()) continue;
    scaled.push_back(lamp.scaled(1.0 / luminance));
    for (const double nm : lamp.table_points_nm()) {
      if (nm > kRangeMin_nm && nm < kRangeMax_nm) points.push_back(nm);
    }
  }
  if (scaled.empty()) return Spectrum::constant(1.0);
  sort_and_unite(points);
  std::vector<double> values;
  for (const double nm : points) {
    double sum = 0.0;
    for (const Spectrum& lamp : scaled) sum += lamp.value(nm);
    values.push_back(sum);
  }
  return Spectrum::tabulated(std::move(points), std::move(values), OutsideTable::Zero);
}

WavelengthDensity::WavelengthDensity(const Spectrum& lamps, const Observer& observer,
                                     double range_min_nm, double range_max_nm) {
  for (double nm = kRangeMin_nm; nm < kRangeMax_nm; nm += 1.0) wavelength_nm_.push_back(nm);
  for (const double nm : lamps.table_points_nm()) wavelength_nm_.push_back(nm);
  wavelength_nm_.push_back(range_min_nm);
  wavelength_nm_.push_back(range_max_nm);
  std::erase_if(wavelength_nm_, [&](double nm) { return nm < range_min_nm || nm > range_max_nm; });
  sort_and_unite(wavelength_nm_);

  const Spectrum smooth = smoothed(lamps);
  for (const double nm : wavelength_nm_) {
    const double seen =
        observer.x_bar.value(nm) + observer.y_bar.value(nm) + observer.z_bar.value(nm);
    const double base = smooth.value(nm);
    const bool counts = seen > 0.0 && base > 0.0 && lamps.value(nm) > 0.0;
    density_per_nm_.push_back(counts ? lamps.value(nm) / base * std::pow(seen * base, kPower)
                                     : 0.0);
  }
  const auto accumulate = [this] {
    cumulative_.assign(1, 0.0);
    for (std::size_t i = 1; i < wavelength_nm_.size(); ++i) {
      cumulative_.push_back(cumulative_.back() + 0.5 *
                                                     (density_per_nm_[i] + density_per_nm_[i - 1]) *
                                                     (wavelength_nm_[i] - wavelength_nm_[i - 1]));
    }
    return cumulative_.back();
  };
  const double seen_total = accumulate();
  const double uniform_share = seen_total > 0.0 ? kUniformShare : 1.0;
  for (double& density : density_per_nm_) {
    if (seen_total > 0.0) density *= (1.0 - uniform_share) / seen_total;
    density += uniform_share / (range_max_nm - range_min_nm);
  }
  // The mass is 1 but for rounding; make it so.
  const double total = accumulate();
  for (double& density : density_per_nm_) density /= total;
  for (double& mass : cumulative_) mass /= total;
}

double WavelengthDensity::value(double wavelength_nm) const {
  const auto above =
      std::upper_bound(wavelength_nm_.begin() + 1, wavelength_nm_.end() - 1, wavelength_nm);
  const auto i = static_cast<std::size_t>(above - wavelength_nm_.begin());
  const double t =
      (wavelength_nm - wavelength_nm_[i - 1]) / (wavelength_nm_[i] - wavelength_nm_[i - 1]);
  return density_per_nm_[i - 1] + t * (density_per_nm_[i] - density_per_nm_[i - 1]);
}

double WavelengthDensity::quantile(double u) const {
  const auto above = std::upper_bound(cumulative_.begin() + 1, cumulative_.end() - 1, u);
  const auto i = static_cast<std::size_t>(above - cumulative_.begin());
  const double width = wavelength_nm_[i] - wavelength_nm_[i - 1];
  const double low = density_per_nm_[i - 1];
  const double slope = (density_per_nm_[i] - low) / width;
  const double mass = std::max(u - cumulative_[i - 1], 0.0);
  // Solves low·x + slope·x²/2 = mass in the form that does not cancel for small slopes.
  const double root = std::sqrt(std::max(low * low + 2.0 * slope * mass, 0.0));
  return wavelength_nm_[i - 1] + std::clamp(2.0 * mass / (low + root), 0.0, width);
}

}  // namespace abbe
