/// KHR_materials_variants: other materials for the same meshes.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "abbe/load/gltf/document/document.h"

namespace abbe::gltf {

/// Their names, in file order.
std::vector<std::string> variant_names(const Document& document);

/// The number of a variant; of an empty name none: materials are those of the primitives.
/// Errors: a usage Error at `variant` that lists the names.
std::optional<std::size_t> chosen_variant(const Document& document, const std::string& name);

/// The material of a primitive of a mesh, -1 for glTF's default one: its own, or what it has for
/// the variant.
int material_of(const Document& document, int mesh, std::size_t primitive,
                std::optional<std::size_t> variant);

}  // namespace abbe::gltf
