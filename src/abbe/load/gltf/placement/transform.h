/// Translation, rotation and scale as glTF has them.
#pragma once

#include <string>

#include "abbe/base/notes.h"
#include "abbe/math/vec.h"

namespace abbe::gltf {

/// Scaled first, then turned, then moved.
struct Transform {
  Vec3d translation{0.0}, scale{1.0};
  Vec4d rotation{0.0, 0.0, 0.0, 1.0};  ///< Quaternion x, y, z, w, of any length.
};

/// As a matrix. A rotation of length 0 is none, with a warning at `where`.
Mat4d matrix_of(const Transform& transform, const std::string& where, Notes& notes);

}  // namespace abbe::gltf
