/// Vertices moved by morph targets and by the joints of a skin.
#pragma once

#include <cstddef>
#include <vector>

#include "abbe/math/vec.h"
#include "abbe/scene/scene.h"

namespace abbe::gltf {

/// What one morph target adds at full weight.
/// Shape: each empty, or as long as the mesh has vertices.
struct MorphTarget {
  double weight = 0.0;
  std::vector<Vec3f> positions, normals, tangents;
  std::vector<Vec2f> uv[2];
  std::vector<Vec4f> colors;
};

/// Four joints of each vertex and their weights; a mesh may have several of these.
/// Shape: both as long as the mesh has vertices; joints are whole numbers.
struct JointSet {
  std::vector<Vec4f> joints;
  std::vector<Vec4f> weights;
};

/// What is odd about the weights of vertices: how many do not add up to 1 (by more than codes of
/// 8 bits round), or are negative or not finite.
struct JointFaults {
  std::size_t sums = 0, weights = 0;
};

/// Makes weights fit to be used: those that are negative or not finite become 0, and the sum over
/// all sets 1; a vertex without any weight belongs to its first joint.
JointFaults repair_weights(std::vector<JointSet>& sets);

/// Adds the targets, then moves each vertex by the mean of its joints' matrices, in double
/// precision. Normals go with the inverse transpose, tangents with the matrix. Where the mean
/// mirrors, handedness of tangents turns, and triangles are wound the other way, so that their
/// fronts stay fronts. Colours end within 0 to 1. Shape:  without sets, `joint_matrices` are not
/// used. Domain: every joint is a number of a matrix; weights as repair_weights leaves them. Units:
/// matrices take metres of mesh space to metres of where the mesh is placed. Source:
/// glTF 2.0, 3.7.2.2 and 3.7.3.3.
void deform(Mesh& mesh, const std::vector<MorphTarget>& targets, const std::vector<JointSet>& sets,
            const std::vector<Mat4d>& joint_matrices);

}  // namespace abbe::gltf
