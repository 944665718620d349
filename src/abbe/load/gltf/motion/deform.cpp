#include "abbe/load/gltf/motion/deform.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace abbe::gltf {
namespace {

// A mesh's vertices in double precision, so that a sum of many targets rounds once.
struct Vertices {
  std::vector<Vec3d> positions, normals, tangents;
};

template <typename T, typename U>
void add(double weight, const std::vector<T>& changes, std::vector<U>& values) {
  for (std::size_t i = 0; i < std::min(changes.size(), values.size()); ++i) {
    values[i] += weight * U(changes[i]);
  }
}

template <int N>
void add_single(double weight, const std::vector<glm::vec<N, float>>& changes,
                std::vector<glm::vec<N, float>>& values) {
  using Double = glm::vec<N, double>;
  for (std::size_t i = 0; i < std::min(changes.size(), values.size()); ++i) {
    values[i] = glm::vec<N, float>(Double(values[i]) + weight * Double(changes[i]));
  }
}

void morph(const std::vector<MorphTarget>& targets, Vertices& vertices, Mesh& mesh) {
  bool has_colors = false;
  for (const MorphTarget& target : targets) {
    add(target.weight, target.positions, vertices.positions);
    add(target.weight, target.normals, vertices.normals);
    add(target.weight, target.tangents, vertices.tangents);
    for (int set = 0; set < 2; ++set) add_single<2>(target.weight, target.uv[set], mesh.uv[set]);
    add_single<4>(target.weight, target.colors, mesh.colors_rec709);
    has_colors = has_colors || !target.colors.empty();
  }
  if (!has_colors) return;
  for (Vec4f& color : mesh.colors_rec709) color = glm::clamp(color, Vec4f(0.0f), Vec4f(1.0f));
}

Mat4d mean_matrix(const std::vector<JointSet>& sets, const std::vector<Mat4d>& joint_matrices,
                  std::size_t vertex) {
  Mat4d mean(0.0);
  for (const JointSet& set : sets) {
    for (int k = 0; k < 4; ++k) {
      const auto weight = static_cast<double>(set.weights[vertex][k]);
      if (weight == 0.0) continue;
      mean += weight * joint_matrices[static_cast<std::size_t>(set.joints[vertex][k])];
    }
  }
  return mean;
}

// Inverse transpose times determinant: it exists where the inverse does not.
Mat3d cofactors(const Mat3d& m) {
  return {glm::cross(m[1], m[2]), glm::cross(m[2], m[0]), glm::cross(m[0], m[1])};
}

void skin(const std::vector<JointSet>& sets, const std::vector<Mat4d>& joint_matrices,
          Vertices& vertices, Mesh& mesh) {
  std::vector<bool> is_mirrored(vertices.positions.size());
  for (std::size_t i = 0; i < vertices.positions.size(); ++i) {
    const Mat4d matrix = mean_matrix(sets, joint_matrices, i);
    const Mat3d linear(matrix);
    is_mirrored[i] = glm::determinant(linear) < 0.0;
    vertices.positions[i] = Vec3d(matrix * Vec4d(vertices.positions[i], 1.0));
    if (!vertices.normals.empty()) {
      // n·x is what a plane says of a point: outside stays outside, though the space is mirrored.
      vertices.normals[i] =
          (is_mirrored[i] ? -1.0 : 1.0) * (cofactors(linear) * vertices.normals[i]);
    }
    if (!vertices.tangents.empty()) {
      vertices.tangents[i] = linear * vertices.tangents[i];
      if (is_mirrored[i]) mesh.tangents[i].w = -mesh.tangents[i].w;
    }
  }
  for (auto& triangle : mesh.triangles) {
    const auto mirrored = std::count_if(triangle.begin(), triangle.end(),
                                        [&](std::uint32_t vertex) { return is_mirrored[vertex]; });
    if (mirrored >= 2) std::swap(triangle[1], triangle[2]);
  }
}

}  // namespace

JointFaults repair_weights(std::vector<JointSet>& sets) {
  // Four weights of 8 bits, each off by half a code.
  constexpr double kRounding = 4.0 * 0.5 / 255.0;
  JointFaults faults;
  const std::size_t count = sets.empty() ? 0 : sets.front().weights.size();
  for (std::size_t i = 0; i < count; ++i) {
    double sum = 0.0;
    bool is_odd = false;
    for (JointSet& set : sets) {
      for (int k = 0; k < 4; ++k) {
        float& weight = set.weights[i][k];
        if (!(weight >= 0.0f) || !std::isfinite(weight)) {
          weight = 0.0f;
          is_odd = true;
        }
        sum += static_cast<double>(weight);
      }
    }
    faults.weights += is_odd ? 1 : 0;
    faults.sums += !is_odd && std::abs(sum - 1.0) > kRounding ? 1 : 0;
    if (sum == 0.0) {
      sets.front().weights[i].x = 1.0f;
    } else if (sum != 1.0) {
      for (JointSet& set : sets) set.weights[i] = Vec4f(Vec4d(set.weights[i]) / sum);
    }
  }
  return faults;
}

void deform(Mesh& mesh, const std::vector<MorphTarget>& targets, const std::vector<JointSet>& sets,
            const std::vector<Mat4d>& joint_matrices) {
  if (targets.empty() && sets.empty()) return;
  Vertices vertices{{mesh.positions.begin(), mesh.positions.end()},
                    {mesh.normals.begin(), mesh.normals.end()},
                    {mesh.tangents.begin(), mesh.tangents.end()}};
  morph(targets, vertices, mesh);
  if (!sets.empty()) skin(sets, joint_matrices, vertices, mesh);
  for (std::size_t i = 0; i < vertices.positions.size(); ++i) {
    mesh.positions[i] = Vec3f(vertices.positions[i]);
    if (!mesh.normals.empty()) {
      const double length = glm::length(vertices.normals[i]);
      mesh.normals[i] = Vec3f(length > 0.0 ? vertices.normals[i] / length : vertices.normals[i]);
    }
    if (!mesh.tangents.empty()) {
      mesh.tangents[i] = Vec4f(Vec3f(vertices.tangents[i]), mesh.tangents[i].w);
    }
  }
}

}  // namespace abbe::gltf
