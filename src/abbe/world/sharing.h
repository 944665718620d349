/// Which instances of a scene share the data of their mesh.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "abbe/base/notes.h"
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

/// The meshes whose instances share data, by the rule. Those do not that `ends_light` marks, and
/// those that may be in contact where one of the two lets light through.
/// Shape: `ends_light` a value per instance, or empty.
std::vector<SharedMesh> find_shared_meshes(const Scene& scene, const SharingRule& rule,
                                           std::span<const std::uint8_t> ends_light, Notes& notes);

}  // namespace abbe
