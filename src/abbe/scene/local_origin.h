/// Where the numbers of a scene have their zero.
#pragma once

#include <cstddef>
#include <optional>

#include "abbe/scene/scene.h"

namespace abbe {

/// Moves a scene so that what is seen lies near zero, where numbers of single precision are fine:
/// far out their last digit is 6 cm at 1000 km. Scene::origin_m says by how much. What a camera
/// looks at is measured from the place in the scene's bounds that is nearest to it, without one
/// from their middle. A scene that lies as near as it can be useful stays to the bit.
/// Shape: `camera` is a number of scene.cameras.
void place_about_local_origin(Scene& scene, std::optional<std::size_t> camera);

}  // namespace abbe
