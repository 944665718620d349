/// Meshes compressed by Draco, as KHR_draco_mesh_compression has them.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace abbe::gltf {

/// One attribute wanted of a compressed mesh.
struct DracoAttribute {
  std::uint32_t id = 0;    ///< Its unique id in the compressed data.
  int component_type = 0;  ///< As glTF numbers them: what its values become.
  int components = 0;      ///< Of an element.
  std::string where;       ///< For messages.
};

/// A mesh out of compressed data.
struct DracoMesh {
  std::size_t points = 0;
  std::vector<std::uint32_t> indices;  ///< Three a triangle, below `points`.
  /// Of those wanted, in their order: `points` dense elements each.
  std::vector<std::vector<std::uint8_t>> attributes;
};

/// Whether this build has Draco.
bool has_draco();

/// Decodes a mesh of Draco's bitstream 2.2. Memory is taken only for what so many bytes may hold.
/// Errors: input Error for data that are no such mesh, lack an attribute or have it with other
///         components, or where !has_draco().
DracoMesh decode_draco(std::span<const std::uint8_t> bytes, std::span<const DracoAttribute> wanted,
                       const std::string& where);

}  // namespace abbe::gltf
