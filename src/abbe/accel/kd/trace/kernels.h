/// Queries of many rays at the instruction set level of the machine.
#pragma once

#include <cstddef>
#include <cstdint>

#include "abbe/accel/kd/layout.h"
#include "abbe/accel/query.h"

namespace abbe {

/// The nearest hit of each ray, and whether each meets anything: one answer per ray, as Accelerator
/// has them. Domain: the tree is not empty, and the mask sees some primitive.
void trace_closest(const KdView& view, const Ray* rays, std::size_t count, QueryMask mask,
                   Hit* hits);
void trace_any(const KdView& view, const Ray* rays, std::size_t count, QueryMask mask,
               std::uint8_t* occluded);
/// The same for packets; an answer of any_hits has one bit per lane.
void trace_closest(const KdView& view, const RayPacket* packets, std::size_t count, QueryMask mask,
                   HitPacket* hits);
void trace_any(const KdView& view, const RayPacket* packets, std::size_t count, QueryMask mask,
               std::uint32_t* occluded);

}  // namespace abbe
