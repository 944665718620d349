/// The nodes of a scene as what stands there.
#pragma once

#include <tiny_gltf.h>

#include <compare>
#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "abbe/load/gltf/document/accessors.h"
#include "abbe/load/gltf/document/document.h"
#include "abbe/load/gltf/motion/skin.h"
#include "abbe/load/gltf/placement/nodes.h"
#include "abbe/load/gltf/spectra.h"
#include "abbe/math/ray.h"
#include "abbe/scene/scene.h"

namespace abbe::gltf {

/// Turns the nodes of one scene into instances, lights and cameras.
class Placer {
 public:
  /// All of these outlive this. Materials are in `scene` already; `variant` chooses among those of
  /// a primitive.
  Placer(Document& document, Accessors& accessors, Places& places, Spectra& spectra,
         std::optional<std::size_t> variant, Scene& scene)
      : document_(document),
        model_(document.model()),
        accessors_(accessors),
        places_(places),
        spectra_(spectra),
        variant_(variant),
        scene_(scene) {}

  /// Adds what stands at a node, and the meshes that no node before it has used in this way.
  /// Errors: input Error with a JSON pointer, also for more triangles or instances than a scene may
  ///         have.
  void place(const PlacedNode& node);

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

  // A primitive of a mesh, or several that are one boundary.
  struct Part {
    Mesh mesh;
    std::string pointer;  // To the first.
  };

  // One geometry: a mesh of the file, and how it is deformed.
  struct Use {
    int mesh = -1;
    int skin = -1;
    std::vector<double> weights;  // None where all are 0.
    auto operator<=>(const Use&) const = default;
  };

  Use use_of(const PlacedNode& node, const std::string& pointer);
  std::vector<double> morph_weights(const tinygltf::Node& node, const tinygltf::Mesh& mesh,
                                    const NodePose* pose, const std::string& pointer);
  const PosedSkin& posed_skin(int skin);
  const Converted& converted(const Use& use);
  std::uint32_t material_index(int index);
  void warn_of_missing_uv(const Mesh& mesh, const std::string& pointer);
  void add_part(Mesh mesh, const std::string& pointer, std::vector<Part>& parts) const;
  void turn_outward(Mesh& mesh, const std::string& pointer);
  void place_mesh(const PlacedNode& node, const std::string& pointer);
  void place_group(const Group& group, const Mat4d& to_world, const std::string& name,
                   const std::string& pointer);
  bool is_flat(const Mat4d& to_world, const std::string& pointer);
  bool is_far(const Vec3d& place, const std::string& pointer);
  void count(const Group& group, const std::string& pointer);
  void count(const Shape& shape, const std::string& pointer);
  void count_instances(std::size_t more, const std::string& pointer);

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

}  // namespace abbe::gltf
