/// Which instances of a scene share the data of their mesh.
#pragma once

#include <cstdint>
#include <vector>

#include "abbe/scene/scene.h"
#include "abbe/world/geometry.h"

namespace abbe {

/// A mesh as some of its instances see it: as it is, or as its mirror image.
struct SharedMesh {
  std::uint32_t mesh = 0;
  bool is_mirrored = false;
  /// A place p of the mesh is p − center in the shared data: numbers are as fine as the mesh is.
  Vec3d center{0.0};
  std::vector<std::uint32_t> instances;  ///< In their order.
};

/// The meshes whose instances share data, by the rule.
std::vector<SharedMesh> find_shared_meshes(const Scene& scene, const SharingRule& rule);

}  // namespace abbe
