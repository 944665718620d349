/// Which textures a material uses.
#pragma once

#include <vector>

#include "abbe/scene/scene.h"

namespace abbe {

/// All uses of textures by a material, its layers included; valid as long as it is.
std::vector<const TextureUse*> texture_uses(const Material& material);

}  // namespace abbe
