#include "abbe/load/gltf/placement/transform.h"

#include <cmath>

namespace abbe::gltf {

Mat4d matrix_of(const Transform& transform, const std::string& where, Notes& notes) {
  Mat4d result(1.0);
  const double length = glm::length(transform.rotation);
  if (!(length > 1e-100) || !std::isfinite(length)) {
    notes.warn(where, "a rotation of length 0; no rotation is used");
  } else {
    const Vec4d q = transform.rotation / length;
    const double x = q.x, y = q.y, z = q.z, w = q.w;
    result[0] = Vec4d(1 - 2 * (y * y + z * z), 2 * (x * y + w * z), 2 * (x * z - w * y), 0);
    result[1] = Vec4d(2 * (x * y - w * z), 1 - 2 * (x * x + z * z), 2 * (y * z + w * x), 0);
    result[2] = Vec4d(2 * (x * z + w * y), 2 * (y * z - w * x), 1 - 2 * (x * x + y * y), 0);
  }
  for (int c = 0; c < 3; ++c) result[c] *= transform.scale[c];
  result[3] = Vec4d(transform.translation, 1.0);
  return result;
}

}  // namespace abbe::gltf
