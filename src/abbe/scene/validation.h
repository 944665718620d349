/// Whether a scene keeps the promises that everything above relies on.
#pragma once

#include <string>

#include "abbe/scene/scene.h"

namespace abbe {

/// Checks indices, sizes of per-vertex and pixel arrays, and that numbers are finite and in their
/// domains. Loaders report mistakes of a file more closely; this catches scenes made otherwise.
/// Errors: input Error at `where` and the element, e.g. `box.gltf: materials[2]`.
void validate(const Scene& scene, const std::string& where);
/// The same of a camera alone.
void validate(const Camera& camera, const std::string& where);

}  // namespace abbe
