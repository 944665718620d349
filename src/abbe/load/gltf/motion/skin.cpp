#include "abbe/load/gltf/motion/skin.h"

#include <fmt/format.h>

#include <cmath>

#include "abbe/base/error.h"

namespace abbe::gltf {
namespace {

// From mesh space to that of each joint; without them both are the same.
std::vector<Mat4d> bind_matrices(Document& document, Accessors& accessors,
                                 const tinygltf::Skin& skin, const std::string& pointer) {
  const std::size_t joints = skin.joints.size();
  const int number = skin.inverseBindMatrices;
  if (number < 0) return std::vector<Mat4d>(joints, Mat4d(1.0));
  const std::string user = pointer + "/inverseBindMatrices";
  accessors.spend(accessors.count(number), user);
  std::vector<Mat4d> matrices = accessors.matrices(number, user);
  if (matrices.size() < joints) {
    throw_input_error(document.where(user), fmt::format("{} matrices", matrices.size()),
                      fmt::format("one for each of {} joints", joints));
  }
  bool is_affine = true;
  for (Mat4d& matrix : matrices) {
    for (int column = 0; column < 4; ++column) {
      for (int row = 0; row < 3; ++row) {
        if (std::isfinite(matrix[column][row])) continue;
        throw_input_error(document.where(user), "a number that is not finite", "finite numbers");
      }
      is_affine = is_affine && matrix[column][3] == (column == 3 ? 1.0 : 0.0);
      matrix[column][3] = column == 3 ? 1.0 : 0.0;
    }
  }
  if (!is_affine) {
    document.fault(user, "matrices whose last row is another", "0 0 0 1", "0 0 0 1 is used");
  }
  return matrices;
}

}  // namespace

PosedSkin read_skin(Document& document, Accessors& accessors, int skin,
                    const std::function<Mat4d(int)>& to_world) {
  const std::string pointer = fmt::format("/skins/{}", skin);
  const tinygltf::Skin& source = document.model().skins[at(skin)];
  const std::vector<int>& joints = source.joints;
  PosedSkin posed{bind_matrices(document, accessors, source, pointer), Vec3d(0.0)};
  posed.joint_matrices.resize(joints.size());
  posed.origin = Vec3d(to_world(joints.front())[3]);
  for (std::size_t j = 0; j < joints.size(); ++j) {
    Mat4d joint_to_world = to_world(joints[j]);
    joint_to_world[3] -= Vec4d(posed.origin, 0.0);
    posed.joint_matrices[j] = joint_to_world * posed.joint_matrices[j];
  }
  return posed;
}

}  // namespace abbe::gltf
