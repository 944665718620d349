/// glTF mesh primitives as triangle meshes.
#pragma once

#include <optional>
#include <vector>

#include "abbe/load/gltf/document/accessors.h"
#include "abbe/load/gltf/document/document.h"
#include "abbe/load/gltf/motion/skin.h"
#include "abbe/scene/scene.h"

namespace abbe::gltf {

/// How the vertices of a mesh are moved.
struct Deformation {
  std::vector<double> weights;      ///< One a morph target, or none for all 0.
  const PosedSkin* skin = nullptr;  ///< Moves the primitives that have joints.
};

/// One primitive of a mesh, its material still as glTF has it (0 where it has none). Points and
/// lines, and what is left empty, give nothing and a note. Skinned ones, those with Mesh::joints,
/// are in world space, from the skin's origin.
/// Errors: input Error with a JSON pointer.
std::optional<Mesh> read_primitive(Document& document, Accessors& accessors, int mesh,
                                   std::size_t primitive, const Deformation& deformation);

/// Adds the triangles of a mesh to another of the same material, if both have the same attributes
/// and are moved by the same. False: they stay apart.
bool append_alike(const Mesh& mesh, Mesh& whole);

/// Drops triangles with a non-finite or unusably large corner and degenerate ones, then vertices
/// that no triangle uses, and repairs normals, tangents, texture coordinates and colours; each
/// repair is one note with a count.
void clean(Mesh& mesh, const std::string& where, Notes& notes);

}  // namespace abbe::gltf
