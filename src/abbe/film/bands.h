/// Spectral bands of an image: equal intervals of wavelength.
#pragma once

#include <optional>
#include <string>

namespace abbe {

/// Bands [begin + i·step, begin + (i + 1)·step), named by their centres.
/// Domain: as check_bands.
struct BandOptions {
  double begin_nm = 360.0;
  double end_nm = 830.0;
  double step_nm = 5.0;

  int count() const;
  double low_nm(int band) const { return begin_nm + band * step_nm; }
  double center_nm(int band) const { return begin_nm + (band + 0.5) * step_nm; }
  /// The band that holds a wavelength; none outside the range.
  std::optional<int> index_of(double wavelength_nm) const;
  bool operator==(const BandOptions&) const = default;
};

/// Errors: usage Error unless 360 ≤ begin < end ≤ 830, the step is at least 0.01, and end − begin
///         a whole number of steps, at most 1000.
void check_bands(const BandOptions& bands);

/// Reads `A:B:STEP`, as in `360:830:5`: 94 bands, the first centred at 362.5 nm.
/// Errors: usage Error; as check_bands.
BandOptions parse_bands(const std::string& text);
/// The text of which parse_bands reads the same bands.
std::string bands_text(const BandOptions& bands);

}  // namespace abbe
