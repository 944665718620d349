/// The RGB colours of a scene as a whole: the space they are in, and which of them exist.
#pragma once

#include <cstdint>

#include "abbe/scene/scene.h"

namespace abbe {

/// Makes linear Rec.709 of all RGB colours of a scene that are still in its color_space: factors,
/// vertex colours and lights. Textures stay encoded.
void convert_colors_to_rec709(Scene& scene);

/// How many colours are more than Rec.709, or than any surface, can be.
struct ColorCount {
  std::uint64_t outside_rec709 = 0;  ///< With channels below 0 or above 1.
  /// No reflectance in [0, 1] has them under D65; of emission, where the scale rule of
  /// uplift_emission leaves none. The nearest is taken.
  std::uint64_t impossible = 0;
};

/// Over base colours (each texel times its factor, each vertex colour likewise), attenuation
/// colours, emission and lights, once for each material, vertex or texel.
ColorCount count_colors(const Scene& scene);

}  // namespace abbe
