/// What the lanes of a fan stand for: sampled wavelengths, or the three channels of an RGB mode.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "color/color.h"
#include "color/development.h"
#include "color/uplift.h"
#include "optics/dispersion.h"
#include "scene/scene.h"
#include "spectrum/observer.h"
#include "spectrum/wavelength_set.h"

namespace abbe {

enum class Mode {
  Spectral,  ///< Lanes are wavelengths.
  Rgb,       ///< Lanes are linear Rec.709 channels; one index of refraction, n_d.
  Rgb3,      ///< The same with an index per channel: R = C line, G = d, B = F.
};

/// Names as on the command line. Errors: usage Error that lists them.
Mode mode_from_name(const std::string& name);
std::string mode_name(Mode mode);

/// Turns quantities of a scene into rows: one value per lane for every wavelength set.
/// Shape of every row returned: set_count × lane_stride.
class LaneModel {
 public:
  /// `observer` is that of photometry, CIE 1931: luminances are its. `d65` in any scale; `lamps`
  /// are the scene's emission spectra (for the wavelength density).
  LaneModel(Mode mode, const WavelengthOptions& options, const Observer& observer,
            const Spectrum& d65, std::span<const Spectrum> lamps,
            const DevelopmentOptions& development = {}, Uplift uplift = Uplift::JakobHanika);

  Mode mode() const { return mode_; }
  Uplift uplift() const { return uplift_; }
  int lane_count() const { return lane_count_; }
  int lane_stride() const { return lane_stride_; }
  int set_count() const { return set_count_; }
  const Observer& observer() const { return observer_; }
  /// The observer or camera of the film.
  const Observer& film_observer() const { return film_observer_; }
  /// From spectra to the lanes of the RGB modes: the film's observer, D65 for white.
  const Development& development() const { return development_; }
  /// From what xyz_weights() sums up to linear Rec.709.
  const Mat3d& film_to_rec709() const { return film_to_rec709_; }
  const Spectrum& d65() const { return d65_; }  ///< Scaled to 1 cd/m².
  /// Absent in the RGB modes.
  const WavelengthQuadrature* quadrature() const { return quadrature_ ? &*quadrature_ : nullptr; }

  /// A reflectance or transmittance: uplifted or sampled; in RGB modes projected under D65, and
  /// RGB limited to the gamut of Rec.709, which is all that their lanes can tell.
  std::vector<float> reflectance(const Reflectance& value) const;
  /// A quantity that is no colour (n, k): sampled; in RGB modes at the C, d, F lines.
  std::vector<float> quantity(const Spectrum& value) const;
  /// Emission in W·m⁻²·sr⁻¹·nm⁻¹; in RGB modes linear Rec.709 in cd/m².
  std::vector<float> emission(const Spectrum& value) const;
  /// Emission given as RGB in cd/m² per channel; in RGB modes negative channels are 0.
  std::vector<float> emission(const RgbRec709& value) const;
  std::vector<float> index(const Dispersion& value) const;
  /// Absorption in m⁻¹; in RGB modes that of the medium's colour at the depth of mean absorption.
  std::vector<float> absorption(const Spectrum& per_m) const;
  /// Absorption in m⁻¹ of glTF's attenuation colour and distance.
  std::vector<float> attenuation(const Vec3d& color_rec709, double distance_m) const;

  /// (λ_nm − 595)/235 of every lane, the abscissa of uplift_rec709_from_table; 0 in RGB modes.
  std::vector<float> uplift_abscissa() const;
  /// One curve of Mallett and Yuksel's basis: red, green or blue.
  std::vector<float> uplift_basis(int channel) const;

  /// 1/λ in nm⁻¹ of every lane. In RGB modes a channel stands for one wavelength, that on which its
  /// primary's hue lies: few as they are, they make fringes of thick films that no eye would see.
  std::vector<float> inverse_wavelength() const;

  /// Film weights: responses of the film's observer = Σ weight·radiance. Shape: set_count × 3 ×
  /// lane_stride.
  std::vector<float> xyz_weights() const;
  /// Share of each lane in what the observer sees of the scene's lamps (of D65 if none), ≥ 0,
  /// summing to 1 over a set: the weight by which fans are bounded.
  std::vector<float> importance() const;

 private:
  Mode mode_;
  Uplift uplift_;
  int lane_count_ = 3;
  int lane_stride_ = 4;
  int set_count_ = 1;
  Observer observer_;
  Observer film_observer_;
  Development development_;
  Mat3d film_to_rec709_{1.0};
  Spectrum d65_;
  std::vector<Spectrum> lamps_;
  std::optional<WavelengthQuadrature> quadrature_;
};

}  // namespace abbe
