/// The work that the rays of each sample make, for heat maps.
#pragma once

#include <cstddef>
#include <span>

#include "abbe/integrate/integrator.h"
#include "abbe/integrate/light/shadow_jobs.h"

namespace abbe {

/// Adds to each sample's FirstHit::cost what its fans [first, last) of a list cost the accelerator,
/// every ray by itself: the cost of a sample does not depend on who shares its packets.
void count_fan_cost(const World& world, const FanList& list, std::size_t first, std::size_t last,
                    std::span<FirstHit> first_hits);

/// The same for the shadow rays of a batch; they stop where they find something.
void count_shadow_cost(const World& world, const ShadowBuffers& buffers,
                       std::span<FirstHit> first_hits);

}  // namespace abbe
