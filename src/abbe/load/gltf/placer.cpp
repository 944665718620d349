#include "abbe/load/gltf/placer.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <glm/gtc/matrix_transform.hpp>
#include <utility>
#include <variant>

#include "abbe/base/error.h"
#include "abbe/load/gltf/document/check.h"
#include "abbe/load/gltf/lights.h"
#include "abbe/load/gltf/materials.h"
#include "abbe/load/gltf/meshes.h"
#include "abbe/load/gltf/motion/attributes.h"
#include "abbe/load/gltf/placement/instancing.h"
#include "abbe/load/gltf/variants.h"
#include "abbe/scene/shells.h"
#include "abbe/scene/texture_uses.h"

namespace abbe::gltf {

void Placer::place(const PlacedNode& node) {
  const tinygltf::Node& source = model_.nodes[at(node.index)];
  const std::string pointer = fmt::format("/nodes/{}", node.index);
  if (source.mesh >= 0 && node.is_visible) place_mesh(node, pointer);
  if (source.camera >= 0) {
    Camera camera = read_camera(document_, source.camera);
    if (camera.name.empty()) camera.name = node.name;
    camera.to_world = rigid(node.to_world);
    scene_.cameras.push_back(std::move(camera));
  }
  const Json* extension = find_extension(document_, "nodes", node.index, "KHR_lights_punctual");
  if (extension != nullptr && node.is_visible) {
    Light light = read_light(document_, (*extension)["light"].get<int>(), spectra_);
    if (light.name.empty()) light.name = node.name;
    light.to_world = rigid(node.to_world);
    scene_.lights.push_back(std::move(light));
  }
}

Placer::Use Placer::use_of(const PlacedNode& node, const std::string& pointer) {
  const tinygltf::Node& source = model_.nodes[at(node.index)];
  const tinygltf::Mesh& mesh = model_.meshes[at(source.mesh)];
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

std::vector<double> Placer::morph_weights(const tinygltf::Node& node, const tinygltf::Mesh& mesh,
                                          const NodePose* pose, const std::string& pointer) {
  const std::size_t targets = mesh.primitives.empty() ? 0 : mesh.primitives[0].targets.size();
  const bool is_posed = pose != nullptr && !pose->weights.empty();
  const bool is_of_node = !node.weights.empty();
  std::vector<double> weights = is_posed ? pose->weights : is_of_node ? node.weights : mesh.weights;
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

const PosedSkin& Placer::posed_skin(int skin) {
  const auto known = skins_.find(skin);
  if (known != skins_.end()) return known->second;
  return skins_
      .emplace(skin, read_skin(document_, accessors_, skin,
                               [this](int joint) { return places_.to_world(joint); }))
      .first->second;
}

const Placer::Converted& Placer::converted(const Use& use) {
  const auto known = converted_.find(use);
  if (known != converted_.end()) return known->second;
  const int mesh = use.mesh;
  Converted result;
  const tinygltf::Mesh& source = model_.meshes[at(mesh)];
  result.shape = read_shape(document_, mesh);
  if (result.shape) {
    result.shape->name = source.name.empty() ? fmt::format("mesh {}", mesh) : source.name;
    result.shape->material =
        material_index(source.primitives.empty() ? -1 : material_of(document_, mesh, 0, variant_));
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
  std::vector<Part> parts;
  for (std::size_t i = 0; i < source.primitives.size(); ++i) {
    std::optional<Mesh> read = read_primitive(document_, accessors_, mesh, i, deformation);
    if (!read) continue;
    read->material = material_index(material_of(document_, mesh, i, variant_));
    const std::string pointer = fmt::format("/meshes/{}/primitives/{}", mesh, i);
    warn_of_missing_uv(*read, pointer);
    add_part(std::move(*read), pointer, parts);
  }
  for (Part& part : parts) {
    turn_outward(part.mesh, part.pointer);
    Group& group = part.mesh.joints > 0 ? result.skinned : result.rigid;
    for (const Vec3f& position : part.mesh.positions) group.bounds.extend(position);
    group.triangles += part.mesh.triangles.size();
    group.meshes.push_back(static_cast<std::uint32_t>(scene_.meshes.size()));
    scene_.meshes.push_back(std::move(part.mesh));
  }
  return converted_.emplace(use, std::move(result)).first->second;
}

// Primitives may be parts of one boundary between media: only together they are closed, and say
// what is inside.
void Placer::add_part(Mesh mesh, const std::string& pointer, std::vector<Part>& parts) const {
  if (scene_.materials[mesh.material].has_volume) {
    for (Part& part : parts) {
      if (append_alike(mesh, part.mesh)) return;
    }
  }
  parts.push_back({std::move(mesh), pointer});
}

// glTF's default material is made when the first primitive without one appears.
std::uint32_t Placer::material_index(int index) {
  if (index >= 0) return static_cast<std::uint32_t>(index);
  if (!default_material_) {
    default_material_ = static_cast<std::uint32_t>(scene_.materials.size());
    Material material;
    material.name = "default";
    scene_.materials.push_back(std::move(material));
  }
  return *default_material_;
}

void Placer::warn_of_missing_uv(const Mesh& mesh, const std::string& pointer) {
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
void Placer::turn_outward(Mesh& mesh, const std::string& pointer) {
  const Material& material = scene_.materials[mesh.material];
  if (!material.has_volume || !(material.transmission > 0.0f)) return;
  const ShellCount shells = turn_shells_outward(mesh);
  if (shells.turned == 0) return;
  document_.notes().warn(document_.where(pointer),
                         fmt::format("mesh \"{}\" is inside out: {} of its {} closed {} turned",
                                     mesh.name, shells.turned, shells.closed,
                                     shells.closed == 1 ? "surface is" : "surfaces are"));
}

void Placer::place_mesh(const PlacedNode& node, const std::string& pointer) {
  const Use use = use_of(node, pointer);
  const Converted& source = converted(use);
  const std::vector<Mat4d> places = instance_places(document_, accessors_, node.index);
  for (std::size_t i = 0; i < places.size(); ++i) {
    const Mat4d to_world = node.to_world * places[i];
    const std::string name = places.size() == 1 ? node.name : fmt::format("{} [{}]", node.name, i);
    place_group(source.rigid, to_world, name, pointer);
    if (!source.shape || is_flat(to_world, pointer) || is_far(Vec3d(to_world[3]), pointer)) {
      continue;
    }
    count(*source.shape, pointer);
    scene_.instances.push_back({name, *source.shape, to_world});
  }
  if (use.skin >= 0) {
    place_group(source.skinned, glm::translate(Mat4d(1.0), posed_skin(use.skin).origin), node.name,
                pointer);
  }
}

void Placer::place_group(const Group& group, const Mat4d& to_world, const std::string& name,
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

bool Placer::is_flat(const Mat4d& to_world, const std::string& pointer) {
  const Mat3d linear(to_world);
  const double volume = glm::length(linear[0]) * glm::length(linear[1]) * glm::length(linear[2]);
  if (std::abs(glm::determinant(linear)) > 1e-12 * volume) return false;
  document_.notes().warn(document_.where(pointer),
                         "its transform flattens the mesh (a scale of 0); not rendered");
  return true;
}

bool Placer::is_far(const Vec3d& place, const std::string& pointer) {
  constexpr double kFarthest_m = 1e9;  // As for the vertices of a mesh.
  if (std::max({std::abs(place.x), std::abs(place.y), std::abs(place.z)}) <= kFarthest_m) {
    return false;
  }
  document_.notes().warn(document_.where(pointer),
                         fmt::format("reaches beyond {:g} m; not rendered", kFarthest_m));
  return true;
}

// Instances multiply what one mesh costs: a small file must not describe an endless scene.
void Placer::count(const Group& group, const std::string& pointer) {
  constexpr std::uint64_t kMaxTriangles = std::uint64_t{1} << 28;
  placed_triangles_ += group.triangles;
  if (placed_triangles_ > kMaxTriangles) {
    throw_input_error(document_.where(pointer),
                      fmt::format("{} triangles in the scene", placed_triangles_),
                      fmt::format("at most {}", kMaxTriangles));
  }
  count_instances(group.meshes.size(), pointer);
}

void Placer::count(const Shape& shape, const std::string& pointer) {
  constexpr std::uint64_t kMaxPlanes = std::uint64_t{1} << 20;
  const auto* body = std::get_if<ConvexShape>(&shape.geometry);
  placed_planes_ += body == nullptr ? 0 : body->planes.size();
  if (placed_planes_ > kMaxPlanes) {
    throw_input_error(document_.where(pointer), "more planes of convex bodies",
                      fmt::format("at most {}", kMaxPlanes));
  }
  count_instances(1, pointer);
}

void Placer::count_instances(std::size_t more, const std::string& pointer) {
  constexpr std::uint64_t kMaxInstances = std::uint64_t{1} << 22;
  if (scene_.instances.size() + more <= kMaxInstances) return;
  throw_input_error(document_.where(pointer), "more instances",
                    fmt::format("at most {}", kMaxInstances));
}

}  // namespace abbe::gltf
