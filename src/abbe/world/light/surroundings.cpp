#include "abbe/world/light/surroundings.h"

namespace abbe {

std::optional<RowId> tabulate_ambient(const Scene& scene, const LaneModel& lanes, Rows& rows) {
  if (!scene.ambient || !(scene.ambient->luminance_cd_per_m2 > 0.0)) return std::nullopt;
  return rows.add(
      lanes.emission(scene.ambient->spectrum.spectrum, scene.ambient->luminance_cd_per_m2));
}

std::optional<WorldFog> tabulate_fog(const Scene& scene, const LaneModel& lanes, Rows& rows) {
  if (!scene.fog || !(scene.fog->extinction_per_m > 0.0)) return std::nullopt;
  return WorldFog{static_cast<float>(scene.fog->extinction_per_m),
                  rows.add(lanes.reflectance(scene.fog->albedo))};
}

}  // namespace abbe
