/// A written trace of what happened to the fans of a sample, for `abbe probe`.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "abbe/integrate/fan.h"
#include "abbe/math/vec.h"

namespace abbe {

/// One lane of a fan at the surface it met; of one that left the scene only where it began, its
/// direction and its throughput.
struct LaneRecord {
  int lane = 0;
  float wavelength_nm = 0.0f;  ///< 0 in RGB modes.
  Vec3f position{0.0f};
  Vec3f direction{0.0f};  ///< In which it arrived.
  Vec3f normal{0.0f};     ///< Of the surface, as shading has it, towards where it came from.
  float angle_incident_rad = 0.0f;
  std::optional<float> angle_refracted_rad;  ///< Absent for opaque surfaces and total reflection.
  float n_incident = 1.0f, n_transmitted = 1.0f;
  float k_r = 0.0f, k_t = 0.0f;
  float throughput = 0.0f;   ///< On arrival, basic.
  float local_light = 0.0f;  ///< Emission and ambient light added here, before visibility.
};

/// Lanes that met the same surface together.
struct FanRecord {
  std::uint32_t parent = 0;  ///< 1 + index of the record whose child this is; 0 for the camera.
  FanOrigin made_by = FanOrigin::Camera;
  bool was_spread = false;
  int depth = 0;
  float weight = 0.0f;
  bool is_hit = false;        ///< Otherwise the lanes left the scene.
  bool enters = false;        ///< The front side was met.
  std::uint32_t surface = 0;  ///< Index into World::surfaces.
  float direct_light = 0.0f;  ///< Mean over lanes of what lights added, after visibility.
  std::vector<LaneRecord> lanes;
};

}  // namespace abbe
