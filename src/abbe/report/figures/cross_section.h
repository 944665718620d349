/// Cuts through the bodies of a scene, to be drawn.
#pragma once

#include <span>
#include <vector>

#include "abbe/math/vec.h"
#include "abbe/world/world.h"

namespace abbe {

/// Lines in which surfaces cut the plane normal·x = distance.
/// Shape:  polylines in world coordinates, unordered.
/// Units:  metres; `surfaces` are indices into World::surfaces.
/// Domain: unit normal.
std::vector<std::vector<Vec3d>> cross_section(const World& world,
                                              std::span<const std::uint32_t> surfaces,
                                              const Vec3d& normal, double distance_m);

}  // namespace abbe
