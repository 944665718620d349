#include "abbe/spectrum/wavelength_set.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "abbe/base/constants.h"
#include "abbe/base/error.h"

namespace abbe {
namespace {

// Lines closer than this share a lane.
constexpr double kSameLine_nm = 0.01;

int padded(int lanes) {
  return lanes <= 8 ? (lanes + 3) / 4 * 4 : (lanes + 15) / 16 * 16;
}

void check(const WavelengthOptions& options) {
  if (!options.exact_nm.empty()) {
    if (options.exact_nm.size() > static_cast<std::size_t>(kMaxLanes)) {
      throw_usage_error("wavelengths.exact_nm",
                        fmt::format("{} wavelengths", options.exact_nm.size()),
                        fmt::format("at most {}", kMaxLanes));
    }
    for (std::size_t i = 0; i < options.exact_nm.size(); ++i) {
      const double nm = options.exact_nm[i];
      if (!(nm >= kRangeMin_nm && nm <= kRangeMax_nm)) {
        throw_usage_error("wavelengths.exact_nm", fmt::format("{} nm", nm),
                          "wavelengths of 360 to 830 nm");
      }
      if (std::count(options.exact_nm.begin(), options.exact_nm.end(), nm) > 1) {
        throw_usage_error("wavelengths.exact_nm", fmt::format("{} nm twice", nm),
                          "different wavelengths");
      }
    }
    return;
  }
  if (options.count < 1 || options.count > 64) {
    throw_usage_error("wavelengths.count", fmt::format("{}", options.count), "1 to 64");
  }
  if (!(options.range_min_nm >= kRangeMin_nm && options.range_max_nm <= kRangeMax_nm &&
        options.range_min_nm < options.range_max_nm)) {
    throw_usage_error("wavelengths.range_min_nm",
                      fmt::format("{}:{}", options.range_min_nm, options.range_max_nm),
                      "a rising range within 360:830");
  }
}

double luminance(const Spectrum& spectrum, const Observer& observer) {
  return kLuminousEfficacy_lm_per_W * integral(spectrum, observer.y_bar);
}

// The wavelengths of the lamps' lines in the range: the `capacity` strongest, as the observer sees
// them in a lamp of luminance 1; weaker ones are left to the nearest of these.
std::vector<double> line_wavelengths(std::span<const Spectrum> lamps, const Observer& observer,
                                     double range_min_nm, double range_max_nm,
                                     std::size_t capacity) {
  std::vector<SpectralLine> lines;
  for (const Spectrum& lamp : lamps) {
    const double total = luminance(lamp, observer);
    for (const SpectralLine& line : lamp.lines()) {
      if (line.wavelength_nm < range_min_nm || line.wavelength_nm > range_max_nm) continue;
      const double seen = observer.x_bar.value(line.wavelength_nm) +
                          observer.y_bar.value(line.wavelength_nm) +
                          observer.z_bar.value(line.wavelength_nm);
      lines.push_back({line.wavelength_nm, total > 0.0 ? line.strength * seen / total : 0.0});
    }
  }
  std::stable_sort(lines.begin(), lines.end(), [](const SpectralLine& a, const SpectralLine& b) {
    return a.wavelength_nm < b.wavelength_nm;
  });
  std::vector<SpectralLine> merged;
  for (const SpectralLine& line : lines) {
    if (!merged.empty() && line.wavelength_nm - merged.back().wavelength_nm < kSameLine_nm) {
      merged.back().strength += line.strength;
    } else {
      merged.push_back(line);
    }
  }
  std::stable_sort(merged.begin(), merged.end(), [](const SpectralLine& a, const SpectralLine& b) {
    return a.strength > b.strength;
  });
  if (merged.size() > capacity) merged.resize(capacity);
  std::vector<double> result;
  result.reserve(merged.size());
  for (const SpectralLine& line : merged) result.push_back(line.wavelength_nm);
  std::sort(result.begin(), result.end());
  return result;
}

// The lamps whose integrals the observer's weights make exact: one for every four lanes, so that
// their number leaves the weights room. Where there are more, the mix stands for those left out.
std::vector<Spectrum> lamps_to_be_exact(std::span<const Spectrum> lamps, const Spectrum& mix,
                                        const Observer& observer, int lanes) {
  std::vector<Spectrum> result;
  for (const Spectrum& lamp : lamps) {
    const double seen = luminance(lamp, observer);
    if (seen > 0.0 && !lamp.is_lines_only()) result.push_back(lamp.scaled(1.0 / seen));
  }
  const std::size_t room = std::clamp<std::size_t>(static_cast<std::size_t>(lanes) / 4, 1,
                                                   WavelengthQuadrature::kMaxExactLamps);
  if (result.empty() || result.size() > room) {
    result.resize(result.empty() ? 0 : room - 1);
    result.push_back(mix);
  }
  return result;
}

// Of narrow bands, what lies in the range and can be seen.
std::vector<NarrowBand> bands_to_resolve(std::span<const NarrowBand> bands, const Spectrum& mix,
                                         const Observer& observer, double range_min_nm,
                                         double range_max_nm) {
  constexpr double kLeastSeen = 0.01;  // Of tristimulus curves whose sum reaches 2.
  std::vector<NarrowBand> result;
  for (const NarrowBand& whole : bands) {
    const NarrowBand band{std::max(whole.low_nm, range_min_nm),
                          std::min(whole.high_nm, range_max_nm)};
    const double nm = 0.5 * (band.low_nm + band.high_nm);
    const double seen =
        observer.x_bar.value(nm) + observer.y_bar.value(nm) + observer.z_bar.value(nm);
    if (band.low_nm < band.high_nm && seen > kLeastSeen && mix.value(nm) > 0.0) {
      result.push_back(band);
    }
  }
  return result;
}

std::size_t nearest(const std::vector<double>& sorted, double value) {
  const auto above = std::lower_bound(sorted.begin(), sorted.end(), value);
  if (above == sorted.begin()) return 0;
  const auto i = static_cast<std::size_t>(above - sorted.begin());
  if (above == sorted.end()) return i - 1;
  return sorted[i] - value < value - sorted[i - 1] ? i : i - 1;
}

}  // namespace

WavelengthQuadrature::WavelengthQuadrature(const WavelengthOptions& options,
                                           const Observer& observer,
                                           std::span<const Spectrum> lamps,
                                           const ResolvedBands& resolved)
    : range_min_nm_(options.range_min_nm), range_max_nm_(options.range_max_nm) {
  check(options);

  if (!options.exact_nm.empty()) {
    kinds_.assign(options.exact_nm.size(), LaneKind::Exact);
  } else {
    const bool lines_only =
        !lamps.empty() && std::all_of(lamps.begin(), lamps.end(),
                                      [](const Spectrum& lamp) { return lamp.is_lines_only(); });
    continuous_count_ = options.count;
    line_nm_ = line_wavelengths(lamps, observer, range_min_nm_, range_max_nm_,
                                static_cast<std::size_t>(kMaxLanes - continuous_count_));
    if (lines_only && !line_nm_.empty()) continuous_count_ = 0;
    kinds_.assign(static_cast<std::size_t>(continuous_count_), LaneKind::Continuous);
    kinds_.insert(kinds_.end(), line_nm_.size(), LaneKind::Line);
  }
  lane_count_ = static_cast<int>(kinds_.size());
  lane_stride_ = padded(lane_count_);
  kinds_.resize(static_cast<std::size_t>(lane_stride_), LaneKind::Padding);
  set_count_ = continuous_count_ > 0 ? kShiftCount : 1;

  const Spectrum mix = lamp_mix(lamps, observer);
  exact_lamps_ = lamps_to_be_exact(lamps, mix, observer, continuous_count_);
  const WavelengthDensity density(mix, observer, range_min_nm_, range_max_nm_);
  bands_ = bands_to_resolve(resolved.bands, mix, observer, range_min_nm_, range_max_nm_);
  const std::size_t lanes_for_bands =
      std::min(bands_.size(), static_cast<std::size_t>(continuous_count_) / 4);
  if (lanes_for_bands == 0) {
    bands_.clear();
    place_lanes(options, density);
    return;
  }
  const WavelengthDensity with_bands =
      density.with_bands(bands_, static_cast<double>(lanes_for_bands) / continuous_count_);
  place_lanes(options, with_bands);
  smooth_density_ = density;
  set_cells(with_bands, resolved.shifts);
}

void WavelengthQuadrature::place_lanes(const WavelengthOptions& options,
                                       const WavelengthDensity& density) {
  for (int set = 0; set < set_count_; ++set) {
    const double shift = (set + 0.5) / kShiftCount;
    double wavelength_nm = range_min_nm_;
    for (int lane = 0; lane < lane_stride_; ++lane) {
      double weight_nm = 0.0;
      switch (kinds_[static_cast<std::size_t>(lane)]) {
        case LaneKind::Continuous:
          wavelength_nm = density.quantile((lane + shift) / continuous_count_);
          weight_nm = 1.0 / (continuous_count_ * density.value(wavelength_nm));
          break;
        case LaneKind::Line:
          wavelength_nm = line_nm_[static_cast<std::size_t>(lane - continuous_count_)];
          weight_nm = 1.0;
          break;
        case LaneKind::Exact:
          wavelength_nm = options.exact_nm[static_cast<std::size_t>(lane)];
          weight_nm = 1.0;
          break;
        case LaneKind::Padding:
          break;
      }
      wavelengths_nm_.push_back(static_cast<float>(wavelength_nm));
      weights_nm_.push_back(static_cast<float>(weight_nm));
    }
  }
}

// Sets in the order of their shifts divide every stratum into parts, one for each sample that has
// them: equal weights, whatever the number of samples. A set of no sample stands for itself alone.
void WavelengthQuadrature::set_cells(const WavelengthDensity& density,
                                     std::span<const float> shifts) {
  std::vector<int> uses(static_cast<std::size_t>(set_count_), 0);
  for (const float shift : shifts) ++uses[static_cast<std::size_t>(set_of(shift))];
  const auto samples = static_cast<double>(shifts.size());
  cells_.resize(wavelengths_nm_.size());
  int before = 0;
  for (int set = 0; set < set_count_; ++set) {
    const int own = uses[static_cast<std::size_t>(set)];
    const double low = own > 0 ? before / samples : 0.0;
    const double high = own > 0 ? (before + own) / samples : 1.0;
    before += own;
    for (int lane = 0; lane < continuous_count_; ++lane) {
      const auto i = static_cast<std::size_t>(set * lane_stride_ + lane);
      const Cell cell{density.quantile((lane + low) / continuous_count_),
                      density.quantile((lane + high) / continuous_count_)};
      cells_[i] = cell;
      // What varies as the density does but for its bands is integrated over the cell.
      weights_nm_[i] = static_cast<float>(
          (smooth_density_->share_below(cell.high_nm) - smooth_density_->share_below(cell.low_nm)) /
          (high - low) / smooth_density_->value(double{wavelengths_nm_[i]}));
    }
  }
}

int WavelengthQuadrature::set_of(float shift) const {
  return static_cast<int>(shift * static_cast<float>(set_count_));
}

std::span<const float> WavelengthQuadrature::wavelengths_nm(int set) const {
  const auto stride = static_cast<std::size_t>(lane_stride_);
  return std::span<const float>(wavelengths_nm_)
      .subspan(static_cast<std::size_t>(set) * stride, stride);
}

std::span<const float> WavelengthQuadrature::weights_nm(int set) const {
  const auto stride = static_cast<std::size_t>(lane_stride_);
  return std::span<const float>(weights_nm_)
      .subspan(static_cast<std::size_t>(set) * stride, stride);
}

std::vector<float> WavelengthQuadrature::tabulate(const Spectrum& quantity) const {
  return tabulate([&quantity](double wavelength_nm) { return quantity.value(wavelength_nm); });
}

std::vector<float> WavelengthQuadrature::tabulate(
    const std::function<double(double wavelength_nm)>& quantity) const {
  std::vector<float> result;
  result.reserve(wavelengths_nm_.size());
  for (const float wavelength_nm : wavelengths_nm_) {
    result.push_back(static_cast<float>(quantity(wavelength_nm)));
  }
  return result;
}

std::vector<float> WavelengthQuadrature::tabulate_reflectance(const Spectrum& reflectance) const {
  std::vector<float> result = tabulate(reflectance);
  if (reflectance.table_points_nm().empty()) return result;
  for (std::size_t i = 0; i < cells_.size(); ++i) {
    if (kinds_[i % static_cast<std::size_t>(lane_stride_)] != LaneKind::Continuous) continue;
    result[i] =
        static_cast<float>(smooth_density_->mean(reflectance, cells_[i].low_nm, cells_[i].high_nm));
  }
  return result;
}

std::vector<float> WavelengthQuadrature::tabulate_emission(const Spectrum& emission) const {
  std::vector<float> result = tabulate(emission);
  const auto stride = static_cast<std::size_t>(lane_stride_);
  for (std::size_t i = 0; i < result.size(); ++i) {
    const LaneKind kind = kinds_[i % stride];
    if (kind == LaneKind::Line || kind == LaneKind::Padding) result[i] = 0.0f;
  }
  for (const SpectralLine& line : emission.lines()) {
    std::size_t lane = stride;
    if (!line_nm_.empty()) {
      if (line.wavelength_nm < range_min_nm_ || line.wavelength_nm > range_max_nm_) continue;
      lane = static_cast<std::size_t>(continuous_count_) + nearest(line_nm_, line.wavelength_nm);
    } else {
      for (std::size_t i = 0; i < static_cast<std::size_t>(lane_count_); ++i) {
        const double apart_nm = std::abs(double{wavelengths_nm_[i]} - line.wavelength_nm);
        if (kinds_[i] == LaneKind::Exact && apart_nm <= kSameLine_nm) lane = i;
      }
    }
    if (lane == stride) continue;
    for (std::size_t set = 0; set < static_cast<std::size_t>(set_count_); ++set) {
      result[set * stride + lane] += static_cast<float>(line.strength);
    }
  }
  return result;
}

}  // namespace abbe
