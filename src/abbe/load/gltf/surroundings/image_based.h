/// EXT_lights_image_based: the surroundings of a scene as six images.
#pragma once

#include "abbe/load/gltf/document/accessors.h"
#include "abbe/load/gltf/document/document.h"
#include "abbe/scene/scene.h"

namespace abbe::gltf {

/// Gives a scene the environment that EXT_lights_image_based names, if it does, unless it has one
/// of ABBE_scene. The first level of the cube is taken as luminances; further levels and the
/// coefficients of irradiance only say what follows from it, and are not read.
/// Nothing, with a fault, where an image is missing.
/// Errors: input Error with a JSON pointer.
/// Source: EXT_lights_image_based; its RGBD is what Babylon.js, which it is written after, has.
void apply_image_based_light(Document& document, Accessors& accessors, int scene_index,
                             Scene& scene);

}  // namespace abbe::gltf
