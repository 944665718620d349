/// The white of a scene: the light in its middle.
#pragma once

#include "abbe/accel/shapes.h"
#include "abbe/color/development.h"
#include "abbe/scene/scene.h"

namespace abbe {

/// All lamps and the ambient light, each with its share of the illuminance of a surface in the
/// middle of `bounds` that faces it, nothing in the way; of a scene that only its emissive surfaces
/// light, these, each with its share of their luminances. D65 for a scene without light.
/// Domain: `observer` is the CIE 1931 observer.
White scene_white(const Scene& scene, const Box3d& bounds, const Spectrum& d65,
                  const Observer& observer);

}  // namespace abbe
