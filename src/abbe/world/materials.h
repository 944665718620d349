/// Materials, lights and lamps of a scene, tabulated.
#pragma once

#include <vector>

#include "abbe/world/world.h"

namespace abbe {

/// Appends a tabulated spectrum to the world's rows.
RowId append_row(World& world, const std::vector<float>& row);

/// Fills World::materials, textures, lights, ambient, lamp_ids and the weights.
void tabulate_materials(const Scene& scene, World& world);
void tabulate_lights(const Scene& scene, World& world);

}  // namespace abbe
