/// Thin films of a glTF material: KHR_materials_iridescence and the film of ABBE_material.
#pragma once

#include "abbe/load/gltf/document/document.h"
#include "abbe/load/gltf/document/fields.h"
#include "abbe/load/gltf/spectra.h"
#include "abbe/load/gltf/textures.h"
#include "abbe/scene/scene.h"

namespace abbe::gltf {

/// KHR_materials_iridescence, with its textures, into material.film; nothing where its factor is 0.
/// Errors: input Error with a JSON pointer. Source: Khronos, KHR_materials_iridescence.
void read_iridescence(const Fields& extensions, Document& document, Textures& textures,
                      Material& material);

/// ABBE_material.film over the iridescence of the same material: `ior` (a number, a table or an id
/// of the catalogue) replaces its index, `thickness_nm` its thickness with range and texture; what
/// is not stated stays. Without an iridescence both are required.
/// Errors: input Error with a JSON pointer.
void apply_abbe_film(const Fields& film, Document& document, Spectra& spectra, Material& material);

}  // namespace abbe::gltf
