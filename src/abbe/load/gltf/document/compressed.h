/// What a document keeps compressed: buffer views by EXT_meshopt_compression, primitives by
/// KHR_draco_mesh_compression.
#pragma once

#include <tiny_gltf.h>

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "abbe/load/gltf/codec/meshopt.h"
#include "abbe/load/gltf/document/accessors.h"
#include "abbe/load/gltf/document/document.h"

namespace abbe::gltf {

/// Where the bytes of a compressed buffer view lie, and what they become.
struct CompressedView {
  int buffer = 0;
  std::uint64_t offset = 0, length = 0;  ///< Bytes.
  MeshoptArray array;
};

/// What EXT_meshopt_compression says of a buffer view, if it is there. Nothing, with a warning,
/// where this build cannot decode and the plain data are there instead.
/// Errors: input Error when it contradicts itself or its buffer view, and for a build that cannot
///         decode what is not there as plain data.
std::optional<CompressedView> compressed_view(Document& document, int buffer_view);

/// The corners of a primitive that KHR_draco_mesh_compression holds; its attributes are supplied to
/// `accessors`. Nothing where it holds none, or, with a warning, where this build cannot decode and
/// the plain data are there instead.
/// Errors: input Error for broken data, attributes that are not there or that the primitive lacks,
///         and for a build that cannot decode what is not there as plain data.
std::optional<std::vector<std::uint32_t>> decode_primitive(Document& document, Accessors& accessors,
                                                           int mesh, std::size_t primitive);

}  // namespace abbe::gltf
