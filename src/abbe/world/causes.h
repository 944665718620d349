/// Why a spectral image differs from one of three channels: the causes, one by one.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "abbe/scene/scene.h"

namespace abbe {

/// What the spectral mode knows per wavelength and the mode `rgb` does not.
enum class Cause : std::uint8_t {
  IndexDispersion,  ///< The index of glass, of films and of coats per wavelength; frozen: n_d.
  Fresnel,     ///< Metals by n and k, phases of thin films per wavelength; frozen: metals by their
               ///< colour F0 and Schlick's rule, phases at the hues of the three primaries.
  Absorption,  ///< Beer and Lambert's law per wavelength; frozen: three channels' coefficients.
  Lamps,       ///< Spectra of lamps, emission and ambient light; frozen: their linear Rec.709.
  Reflectances,  ///< Reflectances as spectra, measured or uplifted, and their products; frozen:
                 ///< products of linear Rec.709 triples.
};
inline constexpr std::size_t kCauseCount = 5;
inline constexpr std::array<Cause, kCauseCount> kCauses{
    Cause::IndexDispersion, Cause::Fresnel, Cause::Absorption, Cause::Lamps, Cause::Reflectances};

/// Causes that are held as the mode `rgb` has them, while the others act.
class CauseSet {
 public:
  CauseSet() = default;
  static CauseSet all() { return CauseSet((1u << kCauseCount) - 1u); }

  bool contains(Cause cause) const { return (bits_ >> static_cast<unsigned>(cause)) & 1u; }
  void insert(Cause cause) { bits_ |= 1u << static_cast<unsigned>(cause); }
  bool empty() const { return bits_ == 0; }
  /// Whether anything is held per channel: all but an index of refraction is.
  bool has_channels() const {
    return (bits_ & ~(1u << static_cast<unsigned>(Cause::IndexDispersion))) != 0;
  }
  bool operator==(const CauseSet&) const = default;

 private:
  explicit CauseSet(unsigned bits) : bits_(bits) {}
  unsigned bits_ = 0;
};

/// "dispersion", "fresnel", "absorption", "lamps", "uplift".
std::string cause_name(Cause cause);
std::vector<std::string> cause_names();
/// The causes named; `all` names every one. Errors: a usage Error that lists the names.
CauseSet parse_causes(const std::vector<std::string>& names);
/// `dispersion,lamps`; empty for none.
std::string causes_text(const CauseSet& causes);

/// The causes that can change anything in a scene. What is left out changes no pixel of it,
/// switched on or off: a scene without dispersive material has no dispersion to show, and its D65
/// lamps are 1, 1, 1 exactly. When in doubt, a cause is in.
std::vector<Cause> acting_causes(const Scene& scene, const Spectrum& d65);

}  // namespace abbe
