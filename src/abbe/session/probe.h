/// The rays of one camera sample, made readable: names instead of numbers, degrees instead of
/// radians.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "abbe/render/render.h"
#include "abbe/scene/scene.h"
#include "abbe/world/world.h"

namespace abbe {

/// What one wavelength (or channel) met.
struct ProbeLane {
  int lane = 0;
  std::optional<double> wavelength_nm;  ///< None in the RGB modes.
  std::string name;                     ///< `587.5600`, or `R`, `G`, `B`.
  Vec3d position{0.0};                  ///< Where it hit; of a ray that left, where it began.
  Vec3d direction{0.0};
  Vec3d normal{0.0};           ///< Of a hit: towards where the ray came from.
  double deviation_deg = 0.0;  ///< Angle to the camera ray.
  double throughput = 0.0;

  // Of a hit:
  double incidence_deg = 0.0;
  std::optional<double> refraction_deg;
  double n1 = 1.0;
  std::optional<double> n2, k2;  ///< Of what is behind, where it has an index; k2 of a metal.
  double k_r = 0.0, k_t = 0.0;
  bool is_totally_reflected = false;
};

/// Lanes that met one surface together, or left the scene.
struct ProbeNode {
  std::optional<std::size_t> parent;
  std::vector<std::size_t> children;  ///< Heaviest first.
  std::string made_by;                ///< "camera", "reflected", "refracted", "passed".
  bool is_spread = false;
  int depth = 0;
  double weight = 0.0;
  bool is_hit = false;
  std::uint32_t surface = 0;  ///< Index into World::surfaces.
  std::string instance, material;
  std::string side;  ///< "entering", "leaving", "front", "back".
  double direct_light = 0.0;
  std::vector<ProbeLane> lanes;
};

/// A camera sample, and what became of it.
struct Probed {
  CameraSample sample;
  std::vector<FanRecord> records;
};

/// The wavelength of a lane; none in the RGB modes.
std::optional<double> lane_wavelength_nm(const World& world, int set, int lane);
/// `587.5600`, or `R`, `G`, `B`.
std::string lane_name(const std::optional<double>& wavelength_nm, int lane);

/// Follows one sample of a pixel as render() does, or, without a number, the pixel's centre.
Probed probe_pixel(const LitWorld& world, const Camera& camera, const RenderSettings& settings,
                   const Vec2i& pixel, std::optional<std::uint32_t> sample);

/// Nodes in the order of their records. Shape: the camera's own nodes have no parent; there are
/// several only where one camera ray met nothing to gather its lanes.
std::vector<ProbeNode> probe_tree(std::span<const FanRecord> records, const Scene& scene,
                                  const World& world, const CameraSample& sample);

/// Moves the places of a tree by `by`: from the world that was traced to the scene's coordinates.
void move_places(std::vector<ProbeNode>& nodes, const Vec3d& by);

}  // namespace abbe
