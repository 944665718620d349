/// The wavelengths that a camera sample carries, as a quadrature rule.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "abbe/spectrum/observer.h"
#include "abbe/spectrum/spectrum.h"
#include "abbe/spectrum/wavelength_density.h"

namespace abbe {

/// What a lane of a wavelength set stands for.
enum class LaneKind : std::uint8_t {
  Continuous,  ///< A stratum of the continuous range: lights give radiance per nm.
  Line,        ///< One spectral line of a lamp: lights give the line's strength, continuous ones 0.
  Exact,       ///< A wavelength asked for: lights give radiance per nm, weight 1 nm.
  Padding,     ///< Fills up the SIMD width; its weight is 0.
};

/// Which wavelengths a render carries.
struct WavelengthOptions {
  int count = 16;               ///< Continuous lanes, 1 to 64.
  double range_min_nm = 360.0;  ///< Part of the range that is rendered.
  double range_max_nm = 830.0;
  std::vector<double> exact_nm = {};  ///< Not empty: these, and nothing else.
};

/// What the wavelengths of a scene have to resolve beside its lamps.
struct ResolvedBands {
  std::vector<NarrowBand> bands = {};  ///< Of the scene's spectra, by narrow_bands().
  std::vector<float> shifts = {};      ///< Of the samples of a pixel, as set_of() takes them.
};

/// A family of wavelength sets that differ by their shift.
///
/// The strata of a set have equal mass under a density made from the observer and the scene's
/// lamps, mixed with the uniform one; set s takes the point at (i + shift(s))/N of each stratum.
/// The shifts are kShiftCount equidistant ones. All pixels share the family, so that spectra are
/// tabulated once per set (see rows) and never while rays are traced.
///
/// Where spectra of the scene have narrow bands, each is given the mass of one stratum, a quarter
/// of all at most, so that about one lane of every set falls into each. A lane then stands for its
/// cell, the part of its stratum that it has among the sets of a pixel's samples: its weight is the
/// cell's, and tabulated reflectances are means over it. That makes the sum over a pixel's samples
/// exact where light, observer and all but one reflectance change slowly over a cell, and converges
/// with the number of samples where they do not.
class WavelengthQuadrature {
 public:
  static constexpr int kShiftCount = 256;
  static constexpr std::size_t kMaxExactLamps = 4;

  /// `lamps` are the emission spectra of the scene, in any scale: each counts by its own luminance.
  WavelengthQuadrature(const WavelengthOptions& options, const Observer& observer,
                       std::span<const Spectrum> lamps, const ResolvedBands& resolved = {});

  /// Number of real lanes, and of lanes with padding: a multiple of 4 up to 8, then of 16.
  int lane_count() const { return lane_count_; }
  int lane_stride() const { return lane_stride_; }
  /// Number of different sets: kShiftCount, or 1 when every lane is exact or a line.
  int set_count() const { return set_count_; }

  /// The set whose wavelengths are shifted by a share of their strata.
  /// Domain: `shift` in [0, 1), of math/random.h's wavelength_shift() for the samples of a pixel.
  int set_of(float shift) const;

  /// The part of the spectrum that is rendered.
  double range_min_nm() const { return range_min_nm_; }
  double range_max_nm() const { return range_max_nm_; }

  /// Shape: lane_stride values per set. Padding repeats the last wavelength.
  std::span<const float> wavelengths_nm(int set) const;
  /// Quadrature weights in nm (1 for lines, 0 for padding): ∫ f dλ ≈ Σ weight·f.
  std::span<const float> weights_nm(int set) const;
  std::span<const LaneKind> kinds() const { return kinds_; }

  /// The weights by which a film turns radiance per lane into tristimulus values:
  /// K_m · weight · cmf(λ), continuous lanes times a correction close to 1.
  ///
  /// The correction, per set and channel, is the smallest that makes the scene's lamps (one for
  /// every four lanes; the last stands for the mix if there are more) integrate to what they are:
  /// what reflects all wavelengths alike has the colour of the lamp in every single sample. Its
  /// price is a ripple over wavelength that more samples do not average out, of 0.1 % under D65 and
  /// 2 % under FL11 at 16 lanes. Where any factor would differ from 1 by more than 15 %, as with 4
  /// lanes, no set is corrected.
  /// Shape: set_count × 3 × lane_stride: of each set the lanes of X, of Y, of Z. Padding is 0.
  std::vector<float> observer_weights(const Observer& observer) const;

  /// A reflectance, index or absorption at every lane of every set.
  /// Shape: set_count × lane_stride, set by set.
  std::vector<float> tabulate(const Spectrum& quantity) const;
  std::vector<float> tabulate(const std::function<double(double wavelength_nm)>& quantity) const;
  /// A reflectance as it enters light linearly: the mean over a lane's cell, where lanes have
  /// cells.
  std::vector<float> tabulate_reflectance(const Spectrum& reflectance) const;
  /// An emission: its continuous part on Continuous and Exact lanes, its lines' strengths on the
  /// lanes of their wavelengths. A line on an Exact lane within 0.01 nm counts there with its full
  /// strength.
  std::vector<float> tabulate_emission(const Spectrum& emission) const;

 private:
  /// What a lane stands for, an interval.
  using Cell = NarrowBand;

  void place_lanes(const WavelengthOptions& options, const WavelengthDensity& density);
  /// With narrow bands: gives every continuous lane its cell, and the weight of that.
  void set_cells(const WavelengthDensity& density, std::span<const float> shifts);

  int lane_count_ = 0;
  int lane_stride_ = 0;
  int set_count_ = 0;
  int continuous_count_ = 0;
  double range_min_nm_ = 0.0, range_max_nm_ = 0.0;
  std::vector<Spectrum> exact_lamps_;  ///< At luminance 1; equal energy without any.
  std::vector<LaneKind> kinds_;
  std::vector<double> line_nm_;  ///< Of the line lanes, rising.
  std::vector<float> wavelengths_nm_;
  std::vector<float> weights_nm_;
  std::vector<NarrowBand> bands_;  ///< Those that are resolved.
  /// The density but for them, and the cells of the lanes of all sets: only with such bands.
  std::optional<WavelengthDensity> smooth_density_;
  std::vector<Cell> cells_;
};

}  // namespace abbe
