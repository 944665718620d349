/// From a file to a scene that can be looked at.
#pragma once

#include <cstddef>

#include "abbe/base/notes.h"
#include "abbe/cli/console.h"
#include "abbe/cli/options.h"
#include "abbe/load/spectra/catalogue.h"
#include "abbe/scene/scene.h"
#include "abbe/world/world.h"

namespace abbe {

/// A scene with at least one camera and one source of light, and what was chosen for it.
struct PreparedScene {
  Scene scene;
  std::size_t camera = 0;
  Box3f bounds;         ///< Of what the file holds, without the default rig.
  std::string lamp_id;  ///< The spectrum that all lamps were given, if they were.
  bool has_default_lights = false;
  bool has_default_camera = false;

  const Camera& chosen_camera() const { return scene.cameras[camera]; }
};

/// Loads the scene, adds a default rig and a default camera where there is none, and picks the
/// camera. Errors: an input Error for the file; a usage Error for an unknown scene or camera.
PreparedScene prepare_scene(const SceneOptions& options, const Catalogue& catalogue, Notes& notes);

/// Completes the settings by the camera and checks them again. Errors: a usage Error.
void settle_size(SceneOptions& options, const Camera& camera);

/// The observer and the white that everything is measured by.
struct Standards {
  Observer observer;
  Spectrum d65;
};
Standards read_standards(const Catalogue& catalogue);

}  // namespace abbe
