#include "abbe/load/gltf.h"

#include <fmt/format.h>
#include <tiny_gltf.h>

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "abbe/base/error.h"
#include "abbe/base/text.h"
#include "abbe/load/gltf/document/accessors.h"
#include "abbe/load/gltf/document/check.h"
#include "abbe/load/gltf/document/document.h"
#include "abbe/load/gltf/lights.h"
#include "abbe/load/gltf/materials.h"
#include "abbe/load/gltf/motion/animation.h"
#include "abbe/load/gltf/placement/nodes.h"
#include "abbe/load/gltf/placer.h"
#include "abbe/load/gltf/spectra.h"
#include "abbe/load/gltf/surroundings/image_based.h"
#include "abbe/load/gltf/textures.h"
#include "abbe/load/gltf/variants.h"
#include "abbe/scene/colors.h"
#include "abbe/scene/validation.h"

namespace abbe {
namespace gltf {
namespace {

std::optional<int> chosen_scene(const Document& document, const LoadOptions& options) {
  const tinygltf::Model& model = document.model();
  if (options.scene_name) {
    std::vector<std::string> names;
    for (std::size_t i = 0; i < model.scenes.size(); ++i) {
      const std::string& name = model.scenes[i].name;
      if (name == *options.scene_name) return static_cast<int>(i);
      names.push_back(name.empty() ? std::to_string(i) : name);
    }
    // By its number, where no scene has that for a name.
    for (std::size_t i = 0; i < model.scenes.size(); ++i) {
      if (std::to_string(i) == *options.scene_name) return static_cast<int>(i);
    }
    throw_usage_error("scene", in_quotes(*options.scene_name), "a scene of " + document.file_name(),
                      names);
  }
  if (model.defaultScene >= 0) return model.defaultScene;
  if (model.scenes.empty()) return std::nullopt;
  return 0;
}

std::string generator_of(const Document& document) {
  const Json* asset = find(&document.json(), "asset");
  const Json* generator = find(asset, "generator");
  return generator != nullptr && generator->is_string() ? generator->get<std::string>() : "";
}

}  // namespace
}  // namespace gltf

namespace {

Scene read_scene(const std::filesystem::path& file, const Catalogue& catalogue,
                 const LoadOptions& options, Notes& notes) {
  gltf::Document document(file, notes, options.strict);
  gltf::check_structure(document);
  gltf::check_extensions(document);
  document.read_model();
  gltf::check_graph(document);
  gltf::check_animations(document);

  Scene scene;
  scene.generator = gltf::generator_of(document);
  gltf::Accessors accessors(document);
  gltf::Spectra spectra(document, catalogue);
  gltf::Textures textures(document, accessors, options.texture_memory, scene);
  textures.check_uris();
  const gltf::Json* materials = gltf::find(&document.json(), "materials");
  for (std::size_t i = 0; materials != nullptr && i < materials->size(); ++i) {
    scene.materials.push_back(gltf::read_material(document, i, textures, spectra));
  }

  const std::optional<int> chosen = gltf::chosen_scene(document, options);
  std::vector<int> roots;
  if (chosen) {
    scene.name = document.model().scenes[gltf::at(*chosen)].name;
    roots = gltf::scene_roots(document, *chosen);
    gltf::apply_abbe_scene(document, *chosen, spectra, scene);
    gltf::apply_image_based_light(document, accessors, *chosen, scene);
  } else {
    roots = gltf::parentless_nodes(document);
    notes.info(document.file_name(), "the file has no scene; all its nodes are taken");
  }
  scene.animations = gltf::list_animations(document, accessors);
  gltf::Pose pose;
  if (options.time_s) {
    pose = gltf::pose_at(document, accessors, *options.time_s, options.animation);
  }
  gltf::Places places(document, std::move(pose));
  scene.variants = gltf::variant_names(document);
  gltf::Placer placer(document, accessors, places, spectra,
                      gltf::chosen_variant(document, options.variant), scene);
  for (const gltf::PlacedNode& node : places.place(roots)) placer.place(node);
  if (scene.instances.empty()) {
    // Nothing but what is wrong with the file says why.
    if (document.first_fault()) throw *document.first_fault();
    notes.warn(document.file_name(), "the scene has nothing to render");
  }
  scene.emissive_light = scene.lights.empty();
  for (const char* name : {"ABBE_light", "ABBE_material", "ABBE_scene", "ABBE_shape"}) {
    scene.uses_abbe = scene.uses_abbe || gltf::uses_extension(document, name);
  }
  scene.content_hash = document.content_hash();
  validate(scene, document.file_name());
  convert_colors_to_rec709(scene);
  return scene;
}

}  // namespace

Scene load_gltf(const std::filesystem::path& file, const Catalogue& catalogue,
                const LoadOptions& options, Notes& notes) {
  const std::size_t said_before = notes.all().size();
  Scene scene = read_scene(file, catalogue, options, notes);
  if (!options.strict) return scene;
  for (std::size_t i = said_before; i < notes.all().size(); ++i) {
    const Note& note = notes.all()[i];
    if (note.kind != NoteKind::Warning) continue;
    throw_input_error(note.where, note.text,
                      "nothing to ignore, drop, limit or replace in a strict file");
  }
  return scene;
}

}  // namespace abbe
