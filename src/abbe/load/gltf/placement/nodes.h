/// The node graph of a glTF file, and what stands at its nodes.
#pragma once

#include <tiny_gltf.h>

#include <optional>
#include <string>
#include <vector>

#include "abbe/load/gltf/document/document.h"
#include "abbe/load/gltf/motion/animation.h"
#include "abbe/math/vec.h"

namespace abbe::gltf {

/// A node with its place in the world.
struct PlacedNode {
  int index = 0;
  std::string name;  ///< Its own, or "node 3".
  Mat4d to_world{1.0};
  bool is_visible = true;  ///< Itself and all above it: KHR_node_visibility.
};

/// Checks that the nodes are a forest: one parent each, no cycles.
/// Errors: input Error at the node.
void check_graph(const Document& document);

/// The roots of a scene, each once and none below another; what is not so is a fault.
std::vector<int> scene_roots(Document& document, int scene);

/// The nodes that are no other's child: of a file without a scene.
std::vector<int> parentless_nodes(const Document& document);

/// Where the nodes of a file stand in a pose.
class Places {
 public:
  /// The rest outlives this.
  Places(Document& document, Pose pose);

  /// Places each node below the given roots; parents before children, in file order. Chains of any
  /// length are walked without recursion.
  /// Errors: input Error when a transform leaves the range of double precision.
  std::vector<PlacedNode> place(const std::vector<int>& roots);

  /// Where any node is: of one that was placed, there; of others, what their parents make of it.
  Mat4d to_world(int node);

  /// What the pose says of a node, if it does.
  const NodePose* pose_of(int node) const;

 private:
  const Mat4d& local(int node);

  Document& document_;
  const tinygltf::Model& model_;
  Pose pose_;
  std::vector<int> parents_;
  std::vector<std::optional<Mat4d>> locals_, worlds_;
};

/// The placement without scale and shear: −Z and +Y of the node as near as a rotation can have
/// them.
Mat4d rigid(const Mat4d& to_world);

}  // namespace abbe::gltf
