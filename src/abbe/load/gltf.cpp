#include "abbe/load/gltf.h"

#include <fmt/format.h>
#include <tiny_gltf.h>

#include <algorithm>
#include <cmath>
#include <compare>
#include <glm/gtc/matrix_transform.hpp>
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
#include "abbe/load/gltf/motion/animation.h"
#include "abbe/load/gltf/motion/attributes.h"
#include "abbe/load/gltf/motion/skin.h"
#include "abbe/load/gltf/placement/instancing.h"
#include "abbe/load/gltf/placement/nodes.h"
#include "abbe/load/gltf/spectra.h"
#include "abbe/load/gltf/textures.h"
#include "abbe/load/gltf/variants.h"
#include "abbe/scene/colors.h"
#include "abbe/scene/shells.h"
#include "abbe/scene/texture_uses.h"
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
  // tinygltf 2.7 refuses indices without a bufferView, which are zeros, or sparse: it gets one for
  // them, and it is taken away again.
  std::vector<std::size_t> without_view;
  if (core.contains("accessors") && core.contains("bufferViews")) {
    for (std::size_t i = 0; i < core["accessors"].size(); ++i) {
      if (core["accessors"][i].contains("bufferView")) continue;
      without_view.push_back(i);
      core["accessors"][i]["bufferView"] = 0;
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
  for (const std::size_t i : without_view) model.accessors[i].bufferView = -1;
  return model;
}

// Turns the nodes of one scene into instances, lights and cameras.
class Placer {
 public:
  Placer(Document& document, const tinygltf::Model& model, Accessors& accessors, Places& places,
         Spectra& spectra, std::optional<std::size_t> variant, Scene& scene)
      : document_(document),
        model_(model),
        accessors_(accessors),
        places_(places),
        spectra_(spectra),
        variant_(variant),
        scene_(scene) {}

  void place(const PlacedNode& node) {
    const tinygltf::Node& source = model_.nodes[static_cast<std::size_t>(node.index)];
    const std::string pointer = fmt::format("/nodes/{}", node.index);
    if (source.mesh >= 0) place_mesh(node, pointer);
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
  // Meshes of the scene that are placed together.
  struct Group {
    std::vector<std::uint32_t> meshes;
    Box3f bounds;
    std::uint64_t triangles = 0;
  };

  // What a mesh of the file became, made when the first node uses it so. What a skin moves stands
  // where its joints are, all else where the node is.
  struct Converted {
    Group rigid, skinned;
    std::optional<Shape> shape;
  };

  // One geometry: a mesh of the file, and how it is deformed.
  struct Use {
    int mesh = -1;
    int skin = -1;
    std::vector<double> weights;  // None where all are 0.
    auto operator<=>(const Use&) const = default;
  };

  Use use_of(const PlacedNode& node, const std::string& pointer) {
    const tinygltf::Node& source = model_.nodes[static_cast<std::size_t>(node.index)];
    const tinygltf::Mesh& mesh = model_.meshes[static_cast<std::size_t>(source.mesh)];
    Use use{source.mesh, -1, morph_weights(source, mesh, places_.pose_of(node.index), pointer)};
    if (source.skin < 0) return use;
    // Once a mesh: many nodes may use one of many primitives.
    const auto [known, is_new] = can_be_skinned_.emplace(source.mesh, false);
    if (is_new) {
      known->second = std::any_of(mesh.primitives.begin(), mesh.primitives.end(), has_joints) &&
                      !read_shape(document_, source.mesh);
    }
    if (known->second) {
      use.skin = source.skin;
    } else {
      document_.fault(pointer + "/skin", "a skin for a mesh without JOINTS_0 and WEIGHTS_0",
                      "a mesh with both", "the mesh stands where its node is");
    }
    return use;
  }

  std::vector<double> morph_weights(const tinygltf::Node& node, const tinygltf::Mesh& mesh,
                                    const NodePose* pose, const std::string& pointer) {
    const std::size_t targets = mesh.primitives.empty() ? 0 : mesh.primitives[0].targets.size();
    const bool is_posed = pose != nullptr && !pose->weights.empty();
    const bool is_of_node = !node.weights.empty();
    std::vector<double> weights = is_posed     ? pose->weights
                                  : is_of_node ? node.weights
                                               : mesh.weights;
    accessors_.spend(weights.size(), pointer);
    if (!weights.empty() && weights.size() != targets) {
      document_.fault(
          is_of_node ? pointer + "/weights" : fmt::format("/meshes/{}/weights", node.mesh),
          fmt::format("{} weights", weights.size()),
          fmt::format("one for each of {} morph targets", targets),
          "those that are missing are 0, and others ignored");
      weights.resize(targets, 0.0);
    }
    const bool are_none =
        std::all_of(weights.begin(), weights.end(), [](double weight) { return weight == 0.0; });
    return are_none ? std::vector<double>{} : weights;
  }

  const PosedSkin& posed_skin(int skin) {
    const auto known = skins_.find(skin);
    if (known != skins_.end()) return known->second;
    return skins_
        .emplace(skin, read_skin(document_, accessors_, skin,
                                 [this](int joint) { return places_.to_world(joint); }))
        .first->second;
  }

  const Converted& converted(const Use& use) {
    const auto known = converted_.find(use);
    if (known != converted_.end()) return known->second;
    const int mesh = use.mesh;
    Converted result;
    const tinygltf::Mesh& source = model_.meshes[static_cast<std::size_t>(mesh)];
    result.shape = read_shape(document_, mesh);
    if (result.shape) {
      result.shape->name = source.name.empty() ? fmt::format("mesh {}", mesh) : source.name;
      result.shape->material = material_index(
          source.primitives.empty() ? -1 : material_of(document_, mesh, 0, variant_));
      if (source.primitives.size() > 1) {
        document_.notes().warn(document_.where(fmt::format("/meshes/{}/primitives", mesh)),
                               "an ABBE_shape has one material: that of the first primitive");
      }
      return converted_.emplace(use, std::move(result)).first->second;
    }
    if (source.primitives.empty()) {
      document_.fault(fmt::format("/meshes/{}/primitives", mesh), "no primitive", "one or more",
                      "the mesh is not rendered");
    }
    const Deformation deformation{use.weights, use.skin < 0 ? nullptr : &posed_skin(use.skin)};
    for (std::size_t i = 0; i < source.primitives.size(); ++i) {
      std::optional<Mesh> read =
          read_primitive(document_, model_, accessors_, mesh, i, deformation);
      if (!read) continue;
      read->material = material_index(material_of(document_, mesh, i, variant_));
      warn_of_missing_uv(*read, fmt::format("/meshes/{}/primitives/{}", mesh, i));
      turn_outward(*read, fmt::format("/meshes/{}/primitives/{}", mesh, i));
      Group& group = read->joints > 0 ? result.skinned : result.rigid;
      for (const Vec3f& position : read->positions) group.bounds.extend(position);
      group.triangles += read->triangles.size();
      group.meshes.push_back(static_cast<std::uint32_t>(scene_.meshes.size()));
      scene_.meshes.push_back(std::move(*read));
    }
    return converted_.emplace(use, std::move(result)).first->second;
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
    if (material.anisotropy && mesh.uv[0].empty() && mesh.tangents.empty()) {
      document_.notes().warn(document_.where(pointer),
                             fmt::format("its material \"{}\" is rougher along one direction, "
                                         "which needs TANGENT or TEXCOORD_0: it is as rough along "
                                         "all",
                                         material.name));
    }
    for (const TextureUse* use : texture_uses(material)) {
      if (!mesh.uv[use->uv_set].empty()) continue;
      document_.notes().warn(document_.where(pointer),
                             fmt::format("its material \"{}\" has textures on TEXCOORD_{}, which "
                                         "the mesh lacks: they are sampled at 0, 0",
                                         material.name, use->uv_set));
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

  void place_mesh(const PlacedNode& node, const std::string& pointer) {
    const Use use = use_of(node, pointer);
    const Converted& source = converted(use);
    const std::vector<Mat4d> places = instance_places(document_, accessors_, node.index);
    for (std::size_t i = 0; i < places.size(); ++i) {
      const Mat4d to_world = node.to_world * places[i];
      const std::string name =
          places.size() == 1 ? node.name : fmt::format("{} [{}]", node.name, i);
      place_group(source.rigid, to_world, name, pointer);
      if (!source.shape || is_flat(to_world, pointer) || is_far(Vec3d(to_world[3]), pointer)) {
        continue;
      }
      count(*source.shape, pointer);
      scene_.instances.push_back({name, *source.shape, to_world});
    }
    if (use.skin >= 0) {
      place_group(source.skinned, glm::translate(Mat4d(1.0), posed_skin(use.skin).origin),
                  node.name, pointer);
    }
  }

  void place_group(const Group& group, const Mat4d& to_world, const std::string& name,
                   const std::string& pointer) {
    if (group.meshes.empty() || is_flat(to_world, pointer)) return;
    Vec3d farthest(0.0);
    for (int corner = 0; corner < 8 && !group.bounds.is_empty(); ++corner) {
      const Box3f& box = group.bounds;
      const Vec4d point((corner & 1) != 0 ? box.high.x : box.low.x,
                        (corner & 2) != 0 ? box.high.y : box.low.y,
                        (corner & 4) != 0 ? box.high.z : box.low.z, 1.0);
      farthest = glm::max(farthest, glm::abs(Vec3d(to_world * point)));
    }
    if (is_far(farthest, pointer)) return;
    count(group, pointer);
    for (const std::uint32_t index : group.meshes) {
      scene_.instances.push_back({name, index, to_world});
    }
  }

  bool is_flat(const Mat4d& to_world, const std::string& pointer) {
    const Mat3d linear(to_world);
    const double volume = glm::length(linear[0]) * glm::length(linear[1]) * glm::length(linear[2]);
    if (std::abs(glm::determinant(linear)) > 1e-12 * volume) return false;
    document_.notes().warn(document_.where(pointer),
                           "its transform flattens the mesh (a scale of 0); not rendered");
    return true;
  }

  bool is_far(const Vec3d& place, const std::string& pointer) {
    constexpr double kFarthest_m = 1e9;  // As for the vertices of a mesh.
    if (std::max({std::abs(place.x), std::abs(place.y), std::abs(place.z)}) <= kFarthest_m) {
      return false;
    }
    document_.notes().warn(document_.where(pointer),
                           fmt::format("reaches beyond {:g} m; not rendered", kFarthest_m));
    return true;
  }

  // Instances multiply what one mesh costs: a small file must not describe an endless scene.
  void count(const Group& group, const std::string& pointer) {
    constexpr std::uint64_t kMaxTriangles = std::uint64_t{1} << 28;
    placed_triangles_ += group.triangles;
    if (placed_triangles_ > kMaxTriangles) {
      throw_input_error(document_.where(pointer),
                        fmt::format("{} triangles in the scene", placed_triangles_),
                        fmt::format("at most {}", kMaxTriangles));
    }
    count_instances(group.meshes.size(), pointer);
  }

  void count(const Shape& shape, const std::string& pointer) {
    constexpr std::uint64_t kMaxPlanes = std::uint64_t{1} << 20;
    const auto* body = std::get_if<ConvexShape>(&shape.geometry);
    placed_planes_ += body == nullptr ? 0 : body->planes.size();
    if (placed_planes_ > kMaxPlanes) {
      throw_input_error(document_.where(pointer), "more planes of convex bodies",
                        fmt::format("at most {}", kMaxPlanes));
    }
    count_instances(1, pointer);
  }

  void count_instances(std::size_t more, const std::string& pointer) {
    constexpr std::uint64_t kMaxInstances = std::uint64_t{1} << 22;
    if (scene_.instances.size() + more <= kMaxInstances) return;
    throw_input_error(document_.where(pointer), "more instances",
                      fmt::format("at most {}", kMaxInstances));
  }

  Document& document_;
  const tinygltf::Model& model_;
  Accessors& accessors_;
  Places& places_;
  Spectra& spectra_;
  std::optional<std::size_t> variant_;
  Scene& scene_;
  std::map<Use, Converted> converted_;
  std::map<int, PosedSkin> skins_;
  std::map<int, bool> can_be_skinned_;
  std::optional<std::uint32_t> default_material_;
  std::uint64_t placed_triangles_ = 0;
  std::uint64_t placed_planes_ = 0;
};

std::optional<int> chosen_scene(const Document& document, const tinygltf::Model& model,
                                const LoadOptions& options) {
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
  gltf::check_animations(document);

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
  scene.animations = gltf::list_animations(document, accessors);
  gltf::Pose pose;
  if (options.time_s) {
    pose = gltf::pose_at(document, model, accessors, *options.time_s, options.animation);
  }
  gltf::Places places(document, model, std::move(pose));
  scene.variants = gltf::variant_names(document);
  gltf::Placer placer(document, model, accessors, places, spectra,
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

}  // namespace abbe
