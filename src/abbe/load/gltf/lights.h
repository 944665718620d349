/// Cameras, punctual lights and exact shapes of a glTF file.
#pragma once

#include "abbe/load/gltf/document/document.h"
#include "abbe/load/gltf/spectra.h"
#include "abbe/scene/scene.h"

namespace abbe::gltf {

/// A camera at the identity. Errors: input Error with a JSON pointer.
Camera read_camera(Document& document, int index);

/// A light of KHR_lights_punctual, with ABBE_light, at the identity. Errors: as above.
Light read_light(Document& document, int index, Spectra& spectra);

/// The shape of ABBE_shape, if the mesh has one; name and material are left to the caller.
std::optional<Shape> read_shape(Document& document, int mesh);

/// ABBE_scene.
void apply_abbe_scene(Document& document, int scene_index, Spectra& spectra, Scene& scene);

}  // namespace abbe::gltf
