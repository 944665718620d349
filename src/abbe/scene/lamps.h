/// Lamps of a scene as one would change them in a room.
#pragma once

#include "abbe/scene/scene.h"

namespace abbe {

/// Gives all that shines by itself (lights, emissive materials, ambient light) the spectrum of one
/// lamp. Luminances and intensities stay: a coloured light becomes as bright as its colour was. An
/// emissive texture goes on to multiply. Unlit materials are pictures, not lamps, and stay.
/// Domain: a lamp of some luminance.
void replace_lamps(Scene& scene, const NamedSpectrum& lamp);

}  // namespace abbe
