/// From a file to a scene that can be looked at.
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>

#include "abbe/base/notes.h"
#include "abbe/load/spectra/catalogue.h"
#include "abbe/scene/scene.h"

namespace abbe {

/// Which scene of which file, seen through which camera, under which light.
struct SceneChoice {
  std::filesystem::path file;  ///< glTF, .gltf or .glb.
  std::string scene = {};      ///< By name; empty: the file's own.
  /// By name, or by number from 0: `#N` where a name may be a number; empty: the first.
  std::string camera = {};
  std::string lamp = {};  ///< Spectrum of the catalogue for all lamps; empty: the scene's own.
};

/// A scene with at least one camera and one source of light, and what was chosen for it; placed
/// about a local origin (Scene::origin_m).
struct PreparedScene {
  Scene scene;
  std::size_t camera = 0;
  Box3d bounds;         ///< Of what the file holds, without the default rig.
  std::string lamp_id;  ///< The spectrum that all lamps were given, if they were.
  bool has_default_lights = false;
  bool has_default_camera = false;

  /// Errors: a usage Error where `camera` is none of the scene's.
  const Camera& chosen_camera() const;
  /// By what SceneChoice::camera finds it: its name; its number where it has none of its own;
  /// "default" where the scene has no camera.
  std::string camera_name() const;
};

/// Loads the scene, adds a default rig and a default camera where there is none, and picks the
/// camera. What was ignored or chosen for the scene becomes notes.
/// Errors: an input Error for the file; a usage Error for an unknown scene, camera or lamp.
PreparedScene prepare_scene(const SceneChoice& choice, const Catalogue& catalogue, Notes& notes);

/// What everything is measured by: the catalogue of spectra, the observer CIE 1931 and D65.
struct Standards {
  Catalogue catalogue;
  Observer observer;
  Spectrum d65;
};

/// Of the catalogue that stands beside the program, or that ABBE_SPECTRA_PATH names.
/// Errors: an input Error when there is none, or the observer or D65 are not in it.
Standards read_standards(Catalogue catalogue = Catalogue::standard());

}  // namespace abbe
