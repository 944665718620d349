/// Where the fans of a batch met surfaces that may touch others.
#pragma once

#include <cstddef>

#include "abbe/integrate/buffers.h"
#include "abbe/integrate/fan.h"
#include "abbe/world/world.h"

namespace abbe {

/// Settles what fans [first, last) of a list meet, given their nearest hits in the buffers: changes
/// hits where contact decides otherwise, and notes what is there besides.
/// Domain: a world in which something may touch.
void settle_contacts(const World& world, const FanList& list, std::size_t first, std::size_t last,
                     IntegratorScratch::Buffers& buffers);

}  // namespace abbe
