/// What fills a scene: ambient light and fog.
#pragma once

#include <optional>

#include "abbe/scene/scene.h"
#include "abbe/world/lanes.h"
#include "abbe/world/rows.h"

namespace abbe {

/// Fog outside all bodies.
struct WorldFog {
  float extinction_per_m = 0.0f;
  RowId albedo = 0;
};

/// The ambient light of a scene, as a row of radiance. Absent where there is none.
std::optional<RowId> tabulate_ambient(const Scene& scene, const LaneModel& lanes, Rows& rows);

/// The fog of a scene. Absent where there is none.
std::optional<WorldFog> tabulate_fog(const Scene& scene, const LaneModel& lanes, Rows& rows);

}  // namespace abbe
