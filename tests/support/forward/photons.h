/// The forward reference: light followed from the lamp, face by face, by brute force in double
/// precision. It shares nothing with the renderer; setups are all it knows.
///
/// Each interface between two media reflects and refracts unpolarised light (Fresnel, Snell); media
/// absorb (Beer and Lambert); mirrors reflect; walls keep what they get. Coincident faces of two
/// dielectrics are one interface from medium to medium. A dielectric's face on a wall or mirror
/// has a thin gap of what surrounds it before the wall.
#pragma once

#include <cstdint>
#include <vector>

#include "support/forward/setup.h"

namespace abbe::test {

struct PhotonOptions {
  double wavelength_nm = 550.0;
  std::optional<std::uint64_t> photons = {};  ///< None: as many as the setup says.
  /// Shares of a photon below this are no longer split at an interface: one of the two ways is
  /// drawn by chance instead.
  double split_share = 0.05;
  std::uint64_t seed = 1;
};

/// Powers are those of a lamp of irradiance or intensity 1.
struct ForwardResult {
  /// Per cell of the receiver, rows from +y to −y, in units of the setup; standard errors beside.
  std::vector<double> irradiance, standard_error;
  std::vector<double> on_body;  ///< What walls and mirrors kept, by body.
  double sent = 0.0;            ///< Through the rectangle aimed at.
  double absorbed = 0.0;        ///< By media.
  double escaped = 0.0;         ///< Into the open.
  double lost = 0.0;            ///< Of photons that met an edge, or too many faces.
};

/// Bit-equal for any number of threads.
/// Errors: std::invalid_argument for more bodies than a set holds.
ForwardResult follow_photons(const OpticalSetup& setup, const PhotonOptions& options);

/// Reflectance of an interface for unpolarised light, from a medium of index n1 to n2.
double interface_reflectance(double cos_i, double n1, std::complex<double> n2);

}  // namespace abbe::test
