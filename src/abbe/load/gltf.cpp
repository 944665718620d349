#include "abbe/load/gltf.h"

#include <fmt/format.h>
#include <tiny_gltf.h>

#include <cmath>
#include <map>
#include <set>

#include "abbe/base/error.h"
#include "abbe/base/text.h"
#include "abbe/load/gltf/document/accessors.h"
#include "abbe/load/gltf/document/check.h"
#include "abbe/load/gltf/document/document.h"
#include "abbe/load/gltf/lights.h"
#include "abbe/load/gltf/materials.h"
#include "abbe/load/gltf/meshes.h"
#include "abbe/load/gltf/nodes.h"
#include "abbe/load/gltf/spectra.h"
#include "abbe/load/gltf/textures.h"
#include "abbe/scene/colors.h"
#include "abbe/scene/shells.h"
#include "abbe/scene/validation.h"

namespace abbe {
namespace gltf {
namespace {

// What tinygltf understands better than a tree of JSON does. It never sees a URI, so it opens no
// file, nor extras and extensions, which it would only copy.
tinygltf::Model parse_core(const Document& document) {
  Json core = {{"asset", {{"version", "2.0"}}}};
  const auto strip = [](Json& object) {
    object.erase("extras");
    object.erase("extensions");
  };
  for (const char* name :
       {"scenes", "nodes", "meshes", "accessors", "bufferViews", "samplers", "textures"}) {
    const Json* source = find(&document.json(), name);
    if (source == nullptr) continue;
    core[name] = *source;
    for (Json& element : core[name]) {
      strip(element);
      if (!element.contains("primitives")) continue;
      for (Json& primitive : element["primitives"]) strip(primitive);
    }
  }
  const std::string text = core.dump();
  tinygltf::TinyGLTF reader;
  reader.SetFsCallbacks({nullptr, nullptr, nullptr, nullptr, nullptr});
  tinygltf::Model model;
  std::string error;
  std::string warning;
  if (!reader.LoadASCIIFromString(&model, &error, &warning, text.data(),
                                  static_cast<unsigned>(text.size()), "")) {
    while (!error.empty() && error.back() == '\n') error.pop_back();
    throw_input_error(document.file_name(), error, "glTF 2.0");
  }
  return model;
}

// Turns the nodes of one scene into instances, lights and cameras.
class Placer {
 public:
  Placer(Document& document, const tinygltf::Model& model, Accessors& accessors, Spectra& spectra,
         Scene& scene)
      : document_(document),
        model_(model),
        accessors_(accessors),
        spectra_(spectra),
        scene_(scene) {}

  void place(const PlacedNode& node) {
    const tinygltf::Node& source = model_.nodes[static_cast<std::size_t>(node.index)];
    const std::string pointer = fmt::format("/nodes/{}", node.index);
    if (source.skin >= 0) {
      document_.notes().warn(document_.where(pointer + "/skin"),
                             "skins are not applied: the mesh is rendered as it was modelled");
    }
    if (source.mesh >= 0) place_mesh(node, source.mesh, pointer);
    if (source.camera >= 0) {
      Camera camera = read_camera(document_, source.camera);
      if (camera.name.empty()) camera.name = node.name;
      camera.to_world = rigid(node.to_world);
      scene_.cameras.push_back(std::move(camera));
    }
    const Json& json = document_.json()["nodes"][static_cast<std::size_t>(node.index)];
    if (const Json* extension = find_extension(json, "KHR_lights_punctual")) {
      Light light = read_light(document_, (*extension)["light"].get<int>(), spectra_);
      if (light.name.empty()) light.name = node.name;
      light.to_world = rigid(node.to_world);
      scene_.lights.push_back(std::move(light));
    }
  }

 private:
  // What a mesh of the file became, made when the first node uses it.
  struct Converted {
    std::vector<std::uint32_t> meshes;
    std::optional<Shape> shape;
    Box3f bounds;
    std::uint64_t triangles = 0;
  };

  const Converted& converted(int mesh) {
    const auto known = converted_.find(mesh);
    if (known != converted_.end()) return known->second;
    Converted result;
    const tinygltf::Mesh& source = model_.meshes[static_cast<std::size_t>(mesh)];
    result.shape = read_shape(document_, mesh);
    if (result.shape) {
      result.shape->name = source.name.empty() ? fmt::format("mesh {}", mesh) : source.name;
      result.shape->material =
          material_index(source.primitives.empty() ? -1 : source.primitives.front().material);
      if (source.primitives.size() > 1) {
        document_.notes().warn(document_.where(fmt::format("/meshes/{}/primitives", mesh)),
                               "an ABBE_shape has one material: that of the first primitive");
      }
      return converted_.emplace(mesh, std::move(result)).first->second;
    }
    if (source.primitives.empty()) {
      document_.fault(fmt::format("/meshes/{}/primitives", mesh), "no primitive", "one or more",
                      "the mesh is not rendered");
    }
    for (std::size_t i = 0; i < source.primitives.size(); ++i) {
      std::optional<Mesh> read = read_primitive(document_, model_, accessors_, mesh, i);
      if (!read) continue;
      read->material = material_index(source.primitives[i].material);
      warn_of_missing_uv(*read, fmt::format("/meshes/{}/primitives/{}", mesh, i));
      turn_outward(*read, fmt::format("/meshes/{}/primitives/{}", mesh, i));
      for (const Vec3f& position : read->positions) result.bounds.extend(position);
      result.triangles += read->triangles.size();
      result.meshes.push_back(static_cast<std::uint32_t>(scene_.meshes.size()));
      scene_.meshes.push_back(std::move(*read));
    }
    return converted_.emplace(mesh, std::move(result)).first->second;
  }

  // glTF's default material is made when the first primitive without one appears.
  std::uint32_t material_index(int index) {
    if (index >= 0) return static_cast<std::uint32_t>(index);
    if (!default_material_) {
      default_material_ = static_cast<std::uint32_t>(scene_.materials.size());
      Material material;
      material.name = "default";
      scene_.materials.push_back(std::move(material));
    }
    return *default_material_;
  }

  void warn_of_missing_uv(const Mesh& mesh, const std::string& pointer) {
    const Material& material = scene_.materials[mesh.material];
    const ThinFilm film = material.film.value_or(ThinFilm{});
    for (const auto* use :
         {&material.base_color_texture, &material.metallic_roughness_texture,
          &material.normal_texture, &material.emissive_texture, &material.transmission_texture,
          &film.factor_texture, &film.thickness_texture}) {
      if (!*use || !mesh.uv[(*use)->uv_set].empty()) continue;
      document_.notes().warn(document_.where(pointer),
                             fmt::format("its material \"{}\" has textures on TEXCOORD_{}, which "
                                         "the mesh lacks: they are sampled at 0, 0",
                                         material.name, (*use)->uv_set));
      return;
    }
  }

  // Of bodies that light goes through it matters which side is the inside.
  void turn_outward(Mesh& mesh, const std::string& pointer) {
    const Material& material = scene_.materials[mesh.material];
    if (!material.has_volume || !(material.transmission > 0.0f)) return;
    const ShellCount shells = turn_shells_outward(mesh);
    if (shells.turned == 0) return;
    document_.notes().warn(document_.where(pointer),
                           fmt::format("mesh \"{}\" is inside out: {} of its {} closed {} turned",
                                       mesh.name, shells.turned, shells.closed,
                                       shells.closed == 1 ? "surface is" : "surfaces are"));
  }

  void place_mesh(const PlacedNode& node, int mesh, const std::string& pointer) {
    const Converted& source = converted(mesh);
    if (!source.shape && source.meshes.empty()) return;
    if (!is_placeable(node, source, pointer)) return;
    count(source, pointer);
    if (source.shape) {
      scene_.instances.push_back({node.name, *source.shape, node.to_world});
    }
    for (const std::uint32_t index : source.meshes) {
      scene_.instances.push_back({node.name, index, node.to_world});
    }
  }

  bool is_placeable(const PlacedNode& node, const Converted& source, const std::string& pointer) {
    const Mat3d linear(node.to_world);
    const double volume = glm::length(linear[0]) * glm::length(linear[1]) * glm::length(linear[2]);
    if (!(std::abs(glm::determinant(linear)) > 1e-12 * volume)) {
      document_.notes().warn(document_.where(pointer),
                             "its transform flattens the mesh (a scale of 0); not rendered");
      return false;
    }
    constexpr double kFarthest_m = 1e9;  // As for the vertices of a mesh.
    double farthest_m = 0.0;
    for (int corner = 0; corner < 8 && !source.bounds.is_empty(); ++corner) {
      const Box3f& box = source.bounds;
      const Vec4d point((corner & 1) != 0 ? box.high.x : box.low.x,
                        (corner & 2) != 0 ? box.high.y : box.low.y,
                        (corner & 4) != 0 ? box.high.z : box.low.z, 1.0);
      const Vec3d placed(node.to_world * point);
      farthest_m =
          std::max({farthest_m, std::abs(placed.x), std::abs(placed.y), std::abs(placed.z)});
    }
    if (source.shape) {
      const Vec3d center(node.to_world[3]);
      farthest_m = std::max({std::abs(center.x), std::abs(center.y), std::abs(center.z)});
    }
    if (!(farthest_m <= kFarthest_m)) {
      document_.notes().warn(document_.where(pointer),
                             fmt::format("reaches beyond {:g} m; not rendered", kFarthest_m));
      return false;
    }
    return true;
  }

  // Instances multiply what one mesh costs: a small file must not describe an endless scene.
  void count(const Converted& source, const std::string& pointer) {
    constexpr std::uint64_t kMaxTriangles = std::uint64_t{1} << 28;
    constexpr std::uint64_t kMaxInstances = std::uint64_t{1} << 22;
    constexpr std::uint64_t kMaxPlanes = std::uint64_t{1} << 20;
    if (source.shape) {
      const auto* body = std::get_if<ConvexShape>(&source.shape->geometry);
      placed_planes_ += body == nullptr ? 0 : body->planes.size();
      if (placed_planes_ > kMaxPlanes) {
        throw_input_error(document_.where(pointer), "more planes of convex bodies",
                          fmt::format("at most {}", kMaxPlanes));
      }
    }
    placed_triangles_ += source.triangles;
    if (placed_triangles_ > kMaxTriangles) {
      throw_input_error(document_.where(pointer),
                        fmt::format("{} triangles in the scene", placed_triangles_),
                        fmt::format("at most {}", kMaxTriangles));
    }
    if (scene_.instances.size() + source.meshes.size() + 1 > kMaxInstances) {
      throw_input_error(document_.where(pointer), "more instances",
                        fmt::format("at most {}", kMaxInstances));
    }
  }

  Document& document_;
  const tinygltf::Model& model_;
  Accessors& accessors_;
  Spectra& spectra_;
  Scene& scene_;
  std::map<int, Converted> converted_;
  std::optional<std::uint32_t> default_material_;
  std::uint64_t placed_triangles_ = 0;
  std::uint64_t placed_planes_ = 0;
};

std::optional<int> chosen_scene(const Document& document, const tinygltf::Model& model,
                                const LoadOptions& options) {
  if (options.scene_name) {
    std::vector<std::string> names;
    for (std::size_t i = 0; i < model.scenes.size(); ++i) {
      if (model.scenes[i].name == *options.scene_name) return static_cast<int>(i);
      names.push_back(model.scenes[i].name);
    }
    throw_usage_error("scene", in_quotes(*options.scene_name), "a scene of " + document.file_name(),
                      names);
  }
  if (const Json* scene = find(&document.json(), "scene")) return scene->get<int>();
  if (model.scenes.empty()) return std::nullopt;
  return 0;
}

std::vector<int> parentless_nodes(const tinygltf::Model& model) {
  std::set<int> children;
  for (const tinygltf::Node& node : model.nodes) {
    children.insert(node.children.begin(), node.children.end());
  }
  std::vector<int> roots;
  for (std::size_t i = 0; i < model.nodes.size(); ++i) {
    if (children.count(static_cast<int>(i)) == 0) roots.push_back(static_cast<int>(i));
  }
  return roots;
}

}  // namespace
}  // namespace gltf

Scene load_gltf(const std::filesystem::path& file, const Catalogue& catalogue,
                const LoadOptions& options, Notes& notes) {
  gltf::Document document(file, notes, options.strict);
  gltf::check_structure(document);
  gltf::check_extensions(document);
  const tinygltf::Model model = gltf::parse_core(document);
  gltf::check_graph(document, model);

  Scene scene;
  gltf::Accessors accessors(document, model);
  gltf::Spectra spectra(document, catalogue);
  gltf::Textures textures(document, model, accessors, scene);
  textures.check_uris();
  const gltf::Json* materials = gltf::find(&document.json(), "materials");
  for (std::size_t i = 0; materials != nullptr && i < materials->size(); ++i) {
    scene.materials.push_back(gltf::read_material(document, i, textures, spectra));
  }

  const std::optional<int> chosen = gltf::chosen_scene(document, model, options);
  std::vector<int> roots;
  if (chosen) {
    const tinygltf::Scene& source = model.scenes[static_cast<std::size_t>(*chosen)];
    scene.name = source.name;
    roots = gltf::scene_roots(document, model, *chosen);
    gltf::apply_abbe_scene(document, *chosen, spectra, scene);
  } else {
    roots = gltf::parentless_nodes(model);
    notes.info(document.file_name(), "the file has no scene; all its nodes are taken");
  }
  gltf::Placer placer(document, model, accessors, spectra, scene);
  gltf::visit_nodes(document, model, roots,
                    [&placer](const gltf::PlacedNode& node) { placer.place(node); });
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

}  // namespace abbe
