/// From a file to a scene that can be looked at.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>

#include "abbe/base/notes.h"
#include "abbe/load/spectra/catalogue.h"
#include "abbe/scene/rigs.h"
#include "abbe/scene/scene.h"

namespace abbe {

/// Which scene of which file, seen through which camera, under which light.
struct SceneChoice {
  std::filesystem::path file;  ///< glTF, .gltf or .glb.
  std::string scene = {};      ///< By name; empty: the file's own.
  /// By name, or by number from 0: `#N` where a name may be a number; empty: the first. `frame`,
  /// where no camera has that name: one that frames the scene, though the file has cameras.
  std::string camera = {};
  /// When: the file's animations pose it; absent: as it rests.
  std::optional<double> time_s = {};
  std::string animation = {};  ///< By name or number; empty: all, the first of those that collide.
  std::string variant = {};    ///< Set of materials, by name; empty: what the file shows first.
  bool strict = false;         ///< What viewers put up with in a file is an error.
  /// About how many bytes textures may take of the memory; the image is the same.
  std::uint64_t texture_memory = std::uint64_t{1} << 30;
  std::string lamp = {};  ///< Spectrum of the catalogue for all lamps; empty: the scene's own.
  /// An image of light from all around, instead of what the file has; empty: the file's own.
  std::filesystem::path environment = {};
  /// What its values are multiplied by; absent: 1, or what makes them those of the file's lamps
  /// (see prepare_scene()).
  std::optional<double> environment_scale = {};
  double environment_rotation_deg = 0.0;  ///< As Environment::rotation_deg.
  Rig rig = Rig::Auto;
  /// When the rig is chosen, as for a sequence that begins then; absent: at time_s.
  std::optional<double> rig_time_s = {};
  LightsOthers emissive_light = LightsOthers::Auto;  ///< Of all that emits; Auto: as the file says.
};

/// "auto", "on", "off", as the fields of SceneChoice::emissive_light are typed.
std::string emissive_light_name(LightsOthers choice);
/// Errors: a usage Error at `emissive_light` that lists them.
LightsOthers emissive_light_from_name(const std::string& name);

/// A scene with at least one camera and one source of light, and what was chosen for it; placed
/// about a local origin (Scene::origin_m).
struct PreparedScene {
  Scene scene;
  std::size_t camera = 0;
  Box3d bounds;         ///< Of what the file holds, without the default rig.
  std::string lamp_id;  ///< The spectrum that all lamps were given, if they were.
  AddedRig rig;
  bool has_no_rig = false;  ///< By choice.
  /// `image:HASH` of the file that SceneChoice::environment named; empty without one.
  std::string environment_id;
  /// Of that file: what its values were multiplied by and how it was turned.
  double environment_scale = 1.0, environment_rotation_deg = 0.0;
  LightsOthers emissive_light = LightsOthers::Auto;  ///< As chosen.
  std::optional<double> time_s = {};                 ///< As chosen.
  std::optional<double> rig_time_s = {};             ///< As chosen.
  std::string variant = {};                          ///< As chosen.
  std::string animation = {};                        ///< As chosen, of a scene that is posed.
  bool has_default_camera = false;                   ///< One that frames, asked for or not.

  /// Errors: a usage Error where `camera` is none of the scene's.
  const Camera& chosen_camera() const;
  /// By what SceneChoice::camera finds it: its name; its number where it has none of its own;
  /// "default" where the scene has no camera, "frame" where it was asked for.
  std::string camera_name() const;
};

/// Loads the scene, adds a default camera where there is none (it frames the scene at rest, so that
/// what moves is seen to move) and a rig as choose_rig() has it, and picks the camera. What was
/// ignored or chosen for the scene becomes notes. `rig` is the one of this choice at its
/// rig_time_s, where that is known: the scene need not be loaded for it. Errors: an input Error for
/// a file; a usage Error for an unknown scene, camera or lamp, or for an
///         environment beside a rig.
PreparedScene prepare_scene(const SceneChoice& choice, const Catalogue& catalogue, Notes& notes,
                            const AddedRig* rig = nullptr);

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
