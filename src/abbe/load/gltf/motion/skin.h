/// glTF's skins, posed.
#pragma once

#include <functional>
#include <vector>

#include "abbe/load/gltf/document/accessors.h"
#include "abbe/load/gltf/document/document.h"
#include "abbe/math/vec.h"

namespace abbe::gltf {

/// A skin in a pose.
struct PosedSkin {
  /// For each joint what takes a vertex to the world, measured from `origin`.
  std::vector<Mat4d> joint_matrices;
  /// The place of the first joint: near it numbers of single precision are fine.
  Vec3d origin{0.0};
};

/// The skin with its joints where `to_world` has them, whatever the node of its mesh says.
/// Errors: input Error at the skin, for matrices that are missing, not finite or of another type.
PosedSkin read_skin(Document& document, Accessors& accessors, int skin,
                    const std::function<Mat4d(int)>& to_world);

}  // namespace abbe::gltf
