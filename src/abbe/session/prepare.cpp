#include "abbe/session/prepare.h"

#include <fmt/format.h>

#include <algorithm>
#include <optional>
#include <utility>

#include "abbe/base/error.h"
#include "abbe/base/text.h"
#include "abbe/load/gltf.h"
#include "abbe/load/spectra/foreign.h"
#include "abbe/scene/lamps.h"
#include "abbe/scene/local_origin.h"

namespace abbe {
namespace {

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

}  // namespace

const Camera& PreparedScene::chosen_camera() const {
  if (camera >= scene.cameras.size()) {
    throw_usage_error("camera", fmt::format("number {}", camera),
                      fmt::format("one of the scene's {} cameras, from 0", scene.cameras.size()));
  }
  return scene.cameras[camera];
}

std::string PreparedScene::camera_name() const {
  const std::string& name = chosen_camera().name;
  if (has_default_camera) return "default";
  const auto count_of = [this](const std::string& text) {
    return std::count_if(scene.cameras.begin(), scene.cameras.end(),
                         [&text](const Camera& other) { return other.name == text; });
  };
  // "default" is none of the scene's, and # begins a number.
  const bool is_own = !name.empty() && name != "default" && name.front() != '#';
  if (is_own && count_of(name) == 1) return name;
  const std::string number = std::to_string(camera);
  return (count_of(number) > 0 ? "#" : "") + number;
}

PreparedScene prepare_scene(const SceneChoice& choice, const Catalogue& catalogue, Notes& notes) {
  LoadOptions load;
  if (!choice.scene.empty()) load.scene_name = choice.scene;
  for (const Note& note : catalogue.notes().all()) notes.warn(note.where, note.text);
  PreparedScene prepared;
  prepared.scene = load_gltf(choice.file, catalogue, load, notes);
  std::optional<std::size_t> seen_through;
  if (!prepared.scene.cameras.empty()) {
    seen_through = camera_index(prepared.scene, choice.camera);
  }
  place_about_local_origin(prepared.scene, seen_through);
  prepared.bounds = bounds_of(prepared.scene);
  prepared.has_default_camera = add_default_camera(prepared.scene);
  prepared.has_default_lights = add_default_lights(prepared.scene);
  if (prepared.has_default_lights) {
    notes.info(
        "",
        "the scene has no light of its own: lit by a default key and fill lamp in a grey surround");
  }
  if (prepared.has_default_camera) {
    notes.info("", "the scene has no camera: seen by a default one that frames it");
  }
  if (!choice.lamp.empty()) {
    const NamedSpectrum lamp = lamp_of(choice.lamp, catalogue);
    prepared.lamp_id = lamp.id;
    replace_lamps(prepared.scene, lamp);
  }
  prepared.camera = camera_index(prepared.scene, choice.camera);
  return prepared;
}

Standards read_standards(Catalogue catalogue) {
  Observer observer = catalogue.observer();
  Spectrum d65 = catalogue.illuminant("illuminant/D65");
  return {std::move(catalogue), std::move(observer), std::move(d65)};
}

}  // namespace abbe
