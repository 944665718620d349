#include "abbe/spectrum/narrow_bands.h"

#include <algorithm>
#include <cmath>
#include <deque>

#include "abbe/base/constants.h"

namespace abbe {
namespace {

// 16 samples of 16 wavelengths lie about 1.2 nm apart, so that a band of this width or more has
// seven of them.
constexpr double kNarrow_nm = 8.0;
// A band as high as this makes it one; it reaches to where hardly anything of it is left.
constexpr double kHigh = 0.15;
constexpr double kLow = 0.02;
constexpr double kStep_nm = 0.1;
constexpr double kRounding_nm = 1e-6;

// The points of its table, the ends of the intervals around them, and a grid between.
std::vector<double> places(const Spectrum& spectrum) {
  std::vector<double> result;
  const int steps = static_cast<int>(std::round((kRangeMax_nm - kRangeMin_nm) / kStep_nm));
  for (int i = 0; i <= steps; ++i) result.push_back(kRangeMin_nm + kStep_nm * i);
  for (const double nm : spectrum.table_points_nm()) {
    for (const double at_nm : {nm - 0.5 * kNarrow_nm, nm, nm + 0.5 * kNarrow_nm}) {
      if (at_nm > kRangeMin_nm && at_nm < kRangeMax_nm) result.push_back(at_nm);
    }
  }
  std::sort(result.begin(), result.end());
  return result;
}

// The least value in the interval around each place.
std::vector<double> eroded(const std::vector<double>& nm, const std::vector<double>& values) {
  constexpr double kReach_nm = 0.5 * kNarrow_nm + kRounding_nm;
  std::vector<double> result;
  std::deque<std::size_t> least;  // Those that may become the least, by rising value.
  std::size_t next = 0;
  for (const double at_nm : nm) {
    for (; next < nm.size() && nm[next] <= at_nm + kReach_nm; ++next) {
      while (!least.empty() && values[least.back()] >= values[next]) least.pop_back();
      least.push_back(next);
    }
    while (nm[least.front()] < at_nm - kReach_nm) least.pop_front();
    result.push_back(values[least.front()]);
  }
  return result;
}

std::vector<double> negated(std::vector<double> values) {
  for (double& value : values) value = -value;
  return values;
}

// By how much values stand out from the largest function below them that is nowhere narrow.
std::vector<double> top_hat(const std::vector<double>& nm, const std::vector<double>& values) {
  const std::vector<double> closed = eroded(nm, negated(eroded(nm, values)));
  std::vector<double> result;
  for (std::size_t i = 0; i < nm.size(); ++i) result.push_back(values[i] + closed[i]);
  return result;
}

void add_bands(const Spectrum& spectrum, std::vector<NarrowBand>& bands) {
  if (spectrum.table_points_nm().size() < 3) return;
  const std::vector<double> nm = places(spectrum);
  std::vector<double> values;
  values.reserve(nm.size());
  for (const double at_nm : nm) values.push_back(spectrum.value(at_nm));
  const std::vector<double> above = top_hat(nm, values);
  const std::vector<double> below = top_hat(nm, negated(values));
  const auto stands_out = [&](std::size_t i) { return std::max(above[i], below[i]); };
  for (std::size_t i = 0; i < nm.size(); ++i) {
    if (stands_out(i) <= kLow) continue;
    const std::size_t first = i;
    double highest = 0.0;
    for (; i < nm.size() && stands_out(i) > kLow; ++i) highest = std::max(highest, stands_out(i));
    if (highest <= kHigh) continue;
    bands.push_back({nm[std::max<std::size_t>(first, 1) - 1], nm[std::min(i, nm.size() - 1)]});
  }
}

}  // namespace

std::vector<NarrowBand> narrow_bands(std::span<const Spectrum> spectra) {
  std::vector<NarrowBand> bands;
  for (const Spectrum& spectrum : spectra) add_bands(spectrum, bands);
  std::sort(bands.begin(), bands.end(),
            [](const NarrowBand& a, const NarrowBand& b) { return a.low_nm < b.low_nm; });
  std::vector<NarrowBand> united;
  for (const NarrowBand& band : bands) {
    if (!united.empty() && band.low_nm <= united.back().high_nm) {
      united.back().high_nm = std::max(united.back().high_nm, band.high_nm);
    } else {
      united.push_back(band);
    }
  }
  std::vector<NarrowBand> pieces;
  for (const NarrowBand& band : united) {
    const double width_nm = band.high_nm - band.low_nm;
    const int count = static_cast<int>(std::ceil(width_nm / kNarrow_nm));
    for (int i = 0; i < count; ++i) {
      pieces.push_back(
          {band.low_nm + width_nm * i / count, band.low_nm + width_nm * (i + 1) / count});
    }
  }
  return pieces;
}

}  // namespace abbe
