/// Lamps of a scene as one would change them in a room.
#pragma once

#include <vector>

#include "abbe/scene/scene.h"

namespace abbe {

/// Gives all that shines by itself (lights, emissive materials, ambient light, an environment of
/// colours) the spectrum of one lamp. A spectral environment keeps its own. Luminances and
/// intensities stay: a coloured light becomes as bright as its colour was. An emissive texture goes
/// on to multiply. Unlit materials are pictures, not lamps, and stay. Domain: a lamp of some
/// luminance.
void replace_lamps(Scene& scene, const NamedSpectrum& lamp);

/// Illuminance at a place of a surface that faces the light, without range and cone. Lamps count
/// as at least `nearest_m` away.
double illuminance_lux(const Light& light, const Vec3d& place, double nearest_m);

/// Luminance of linear Rec.709 whose white is 1 cd/m².
double luminance_of(const Vec3d& rgb_rec709);

/// The mean of an environment over all directions, scaled: of its colours, or of its bands.
struct EnvironmentMean {
  Vec3d rgb_rec709{0.0};
  std::vector<double> band_nm, bands;
};
EnvironmentMean mean_of(const Environment& environment);

}  // namespace abbe
