/// Layers and lobes of a glTF material beyond the core: clearcoat, sheen, anisotropy, specular,
/// diffuse transmission, and the archived specular-glossiness.
#pragma once

#include "abbe/load/gltf/document/fields.h"
#include "abbe/load/gltf/textures.h"
#include "abbe/scene/scene.h"

namespace abbe::gltf {

/// KHR_materials_clearcoat, _sheen, _anisotropy, _specular and _diffuse_transmission into the
/// material's members of these names. Errors: input Error with a JSON pointer.
/// Source: Khronos, the texts of these extensions, with their defaults.
void read_layers(const Fields& extensions, Document& document, Textures& textures,
                 Material& material);

/// KHR_materials_pbrSpecularGlossiness, which replaces metal, roughness and base colour, as a
/// dielectric of index 1.5 whose KHR_materials_specular colour gives the reflectance at normal
/// incidence: that keeps specular colours and diffuse ones apart, which a metal cannot.
/// Domain: before read_layers().
void read_specular_glossiness(const Fields& extensions, Document& document, Textures& textures,
                              Material& material);

}  // namespace abbe::gltf
