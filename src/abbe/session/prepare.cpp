#include "abbe/session/prepare.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "abbe/base/error.h"
#include "abbe/base/file.h"
#include "abbe/base/text.h"
#include "abbe/load/environment.h"
#include "abbe/load/gltf.h"
#include "abbe/load/spectra/foreign.h"
#include "abbe/scene/lamps.h"
#include "abbe/scene/local_origin.h"

namespace abbe {
namespace {

// The name of a camera that frames the scene.
constexpr const char* kFrame = "frame";

std::size_t camera_index(const Scene& scene, const std::string& name) {
  if (name.empty()) return 0;
  const auto number = whole_u32_of(name.substr(name.front() == '#' ? 1 : 0));
  const bool has_number = number && *number < scene.cameras.size();
  if (has_number && name.front() == '#') return *number;
  std::vector<std::string> names;
  for (std::size_t i = 0; i < scene.cameras.size(); ++i) {
    if (scene.cameras[i].name == name) return i;
    names.push_back(scene.cameras[i].name.empty() ? std::to_string(i) : scene.cameras[i].name);
  }
  if (has_number) return *number;
  throw_usage_error("camera", in_quotes(name), "a camera of the scene", names);
}

// An unknown id in a scene is bad input, as a choice wrong usage.
std::string resolved(const std::string& id_or_tail, const Catalogue& catalogue) {
  try {
    return catalogue.resolve(id_or_tail, "lamp");
  } catch (const Error& error) {
    ErrorDetail detail = error.detail();
    detail.kind = ErrorKind::Usage;
    throw Error(std::move(detail));
  }
}

NamedSpectrum lamp_of(const std::string& id_or_tail, const Catalogue& catalogue) {
  const std::string id = resolved(id_or_tail, catalogue);
  const CatalogueEntry entry = catalogue.entry(id, "lamp");
  const bool is_lamp = entry.quantity == "emission" || entry.quantity == kPlainTable;
  if (!is_lamp || !entry.spectrum) {
    throw_usage_error("lamp", fmt::format("{} ({})", id, entry.quantity),
                      "a lamp: an emission of the catalogue, as illuminant/A");
  }
  return {id, *entry.spectrum};
}

bool has_camera(const Scene& scene, const std::string& name) {
  return std::any_of(scene.cameras.begin(), scene.cameras.end(),
                     [&name](const Camera& camera) { return camera.name == name; });
}

// Blender's exporter writes lamps of 1 W/m² and 1 W/sr as 683 lx and 683 cd: 1 in its images of the
// world is 1 W/(m²·sr).
constexpr double kLumensPerWattOfBlender = 683.0;

double environment_scale_of(const SceneChoice& choice, const Scene& scene, Notes& notes) {
  if (choice.environment_scale) return *choice.environment_scale;
  const bool is_of_blender = scene.generator.find("Blender") != std::string::npos;
  if (!is_of_blender || scene.lights.empty()) return 1.0;
  notes.info(
      "", fmt::format("lamps of Blender: 1 in {} is {:g} cd/m2 (--environment-scale)",
                      in_quotes(choice.environment.filename().string()), kLumensPerWattOfBlender));
  return kLumensPerWattOfBlender;
}

void check_environment(const SceneChoice& choice) {
  const auto& scale = choice.environment_scale;
  if (scale && !(*scale >= 0.0 && std::isfinite(*scale))) {
    throw_usage_error("environment_scale", fmt::format("{:g}", *scale), "a number of at least 0");
  }
  if (!std::isfinite(choice.environment_rotation_deg)) {
    throw_usage_error("environment_rotation_deg",
                      fmt::format("{:g}", choice.environment_rotation_deg), "degrees");
  }
  if (!choice.environment.empty()) return;
  if (scale) {
    throw_usage_error("environment_scale", fmt::format("{:g}", *scale), "an `environment` with it");
  }
  if (choice.environment_rotation_deg != 0.0) {
    throw_usage_error("environment_rotation_deg",
                      fmt::format("{:g}", choice.environment_rotation_deg),
                      "an `environment` with it");
  }
}

// The user's own file, which may lie anywhere.
std::shared_ptr<const Environment> environment_of(const SceneChoice& choice, double scale,
                                                  Notes& notes, std::string& id) {
  const std::filesystem::path& file = choice.environment;
  auto environment = std::make_shared<Environment>();
  environment->scale = scale;
  environment->rotation_deg = choice.environment_rotation_deg;
  environment->name = file.filename().string();
  environment->image = read_environment_image(file, file.string(), notes);
  constexpr std::uint64_t kLargestFile = std::uint64_t{4} << 30;
  const std::vector<std::uint8_t> bytes = read_file(file, file.string(), kLargestFile);
  id = fmt::format("image:{:016x}", hash_bytes(bytes.data(), bytes.size()));
  return environment;
}

void check_time(const SceneChoice& choice) {
  if (!choice.time_s && !choice.animation.empty()) {
    throw_usage_error("animation", in_quotes(choice.animation), "a `time_s` at which to see it");
  }
  if (choice.time_s && !std::isfinite(*choice.time_s)) {
    throw_usage_error("time_s", fmt::format("{}", *choice.time_s), "seconds");
  }
  if (choice.rig_time_s && !std::isfinite(*choice.rig_time_s)) {
    throw_usage_error("rig_time_s", fmt::format("{}", *choice.rig_time_s), "seconds");
  }
}

// Frames the scene at rest, but for a scene whose zero is at `origin_m`.
Camera camera_at_rest(const SceneChoice& choice, const Catalogue& catalogue,
                      const Vec3d& origin_m) {
  LoadOptions load;
  if (!choice.scene.empty()) load.scene_name = choice.scene;
  load.texture_memory = choice.texture_memory;
  Notes said_already;
  Camera camera = framing_camera(load_gltf(choice.file, catalogue, load, said_already));
  camera.to_world[3] -= Vec4d(origin_m, 0.0);
  return camera;
}

// The rig of the scene at another time.
AddedRig rig_at(const SceneChoice& choice, double time_s, const Catalogue& catalogue) {
  SceneChoice then = choice;
  then.time_s = time_s;
  then.rig_time_s.reset();
  Notes said_already;
  return prepare_scene(then, catalogue, said_already).rig;
}

// What lights the scene, by choice or by the lack of it.
void light_scene(const SceneChoice& choice, const Catalogue& catalogue, const AddedRig* rig,
                 PreparedScene& prepared, Notes& notes) {
  Scene& scene = prepared.scene;
  check_environment(choice);
  if (!choice.environment.empty()) {
    if (choice.rig == Rig::Studio || choice.rig == Rig::Surround) {
      throw_usage_error("rig", rig_name(choice.rig) + " beside an `environment`", "one of the two");
    }
    if (scene.environment) {
      notes.info("", in_quotes(choice.environment.filename().string()) +
                         " takes the place of the file's environment");
    }
    prepared.environment_scale = environment_scale_of(choice, scene, notes);
    prepared.environment_rotation_deg = choice.environment_rotation_deg;
    scene.environment =
        environment_of(choice, prepared.environment_scale, notes, prepared.environment_id);
  }
  const NamedSpectrum d65{"illuminant/D65", catalogue.illuminant("illuminant/D65")};
  prepared.has_no_rig = choice.rig == Rig::None;
  prepared.rig_time_s = choice.rig_time_s;
  const bool is_of_now = !choice.rig_time_s || choice.rig_time_s == choice.time_s;
  prepared.rig = rig != nullptr ? *rig
                 : is_of_now    ? choose_rig(scene, choice.rig, prepared.camera, d65)
                                : rig_at(choice, *choice.rig_time_s, catalogue);
  add_rig(scene, prepared.rig);
  if (!prepared.rig.line.empty()) {
    const std::string& line = prepared.rig.line;
    notes.info("", !choice.rig_time_s
                       ? line
                       : fmt::format("{}; as at {:g} s, in all frames", line, *choice.rig_time_s));
  }
  prepared.emissive_light = choice.emissive_light;
  if (choice.emissive_light == LightsOthers::Auto) return;
  scene.emissive_light = choice.emissive_light == LightsOthers::Yes;
  for (Material& material : scene.materials) material.lights_others = choice.emissive_light;
}

const std::vector<std::string>& emissive_light_names() {
  static const std::vector<std::string> names{"auto", "on", "off"};  // As LightsOthers has them.
  return names;
}

}  // namespace

std::string emissive_light_name(LightsOthers choice) {
  return emissive_light_names()[static_cast<std::size_t>(choice)];
}

LightsOthers emissive_light_from_name(const std::string& name) {
  return static_cast<LightsOthers>(check_choice(
      "emissive_light", name, "whether what emits lights others", emissive_light_names()));
}

const Camera& PreparedScene::chosen_camera() const {
  if (camera >= scene.cameras.size()) {
    throw_usage_error("camera", fmt::format("number {}", camera),
                      fmt::format("one of the scene's {} cameras, from 0", scene.cameras.size()));
  }
  return scene.cameras[camera];
}

std::string PreparedScene::camera_name() const {
  const std::string& name = chosen_camera().name;
  if (has_default_camera) return name;
  const auto count_of = [this](const std::string& text) {
    return std::count_if(scene.cameras.begin(), scene.cameras.end(),
                         [&text](const Camera& other) { return other.name == text; });
  };
  // These two are none of the scene's, and # begins a number.
  const bool is_own = !name.empty() && name != "default" && name != kFrame && name.front() != '#';
  if (is_own && count_of(name) == 1) return name;
  const std::string number = std::to_string(camera);
  return (count_of(number) > 0 ? "#" : "") + number;
}

PreparedScene prepare_scene(const SceneChoice& choice, const Catalogue& catalogue, Notes& notes,
                            const AddedRig* rig) {
  LoadOptions load;
  load.strict = choice.strict;
  load.texture_memory = choice.texture_memory;
  load.time_s = choice.time_s;
  load.animation = choice.animation;
  load.variant = choice.variant;
  if (!choice.scene.empty()) load.scene_name = choice.scene;
  for (const Note& note : catalogue.notes().all()) notes.warn(note.where, note.text);
  PreparedScene prepared;
  check_time(choice);
  prepared.scene = load_gltf(choice.file, catalogue, load, notes);
  prepared.variant = choice.variant;
  prepared.time_s = choice.time_s;
  if (choice.time_s) prepared.animation = choice.animation;
  const bool wants_frame = choice.camera == kFrame && !has_camera(prepared.scene, kFrame);
  std::optional<std::size_t> seen_through;
  if (!prepared.scene.cameras.empty() && !wants_frame) {
    seen_through = camera_index(prepared.scene, choice.camera);
  }
  place_about_local_origin(prepared.scene, seen_through);
  prepared.bounds = bounds_of(prepared.scene);
  prepared.has_default_camera = wants_frame || prepared.scene.cameras.empty();
  if (prepared.has_default_camera) {
    // Seen first: a name may be one of the scene's.
    Camera framing = choice.time_s ? camera_at_rest(choice, catalogue, prepared.scene.origin_m)
                                   : framing_camera(prepared.scene);
    if (wants_frame) framing.name = kFrame;
    notes.info("", wants_frame ? "seen by a camera that frames the scene"
                               : "the scene has no camera: seen by a default one that frames it");
    if (sees_only_backs(prepared.scene, framing)) {
      notes.warn("",
                 "that camera sees only backs of single-sided surfaces, which are not there from "
                 "behind: the picture is empty (a camera on the other side, or doubleSided)");
    }
    prepared.scene.cameras.push_back(std::move(framing));
  }
  prepared.camera =
      wants_frame ? prepared.scene.cameras.size() - 1 : camera_index(prepared.scene, choice.camera);
  light_scene(choice, catalogue, rig, prepared, notes);
  if (!choice.lamp.empty()) {
    const NamedSpectrum lamp = lamp_of(choice.lamp, catalogue);
    prepared.lamp_id = lamp.id;
    replace_lamps(prepared.scene, lamp);
  }
  return prepared;
}

Standards read_standards(Catalogue catalogue) {
  Observer observer = catalogue.observer();
  Spectrum d65 = catalogue.illuminant("illuminant/D65");
  return {std::move(catalogue), std::move(observer), std::move(d65)};
}

}  // namespace abbe
