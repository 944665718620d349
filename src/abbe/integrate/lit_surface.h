/// A fan at a surface that light shines on.
#pragma once

#include <cstdint>

#include "abbe/integrate/fan.h"
#include "abbe/integrate/surface/answer.h"

namespace abbe {

/// A fan's lanes at a surface: what the fans that it becomes, and light on its way to it, refer to.
struct FanAtSurface {
  const FanList& list;  ///< That the fan is of.
  const Fan& fan;
  const SurfaceHit& hit;
  float path_length_m = 0.0f;       ///< From the camera to here.
  std::uint32_t record_number = 0;  ///< 1 + number of the record of this, or 0.
};

/// A surface that lamps shine on, and the throughput of the lanes that met it.
struct LitSurface {
  const FanAtSurface& where;
  const ShadedSurface& shaded;
  const LaneArray& throughput;
};

}  // namespace abbe
