/// The arrays of a primitive by which its vertices move.
#pragma once

#include <tiny_gltf.h>

#include <cstddef>
#include <string>
#include <vector>

#include "abbe/load/gltf/document/accessors.h"
#include "abbe/load/gltf/document/document.h"
#include "abbe/load/gltf/motion/deform.h"

namespace abbe::gltf {

/// The targets whose weight is not 0, for the vertices selected.
/// Errors: input Error at an accessor of another type, or of another count than POSITION.
std::vector<MorphTarget> read_morph_targets(Document& document, Accessors& accessors,
                                            const tinygltf::Primitive& source,
                                            const std::vector<double>& weights,
                                            const Selection& selected, const std::string& pointer);

/// JOINTS_n and WEIGHTS_n of the vertices selected, fit to be used with a skin of so many joints;
/// what had to be repaired is a fault.
/// Errors: as above; input Error for a joint that the skin does not have, where it has a weight.
std::vector<JointSet> read_joints(Document& document, Accessors& accessors,
                                  const tinygltf::Primitive& source, std::size_t joint_count,
                                  const Selection& selected, const std::string& pointer);

/// Whether a skin can move the primitive.
bool has_joints(const tinygltf::Primitive& source);

}  // namespace abbe::gltf
