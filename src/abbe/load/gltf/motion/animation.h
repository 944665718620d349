/// glTF's animations: what they are called, and what they make of nodes at a time.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "abbe/load/gltf/document/accessors.h"
#include "abbe/load/gltf/document/document.h"
#include "abbe/math/vec.h"
#include "abbe/scene/scene.h"

namespace abbe::gltf {

/// What animations say of one node, instead of what it says itself.
struct NodePose {
  std::optional<Vec3d> translation, scale;
  std::optional<Vec4d> rotation;  ///< Quaternion x, y, z, w.
  std::vector<double> weights;    ///< Of the morph targets of its mesh; empty: its own.
};

/// By the number of the node; nodes that nothing moves are absent.
using Pose = std::map<int, NodePose>;

/// Checks that channels name samplers of their animation. Errors: input Error at the channel.
void check_animations(Document& document);

/// Names ("animation 2" for one without) and lengths, in file order. Without a `max` of its times
/// an animation's length is read from them.
std::vector<Animation> list_animations(Document& document, Accessors& accessors);

/// The pose at a time, of the animation chosen by name or by number from 0, or of all: where two
/// move one property of a node, the first of the file is taken, and a note says so. Before its
/// first key a property has the value of that key, after its last the last.
/// Errors: a usage Error at `animation` for one that the file does not have; an input Error for
///         data that cannot be read. What breaks a rule otherwise is a fault, and left out.
Pose pose_at(Document& document, Accessors& accessors, double time_s, const std::string& animation);

}  // namespace abbe::gltf
