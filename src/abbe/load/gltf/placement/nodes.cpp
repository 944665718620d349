#include "abbe/load/gltf/placement/nodes.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "abbe/base/error.h"
#include "abbe/load/gltf/document/check.h"
#include "abbe/load/gltf/placement/transform.h"

namespace abbe::gltf {
namespace {

constexpr int kNone = -1;

// Of a forest.
std::vector<int> parents_of(const tinygltf::Model& model) {
  std::vector<int> parents(model.nodes.size(), kNone);
  for (std::size_t i = 0; i < model.nodes.size(); ++i) {
    for (const int child : model.nodes[i].children) parents[at(child)] = static_cast<int>(i);
  }
  return parents;
}

// What KHR_node_visibility says of a node itself.
bool shows(const Document& document, int node) {
  const Json* extension = find_extension(document, "nodes", node, "KHR_node_visibility");
  const Json* visible = find(extension, "visible");
  return visible == nullptr || visible->get<bool>();
}

Mat4d from_matrix(const std::vector<double>& m, const std::string& where, Notes& notes) {
  Mat4d result;
  for (int column = 0; column < 4; ++column) {
    for (int row = 0; row < 4; ++row) {
      result[column][row] = m[at(column * 4 + row)];
    }
  }
  const Vec4d last_row(m[3], m[7], m[11], m[15]);
  if (last_row != Vec4d(0.0, 0.0, 0.0, 1.0)) {
    notes.warn(where, fmt::format("last row {:g} {:g} {:g} {:g}; glTF has affine transforms only, "
                                  "0 0 0 1 is used",
                                  m[3], m[7], m[11], m[15]));
    for (int column = 0; column < 3; ++column) result[column][3] = 0.0;
    result[3][3] = 1.0;
  }
  for (int c = 0; c < 3; ++c) {
    const Vec3d a(result[c]);
    const Vec3d b(result[(c + 1) % 3]);
    constexpr double kRounding = 1e-3;  // Writers print a few digits only.
    if (std::abs(glm::dot(a, b)) > kRounding * glm::length(a) * glm::length(b)) {
      notes.warn(where, "a shear, which glTF does not allow; rendered as it stands");
      break;
    }
  }
  return result;
}

Transform transform_of(const tinygltf::Node& node, const NodePose* pose) {
  Transform own;
  if (const auto& t = node.translation; t.size() == 3) own.translation = {t[0], t[1], t[2]};
  if (const auto& r = node.rotation; r.size() == 4) own.rotation = {r[0], r[1], r[2], r[3]};
  if (const auto& s = node.scale; s.size() == 3) own.scale = {s[0], s[1], s[2]};
  if (pose == nullptr) return own;
  return {pose->translation.value_or(own.translation), pose->scale.value_or(own.scale),
          pose->rotation.value_or(own.rotation)};
}

bool is_finite(const Mat4d& m) {
  for (int column = 0; column < 4; ++column) {
    for (int row = 0; row < 4; ++row) {
      if (!std::isfinite(m[column][row])) return false;
    }
  }
  return true;
}

}  // namespace

void check_graph(const Document& document) {
  const tinygltf::Model& model = document.model();
  std::vector<int> parents(model.nodes.size(), kNone);
  for (std::size_t i = 0; i < model.nodes.size(); ++i) {
    const auto& children = model.nodes[i].children;
    for (std::size_t c = 0; c < children.size(); ++c) {
      int& parent = parents[at(children[c])];
      if (parent != kNone) {
        throw_input_error(document.where(fmt::format("/nodes/{}/children/{}", i, c)),
                          fmt::format("node {}, already a child of node {}", children[c], parent),
                          "one parent for each node");
      }
      parent = static_cast<int>(i);
    }
  }
  // With one parent each, what cannot be reached from a root goes round in a cycle.
  std::vector<int> stack;
  std::vector<bool> reached(model.nodes.size(), false);
  for (std::size_t i = 0; i < parents.size(); ++i) {
    if (parents[i] == kNone) stack.push_back(static_cast<int>(i));
  }
  while (!stack.empty()) {
    const int node = stack.back();
    stack.pop_back();
    reached[at(node)] = true;
    const auto& children = model.nodes[at(node)].children;
    stack.insert(stack.end(), children.begin(), children.end());
  }
  const auto lost = std::find(reached.begin(), reached.end(), false);
  if (lost != reached.end()) {
    throw_input_error(document.where(fmt::format("/nodes/{}", lost - reached.begin())),
                      "a node that is its own ancestor", "a tree");
  }
}

std::vector<int> scene_roots(Document& document, int scene) {
  const tinygltf::Model& model = document.model();
  const std::vector<int>& listed = model.scenes[at(scene)].nodes;
  const std::vector<int> parents = parents_of(model);
  std::vector<bool> is_listed(model.nodes.size(), false);
  std::vector<int> roots;
  for (std::size_t i = 0; i < listed.size(); ++i) {
    const int node = listed[i];
    const std::string pointer = fmt::format("/scenes/{}/nodes/{}", scene, i);
    if (is_listed[at(node)]) {
      document.fault(pointer, fmt::format("node {} again", node), "each root once",
                     "it is taken once");
      continue;
    }
    is_listed[at(node)] = true;
    roots.push_back(node);
  }
  // Below another root it is met in its place; otherwise its parents are in no scene.
  const auto is_below_a_root = [&](int node) {
    for (int p = parents[at(node)]; p != kNone; p = parents[at(p)]) {
      if (is_listed[at(p)]) return true;
    }
    return false;
  };
  std::erase_if(roots, [&](int node) {
    if (parents[at(node)] == kNone) return false;
    const bool is_below = is_below_a_root(node);
    document.fault(fmt::format("/scenes/{}/nodes", scene),
                   fmt::format("node {}, a child of node {}", node, parents[at(node)]),
                   "nodes without a parent",
                   is_below ? "it stands where its parent has it" : "it stands without its parent");
    return is_below;
  });
  return roots;
}

std::vector<int> parentless_nodes(const Document& document) {
  const std::vector<int> parents = parents_of(document.model());
  std::vector<int> nodes;
  for (std::size_t i = 0; i < parents.size(); ++i) {
    if (parents[i] == kNone) nodes.push_back(static_cast<int>(i));
  }
  return nodes;
}

Places::Places(Document& document, Pose pose)
    : document_(document),
      model_(document.model()),
      pose_(std::move(pose)),
      parents_(parents_of(model_)),
      locals_(model_.nodes.size()),
      worlds_(model_.nodes.size()) {}

const NodePose* Places::pose_of(int node) const {
  const auto found = pose_.find(node);
  return found == pose_.end() ? nullptr : &found->second;
}

const Mat4d& Places::local(int node) {
  std::optional<Mat4d>& known = locals_[at(node)];
  if (!known) {
    const tinygltf::Node& source = model_.nodes[at(node)];
    const std::string where = document_.where(fmt::format("/nodes/{}", node));
    known = source.matrix.size() == 16
                ? from_matrix(source.matrix, where + "/matrix", document_.notes())
                : matrix_of(transform_of(source, pose_of(node)), where + "/rotation",
                            document_.notes());
  }
  return *known;
}

std::vector<PlacedNode> Places::place(const std::vector<int>& roots) {
  struct Pending {
    int index;
    Mat4d parent_to_world;
    bool is_visible;
  };
  std::vector<Pending> stack;
  for (auto root = roots.rbegin(); root != roots.rend(); ++root) {
    stack.push_back({*root, Mat4d(1.0), true});
  }
  std::vector<PlacedNode> placed;
  std::size_t hidden = 0;
  while (!stack.empty()) {
    const Pending pending = stack.back();
    stack.pop_back();
    const tinygltf::Node& node = model_.nodes[at(pending.index)];
    const Mat4d to_world = pending.parent_to_world * local(pending.index);
    if (!is_finite(to_world)) {
      throw_input_error(document_.where(fmt::format("/nodes/{}", pending.index)),
                        "a transform beyond the range of numbers", "finite transforms");
    }
    worlds_[at(pending.index)] = to_world;
    const bool is_visible = pending.is_visible && shows(document_, pending.index);
    hidden += is_visible ? 0 : 1;
    placed.push_back({pending.index,
                      node.name.empty() ? fmt::format("node {}", pending.index) : node.name,
                      to_world, is_visible});
    for (auto child = node.children.rbegin(); child != node.children.rend(); ++child) {
      stack.push_back({*child, to_world, is_visible});
    }
  }
  if (hidden > 0) {
    document_.notes().info(document_.file_name(),
                           fmt::format("{} {} hidden by KHR_node_visibility", hidden,
                                       hidden == 1 ? "node is" : "nodes are"));
  }
  return placed;
}

Mat4d Places::to_world(int node) {
  std::vector<int> chain;
  int top = node;
  for (; top != kNone && !worlds_[at(top)]; top = parents_[at(top)]) chain.push_back(top);
  Mat4d world = top == kNone ? Mat4d(1.0) : *worlds_[at(top)];
  for (auto one = chain.rbegin(); one != chain.rend(); ++one) {
    world = world * local(*one);
    if (!is_finite(world)) {
      throw_input_error(document_.where(fmt::format("/nodes/{}", *one)),
                        "a transform beyond the range of numbers", "finite transforms");
    }
    worlds_[at(*one)] = world;
  }
  return world;
}

Mat4d rigid(const Mat4d& to_world) {
  const auto unit_or = [](const Vec3d& v, const Vec3d& otherwise) {
    // Scaled first: the squares of very short and very long vectors leave the range of numbers.
    const double largest = std::max({std::abs(v.x), std::abs(v.y), std::abs(v.z)});
    return largest > 0.0 ? glm::normalize(v / largest) : otherwise;
  };
  const Vec3d z = unit_or(Vec3d(to_world[2]), Vec3d(0.0, 0.0, 1.0));
  const Vec3d up = unit_or(Vec3d(to_world[1]), Vec3d(0.0, 1.0, 0.0));
  Vec3d x = glm::cross(up, z);
  if (glm::length(x) < 1e-12) {
    x = glm::cross(std::abs(z.y) < 0.9 ? Vec3d(0.0, 1.0, 0.0) : Vec3d(1.0, 0.0, 0.0), z);
  }
  x = glm::normalize(x);
  return {Vec4d(x, 0.0), Vec4d(glm::cross(z, x), 0.0), Vec4d(z, 0.0), to_world[3]};
}

}  // namespace abbe::gltf
