/// Queries of many rays at the instruction set level of the machine.
#pragma once

#include <cstddef>
#include <cstdint>

#include "abbe/accel/kd/layout.h"
#include "abbe/accel/query.h"

namespace abbe {

void trace_closest(const KdView& view, const Ray* rays, std::size_t count, VisibilityMask mask,
                   Hit* hits);
void trace_any(const KdView& view, const Ray* rays, std::size_t count, VisibilityMask mask,
               std::uint8_t* occluded);
void trace_closest(const KdView& view, const RayPacket* packets, std::size_t count,
                   VisibilityMask mask, HitPacket* hits);
void trace_any(const KdView& view, const RayPacket* packets, std::size_t count, VisibilityMask mask,
               std::uint32_t* occluded);

}  // namespace abbe
