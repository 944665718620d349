/// Straight light through transparent surfaces: the visibility v of the illumination equation.
#pragma once

#include "abbe/integrate/integrator.h"
#include "abbe/integrate/light/shadow_jobs.h"
#include "abbe/world/world.h"

namespace abbe {

/// Multiplies the visibility of every job by what transparent surfaces between a place and its
/// light let through: Fresnel losses at the angle on the outer side of each crossing, tints, and
/// absorption over the straight length.
/// Domain: opaque occlusion is already in the visibilities.
void attenuate_by_transparent(const World& world, std::span<const CameraSample> samples,
                              ShadowBuffers& buffers, IntegratorStats& stats);

}  // namespace abbe
