#include "abbe/load/cube_map.h"

#include <algorithm>
#include <cmath>

#include "abbe/base/constants.h"
#include "abbe/base/parallel.h"

namespace abbe {

Vec3f texel_along(const CubeMap& cube, const Vec3d& direction) {
  const Vec3d size = glm::abs(direction);
  const int axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
  const bool is_negative = direction[axis] < 0.0;
  const double sign = is_negative ? -1.0 : 1.0;
  // To the right and down in the image, each a side of the cube per unit of both.
  double right = 0.0, down = -direction.y;
  switch (axis) {
    case 0:
      right = sign * direction.z;
      break;
    case 1:
      right = -direction.x;
      down = sign * direction.z;
      break;
    default:
      right = -sign * direction.x;
  }
  const auto place = [&](double x) {
    const double share = 0.5 * (x / size[axis] + 1.0);
    return std::min(static_cast<std::size_t>(share * cube.size),
                    static_cast<std::size_t>(cube.size) - 1);
  };
  const std::size_t face = static_cast<std::size_t>(2 * axis) + (is_negative ? 1 : 0);
  return cube.faces[face][place(down) * static_cast<std::size_t>(cube.size) + place(right)];
}

EnvironmentImage equirectangular(const CubeMap& cube, const Mat3d& rotation) {
  constexpr int kParts = 4;  // Of a texel, along each side.
  EnvironmentImage image{4 * cube.size, 2 * cube.size, {}, {}, {}};
  image.rgb_rec709.resize(static_cast<std::size_t>(image.width) * image.height);
  const Mat3d to_cube = glm::transpose(rotation);
  parallel_for(0, static_cast<std::size_t>(image.height), 8, [&](std::size_t row) {
    for (int column = 0; column < image.width; ++column) {
      Vec3f sum(0.0f);
      for (int part = 0; part < kParts * kParts; ++part) {
        const double polar = kPi * (static_cast<double>(row) + (part / kParts + 0.5) / kParts) /
                             static_cast<double>(image.height);
        const double turn =
            2.0 * kPi * ((column + (part % kParts + 0.5) / kParts) / image.width - 0.5);
        sum += texel_along(cube, to_cube * Vec3d(std::sin(polar) * std::cos(turn), std::cos(polar),
                                                 std::sin(polar) * std::sin(turn)));
      }
      image.rgb_rec709[row * static_cast<std::size_t>(image.width) +
                       static_cast<std::size_t>(column)] =
          sum / static_cast<float>(kParts * kParts);
    }
  });
  return image;
}

}  // namespace abbe
