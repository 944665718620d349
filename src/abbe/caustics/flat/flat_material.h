/// What a material makes of flat faces: glass or a mirror that paths of light go over, or neither.
#pragma once

#include <string>

#include "abbe/scene/scene.h"

namespace abbe {

/// What faces of a material are to light, if they are flat.
struct FlatMaterial {
  enum class Kind { None, Glass, Mirror } kind = Kind::None;
  std::string trouble;  ///< Why light is not followed over it all the same; empty: it is.
};

/// Judges a material on a mesh, or on an exact shape where `mesh` is null. Features that do nothing
/// there count for nothing: layers of no thickness, textures that are white, alpha that is 1, what
/// KHR_materials_specular says of a metal. Glass or a mirror with others has trouble.
FlatMaterial flat_material(const Scene& scene, const Material& material, const Mesh* mesh);

}  // namespace abbe
