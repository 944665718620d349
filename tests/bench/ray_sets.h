/// The rays that a renderer asks about, made from a scene once and traced by every rival.
#pragma once

#include <string>
#include <vector>

#include "abbe/accel/accelerator.h"
#include "bench/bench_scenes.h"

namespace abbe::bench {

/// Rays in groups of 16 that belong together; a group with fewer has lanes that do not take part.
struct RaySet {
  std::string name;
  bool is_occlusion = false;  ///< Any hit instead of the closest.
  bool is_coherent = false;   ///< Groups are packets worth tracing as such.
  std::vector<Ray> rays;      ///< All rays that take part.
  std::vector<RayPacket> packets;
};

/// primary, shadow (from the light), bounce and second_bounce (cosine), fan (16 refracted rays of
/// one origin, n from 1.49 to 1.54) and fan_after (the same behind their next surface).
std::vector<RaySet> make_ray_sets(const BenchScene& scene, const Accelerator& tree, int width);

}  // namespace abbe::bench
