/// Light for files that bring none, or too little of it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "abbe/scene/scene.h"

namespace abbe {

/// Studio: an environment of soft boxes on grey, with a key light; in a scene that is closed around
///         the camera, ambient light and a lamp beside the camera. Surround: an environment of even
///         grey, faint beside the lamps. Auto: a studio for a scene without lamps, environment or
///         ambient light (emission does not count, an ambient light of 0 does), a surround for one
///         of lamps alone whose file has none of our extensions, else none.
enum class Rig : std::uint8_t { Auto, Studio, Surround, None };

/// "auto", "studio", "surround", "none", in this order.
const std::vector<std::string>& rig_names();
std::string rig_name(Rig rig);
/// Errors: a usage Error at `rig` that lists them.
Rig rig_from_name(const std::string& name);

/// What is added to a scene: a Studio, a Surround or None, and why, in a line for people (empty
/// where nothing is).
struct AddedRig {
  Rig rig = Rig::None;
  std::string line = {};
  std::shared_ptr<const Environment> environment = {};
  std::optional<Ambient> ambient = {};
  std::optional<Light> lamp = {};  ///< Where the scene's author would place it (Scene::origin_m).
};

/// The rig for a scene. One asked for by name is added whatever the scene has: it takes the place
/// of an environment and of ambient light, and stands beside lamps.
/// Domain: `camera` is a number of scene.cameras: its right, front and above are where the key
///         light stands; `d65` is the spectrum of ambient light.
AddedRig choose_rig(const Scene& scene, Rig rig, std::size_t camera, const NamedSpectrum& d65);

/// Adds a rig to the scene that it was chosen for, or to another that is to be lit alike.
void add_rig(Scene& scene, const AddedRig& rig);

/// Chooses a rig and adds it.
AddedRig add_rig(Scene& scene, Rig rig, std::size_t camera, const NamedSpectrum& d65);

/// The studio, seen by a camera that looks along −Z: 512x256 texels, grey of 0.18 cd/m² below to
/// 0.24 above, a key light at the right, in front and above, a fill light at the left and a rim
/// light behind, all white. What is white, diffuse and faces the key light has 1 cd/m².
std::shared_ptr<const Environment> studio_environment(double rotation_deg);

/// Whether light from outside cannot come in where the camera looks: of what it sees, less than
/// 3 % sees the outside. Decided by some rays; what lets light through does not close, nor does the
/// back of a single-sided opaque surface.
bool is_closed_around(const Scene& scene, const Camera& camera);

/// Whether all that some of a camera's rays meet are surfaces that are not there from behind, seen
/// from there: its picture is empty.
bool sees_only_backs(const Scene& scene, const Camera& camera);

}  // namespace abbe
