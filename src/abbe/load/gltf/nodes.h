/// The node graph of a glTF file, and what stands at its nodes.
#pragma once

#include <tiny_gltf.h>

#include <functional>
#include <string>

#include "abbe/load/gltf/document/document.h"
#include "abbe/math/vec.h"

namespace abbe::gltf {

/// A node with its place in the world.
struct PlacedNode {
  int index = 0;
  std::string name;  ///< Its own, or "node 3".
  Mat4d to_world{1.0};
};

/// Checks that the nodes are a forest: one parent each, no cycles.
/// Errors: input Error at the node.
void check_graph(const Document& document, const tinygltf::Model& model);

/// The roots of a scene, each once and none below another; what is not so is a fault.
std::vector<int> scene_roots(Document& document, const tinygltf::Model& model, int scene);

/// Calls `visit` for each node below the given roots, parents before children, in file order.
/// Chains of any length are walked without recursion.
/// Errors: input Error when a transform leaves the range of double precision.
void visit_nodes(Document& document, const tinygltf::Model& model, const std::vector<int>& roots,
                 const std::function<void(const PlacedNode&)>& visit);

/// The placement without scale and shear: −Z and +Y of the node as near as a rotation can have
/// them.
Mat4d rigid(const Mat4d& to_world);

}  // namespace abbe::gltf
