/// What the lanes of a fan stand for: sampled wavelengths, or the three channels of an RGB mode.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "abbe/color/channel_basis.h"
#include "abbe/color/color.h"
#include "abbe/color/development.h"
#include "abbe/color/uplift/uplift.h"
#include "abbe/optics/dispersion.h"
#include "abbe/scene/scene.h"
#include "abbe/spectrum/observer.h"
#include "abbe/spectrum/wavelength_set.h"
#include "abbe/world/causes.h"
#include "abbe/world/sharing_rule.h"

namespace abbe {

/// What the lanes of a render are.
enum class Mode {
  Spectral,  ///< Lanes are wavelengths.
  Rgb,       ///< Lanes are linear Rec.709 channels; one index of refraction, n_d.
  Rgb3,      ///< The same with an index per channel: R = C line, G = d, B = F.
};

/// `spectral`, `rgb`, `rgb3`. Errors: usage Error that lists them.
Mode mode_from_name(const std::string& name);
std::string mode_name(Mode mode);

/// Settings that shape how a scene is made ready.
struct WorldOptions {
  Mode mode = Mode::Spectral;
  WavelengthOptions wavelengths;
  DevelopmentOptions development = {};
  Uplift uplift = Uplift::JakobHanika;
  CauseSet frozen = {};  ///< Spectral mode only.
  /// Of the wavelengths of a pixel's samples: they resolve narrow bands of reflectances best.
  /// Others may be drawn.
  std::vector<float> shifts = {};
  std::string accelerator = "kdtree";  ///< One of accelerator_names(). Never shapes the image.
  SharingRule sharing = {};            ///< Shapes the image by rounding only.
};

/// Errors: a usage Error for a mode or an uplift that is none, made of a number.
void check_world_options(const WorldOptions& options);

/// Turns quantities of a scene into rows: one value per lane for every wavelength set.
/// Shape of every row returned: set_count × lane_stride.
///
/// Frozen causes. Where something is held per channel while something else acts per wavelength,
/// every wavelength has three lanes, one per channel: lane 3·i + c is wavelength i in channel c.
/// What acts has one value for the three, what is frozen one for all lanes of a channel, so that
/// products of either kind are exact: over wavelengths they are those of the spectral mode, over
/// channels those of the mode `rgb`. At the end the three are added, each by its share b_c of the
/// wavelength (color/channel_basis.h), frozen lamps, 1 for D65, times D65. With nothing frozen that
/// is the spectral mode, since the shares add up to 1; with everything frozen it is the mode `rgb`,
/// since b_c has the colour of primary c under D65. Between the two, a triple stands for the
/// spectrum r·b_R + g·b_G + b·b_B, a choice among its metamers.
class LaneModel {
 public:
  /// `observer` is that of photometry, CIE 1931: luminances are its. `d65` in any scale; `lamps`
  /// are the scene's emission spectra, `filters` reflectances and transmittances that it has as
  /// spectra (both for the wavelength density).
  /// Errors: as check_world_options; a usage Error where causes are frozen and three lanes per
  ///         wavelength are too many, or the film's observer has no channel basis.
  LaneModel(const WorldOptions& options, const Observer& observer, const Spectrum& d65,
            std::span<const Spectrum> lamps, std::span<const Spectrum> filters = {});

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
  /// Absent in the RGB modes. Its lanes are wavelengths, of which each may have several lanes here:
  /// see folded().
  const WavelengthQuadrature* quadrature() const { return quadrature_ ? &*quadrature_ : nullptr; }
  /// Whether they are wavelengths, and so few that light of each is searched for by itself: what
  /// one gets does not depend on which others there are.
  bool are_followed_apart() const {
    constexpr int kFew = 16;
    return quadrature_ && set_count_ == 1 && lane_count_ <= kFew;
  }

  /// Whether lanes hold that kind of quantity as channels of linear Rec.709: in the RGB modes, and
  /// where it is frozen.
  bool is_rgb(Cause cause) const { return mode_ != Mode::Spectral || frozen_.contains(cause); }
  /// The channel of a lane that holds channels: 0, 1, 2; padding counts as 2.
  int channel_of(int lane) const;
  /// The wavelength of a lane; 0 in RGB modes.
  float wavelength_nm(int set, int lane) const;
  /// Radiance per lane as radiance per wavelength, the lanes of the quadrature: the same values,
  /// but for frozen causes. `folded` is room for them.
  std::span<const float> folded(int set, std::span<const float> radiance,
                                std::vector<float>& folded) const;

  /// A reflectance or transmittance: uplifted or sampled; in RGB modes projected under D65, and
  /// RGB limited to the gamut of Rec.709, which is all that their lanes can tell. `cause` is what
  /// it belongs to.
  std::vector<float> reflectance(const Reflectance& value, Cause cause = Cause::Reflectances) const;
  /// A quantity that is no colour (n, k): sampled; in RGB modes at the C, d, F lines.
  std::vector<float> quantity(const Spectrum& value) const;
  /// Emission in W·m⁻²·sr⁻¹·nm⁻¹; in RGB modes linear Rec.709 in cd/m².
  std::vector<float> emission(const Spectrum& value) const;
  /// The same, scaled to a luminance (or illuminance, or luminous intensity).
  std::vector<float> emission(const Spectrum& value, double luminance) const;
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
  std::vector<float> luminance_weights() const;

 private:
  /// Per wavelength, on all its lanes; per channel, on all its lanes.
  std::vector<float> of_wavelengths(std::vector<float> row) const;
  std::vector<float> of_channels(const Vec3d& rgb) const;
  std::vector<float> observer_weights(const Observer& observer) const;
  void settle_primaries(const Observer& observer, std::vector<float>& weights) const;

  Mode mode_;
  Uplift uplift_;
  CauseSet frozen_;
  int copies_ = 1;                     ///< Lanes per wavelength.
  std::optional<ChannelBasis> basis_;  ///< Where a wavelength has several lanes,
  std::vector<float> shares_;          ///< and the share of every lane in it.
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
