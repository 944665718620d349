#include "abbe/film/bands.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "abbe/base/constants.h"
#include "abbe/base/error.h"
#include "abbe/base/text.h"

namespace abbe {
namespace {

constexpr double kSmallestStep_nm = 0.01;
constexpr int kMaxBands = 1000;

[[noreturn]] void reject(const std::string& text, const std::string& expected) {
  throw_usage_error("bands", "'" + text + "'", expected);
}

}  // namespace

std::optional<int> BandOptions::index_of(double wavelength_nm) const {
  if (!(wavelength_nm >= begin_nm && wavelength_nm < low_nm(count))) return std::nullopt;
  int band = std::clamp(static_cast<int>((wavelength_nm - begin_nm) / step_nm), 0, count - 1);
  // The quotient may round across an edge; the edges themselves decide.
  if (wavelength_nm < low_nm(band)) --band;
  if (wavelength_nm >= low_nm(band + 1)) ++band;
  return band;
}

BandOptions parse_bands(const std::string& text) {
  std::vector<double> numbers;
  for (const std::string& part : split(text, ':')) {
    if (const auto number = number_of(part)) numbers.push_back(*number);
  }
  const auto colons = std::count(text.begin(), text.end(), ':');
  if (colons != 2 || numbers.size() != 3) reject(text, "A:B:STEP in nm, as in 360:830:5");
  BandOptions bands{numbers[0], numbers[1], numbers[2], 0};
  if (bands.begin_nm < kRangeMin_nm || bands.end_nm > kRangeMax_nm ||
      bands.begin_nm >= bands.end_nm) {
    reject(text, "bands between 360 and 830 nm, A below B");
  }
  if (bands.step_nm < kSmallestStep_nm) reject(text, "a STEP of at least 0.01 nm");
  const double steps = (bands.end_nm - bands.begin_nm) / bands.step_nm;
  // Decimal steps such as 0.1 are not exact in binary.
  if (std::abs(steps - std::round(steps)) > 1e-6 || std::round(steps) < 1.0) {
    reject(text, "a STEP of which B - A is a whole multiple");
  }
  if (steps > kMaxBands) reject(text, "at most 1000 bands");
  bands.count = static_cast<int>(std::lround(steps));
  return bands;
}

}  // namespace abbe
