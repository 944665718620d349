#include "abbe/film/bands.h"

#include <fmt/format.h>

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

}  // namespace

int BandOptions::count() const {
  return static_cast<int>(std::lround((end_nm - begin_nm) / step_nm));
}

std::optional<int> BandOptions::index_of(double wavelength_nm) const {
  const int bands = count();
  if (!(wavelength_nm >= begin_nm && wavelength_nm < low_nm(bands))) return std::nullopt;
  int band = std::clamp(static_cast<int>((wavelength_nm - begin_nm) / step_nm), 0, bands - 1);
  // The quotient may round across an edge; the edges themselves decide.
  if (wavelength_nm < low_nm(band)) --band;
  if (wavelength_nm >= low_nm(band + 1)) ++band;
  return band;
}

void check_bands(const BandOptions& bands) {
  const auto require = [&bands](bool good, const char* expected) {
    if (!good) throw_usage_error("bands", in_quotes(bands_text(bands)), expected);
  };
  // Written so that not-a-number fails.
  require(bands.begin_nm >= kRangeMin_nm && bands.end_nm <= kRangeMax_nm &&
              bands.begin_nm < bands.end_nm,
          "bands between 360 and 830 nm, A below B");
  require(bands.step_nm >= kSmallestStep_nm, "a STEP of at least 0.01 nm");
  const double steps = (bands.end_nm - bands.begin_nm) / bands.step_nm;
  // Decimal steps such as 0.1 are not exact in binary.
  require(std::abs(steps - std::round(steps)) <= 1e-6 && std::round(steps) >= 1.0,
          "a STEP of which B - A is a whole multiple");
  require(std::round(steps) <= kMaxBands, "at most 1000 bands");
}

BandOptions parse_bands(const std::string& text) {
  std::vector<double> numbers;
  for (const std::string& part : split(text, ':')) {
    if (const auto number = number_of(part)) numbers.push_back(*number);
  }
  const auto colons = std::count(text.begin(), text.end(), ':');
  if (colons != 2 || numbers.size() != 3) {
    throw_usage_error("bands", in_quotes(text), "A:B:STEP in nm, as in 360:830:5");
  }
  const BandOptions bands{numbers[0], numbers[1], numbers[2]};
  check_bands(bands);
  return bands;
}

std::string bands_text(const BandOptions& bands) {
  return fmt::format("{}:{}:{}", bands.begin_nm, bands.end_nm, bands.step_nm);
}

}  // namespace abbe
