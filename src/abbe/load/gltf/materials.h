/// glTF materials with the KHR extensions the renderer knows, and ABBE_material.
#pragma once

#include "abbe/load/gltf/document/document.h"
#include "abbe/load/gltf/document/fields.h"
#include "abbe/load/gltf/spectra.h"
#include "abbe/load/gltf/textures.h"
#include "abbe/scene/scene.h"

namespace abbe::gltf {

/// One material. Values outside their range are limited with a warning where a sensible picture
/// remains, and are errors where none does.
/// Errors: input Error with a JSON pointer.
Material read_material(Document& document, std::size_t index, Textures& textures, Spectra& spectra);

/// ABBE_material over what the rest of the material said.
///
/// `dispersion` implies transmission 1 and volume, `conductor` implies metallic 1. Both describe
/// polished bodies: where the file states no roughnessFactor it is 0 instead of glTF's 1, and
/// metallicFactor is likewise 0 for glass.
void apply_abbe_material(Document& document, const Fields& extension, const Json& source,
                         Spectra& spectra, Material& material);

}  // namespace abbe::gltf
