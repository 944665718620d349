/// EXT_mesh_gpu_instancing: one node, many places.
#pragma once

#include <vector>

#include "abbe/load/gltf/document/accessors.h"
#include "abbe/load/gltf/document/document.h"
#include "abbe/math/vec.h"

namespace abbe::gltf {

/// Where the mesh of a node stands in the node's space: of a node with the extension once for each
/// element of its attributes, of others once, where the node is.
/// Errors: input Error for attributes of several lengths or of another type.
std::vector<Mat4d> instance_places(Document& document, Accessors& accessors, int node);

}  // namespace abbe::gltf
