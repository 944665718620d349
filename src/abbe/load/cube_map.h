/// Cubes of images of light from all around.
#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "abbe/math/vec.h"
#include "abbe/scene/scene.h"

namespace abbe {

/// Six square images, as seen from the middle of a cube: towards +X, −X, +Y, −Y, +Z and −Z. Row 0
/// is at the top, which is +Y at the sides, −Z in the image towards +Y and +Z in that towards −Y.
/// Shape:  size·size texels a face. Units: linear Rec.709, cd/m² per channel.
struct CubeMap {
  int size = 0;
  std::array<std::vector<Vec3f>, 6> faces;
};

/// What is seen along a direction: the texel that it meets.
/// Domain: a direction of any length but 0.
Vec3f texel_along(const CubeMap& cube, const Vec3d& direction);

/// The cube as an equirectangular image, turned by a rotation, as wide as four faces: each texel is
/// the mean of sixteen directions in it.
EnvironmentImage equirectangular(const CubeMap& cube, const Mat3d& rotation);

}  // namespace abbe
